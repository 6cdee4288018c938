#!/usr/bin/env bash
# conic octree, conic render --error and --budget, conic info of a .cot: what the command line promises.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"


value() { # KEY FILE: the first value of a key in a JSON file
  sed -nE "s/^ *\"$1\": \"?([^\",]*)\"?,?$/\1/p" "$2" | head -n 1
}

hashes() { # FILE
  sed -n '/"hash"/,/}/p' "$1"
}

run 0 make knot -n 30k -o knot.ply
run 0 octree knot.ply -o knot.cot --json octree.json
[[ $(value points_in octree.json) == 30000 && $(value points_out octree.json) == 30000 ]] || fail "octree: counts"
[[ $(value bytes octree.json) == $(stat -c %s knot.cot) ]] || fail "octree: bytes"
awk -v b="$(value bytes_per_point octree.json)" 'BEGIN { exit !(b <= 60) }' || fail "over 60 bytes a point"
run 0 octree knot.ply -o small.cot --quantize --json small.json
awk -v b="$(value bytes_per_point small.json)" 'BEGIN { exit !(b <= 28) }' || fail "quantised: over 28 bytes a point"

# Threads change no byte, and neither does a pipe.
run 0 octree knot.ply -o one.cot --threads 1
cmp -s one.cot knot.cot || fail "threads change the file"
"$conic" octree - -o piped.cot < knot.ply || fail "from standard input"
cmp -s piped.cot knot.cot || fail "a pipe changes the file"

for file in knot.cot small.cot; do
  run 0 info $file --check --json info.json
  [[ $(value kind info.json) == cot && $(value sound info.json) == true ]] || fail "info $file"
  [[ $(value bytes info.json) == $(stat -c %s $file) ]] || fail "info $file: bytes"
done
run 0 info knot.cot
grep -q '^nodes .* levels' out || fail "info says nothing of levels"

# Error 0 is the picture of the splats.
picture="--size 200x150 --aov all"
run 0 render knot.ply -o ply.pfm $picture --json ply.json
run 0 render knot.cot -o cot.pfm $picture --json cot.json
run 0 render knot.cot -o zero.pfm $picture --error 0 --json zero.json
cmp -s ply.pfm cot.pfm || fail "the .cot draws another picture"
[[ -n $(hashes ply.json) && $(hashes ply.json) == "$(hashes cot.json)" && $(hashes ply.json) == "$(hashes zero.json)" ]] ||
  fail "the planes of the .cot differ from those of its splats"
[[ $(value near ply.json) == "$(value near cot.json)" ]] || fail "near differs"

# That holds for dots, too, which face each picture's camera, also of a file that is made from the raw points.
awk 'BEGIN { srand(2); for (i = 0; i < 900; i++) print rand(), rand(), rand() }' > dust.xyz
run 0 prepare dust.xyz -o dust.ply
run 0 octree dust.ply -o dust.cot
run 0 octree dust.xyz -o raw.cot
cmp -s dust.cot raw.cot || fail "raw points make another octree"
for view in "--azimuth 20" "--azimuth 100 --elevation 60"; do
  run 0 render dust.ply -o dust.pfm $picture $view --json ply.json
  run 0 render dust.cot -o dust.pfm $picture $view --json cot.json
  [[ -n $(hashes ply.json) && $(hashes ply.json) == "$(hashes cot.json)" ]] || fail "$view: dots are drawn otherwise"
done
run 0 render knot.ply -o ply.pfm $picture --json ply.json
run 0 octree dust.ply -o dust.cot --quantize
for file in dust.cot raw.cot; do
  run 0 info $file --check --json info.json
  [[ $(value sound info.json) == true ]] || fail "$file: dots are not within their nodes"
done

# Fewer for more error; never more than the budget; threads change nothing.
last=0
for error in 8 2 0.5; do
  run 0 render knot.cot -o error.pfm $picture --error $error --json error.json
  n=$(value splats_in error.json)
  [[ $n -gt $last && $n -le 30000 ]] || fail "--error $error draws $n splats after $last"
  [[ $(value near error.json) == "$(value near ply.json)" ]] || fail "--error $error: another near"
  last=$n
done
run 0 render knot.cot -o error.pfm $picture --error 0.5 --threads 1 --json one.json
[[ $(hashes one.json) == "$(hashes error.json)" ]] || fail "threads change the picture"
for budget in 1 100 5000; do
  run 0 render knot.cot -o budget.pfm $picture --budget $budget --json budget.json
  n=$(value splats_in budget.json)
  [[ $n -le $budget && $n -ge $((budget * 9 / 10)) ]] || fail "--budget $budget draws $n"
done
run 0 render knot.cot -o budget.pfm $picture --budget 1M --json budget.json
[[ $(value splats_in budget.json) == 30000 ]] || fail "a budget for everything"
run 0 render knot.cot -o back.pfm $picture --error 1 --cull back --zoom 3 --json back.json
[[ $(value clouds_culled back.json) -gt 0 ]] || fail "nothing was culled"
run 0 render knot.cot -o turn.pfm --turntable 3 --size 64x64 --error 2
[[ -s turn.0003.pfm ]] || fail "no turntable"
run 0 render knot.cot knot.ply -o both.pfm --size 64x64 --json both.json
[[ $(value splats_in both.json) == 60000 ]] || fail "a .cot beside other inputs"
run 0 render small.cot -o small.pfm $picture --error 1

# What was chosen is what is verified and explained, by the names that the picture has.
run 0 verify knot.cot --size 64x48 --error 2 --pixels 1000
run 0 verify knot.cot --size 64x48 --budget 500 --json verify.json
[[ $(value pass verify.json) == true ]] || fail "a budget is not verified"
run 0 explain knot.cot --size 64x48 --error 2 --pixel 32,24 --json explain.json
grep -qE '"(point|node)": ' explain.json || fail "no name of a splat that was chosen"
if "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  run 0 render knot.cot --size 64x48 --error 2 --aov all -o chosen.exr
  run 0 verify knot.cot --size 64x48 --error 2 --image chosen.exr
  run 1 verify knot.cot --size 64x48 --error 8 --image chosen.exr
fi

# What each pixel blends, as a picture.
run 0 render knot.cot --overdraw overdraw.pfm --size 64x64 --error 1
run 0 render knot.cot --overdraw turn.pfm --size 64x64 --turntable 2
run 0 render knot.cot --overdraw confetti.pfm --overdraw-colors confetti --size 64x64 --error 1
cmp -s overdraw.pfm confetti.pfm && fail "the overdraw has one set of colours"
run 0 render knot.cot --boxes boxes.pfm --size 64x64
run 0 render knot.cot --boxes deeper.pfm --box-level 4 --size 64x64 --threads 1
run 0 render knot.cot --boxes again.pfm --box-level 4 --size 64x64 -o beside.pfm
cmp -s boxes.pfm deeper.pfm && fail "all levels have the same boxes"
cmp -s again.pfm deeper.pfm || fail "the boxes depend on what is drawn beside them"
run 2 render knot.ply --boxes boxes.pfm
run 2 render knot.cot --boxes boxes.pfm -o boxes.pfm
[[ -s overdraw.pfm && -s turn.0002.pfm ]] || fail "no picture of the overdraw"
run 2 render knot.cot -o overdraw.pfm --overdraw overdraw.pfm
run 2 render knot.cot --overdraw overdraw

# Clip lines are carried in small files too.
run 0 make cube -n 3k -o cube.ply
run 0 octree cube.ply -o cube.cot --quantize
run 0 info cube.cot --check
run 0 render cube.cot -o cube.pfm --size 64x64 --error 1

# Plain files, and several, are joined in memory.
run 0 render knot.ply -o x.pfm --size 64x64 --error 1 --json lean.json
grep -q '"splats": "cells"' lean.json || fail "an error of a plain file"
run 0 render knot.cot knot.ply -o x.pfm --size 64x64 --budget 500 --json lean.json
grep -q '"splats": "octree"' lean.json || fail "a budget of two files"
run 0 explain knot.ply --size 64x64 --error 1 --pixel 32,32
rm -f x.pfm

# Wrong usage, wrong inputs.
run 2 render knot.cot -o x.pfm --error 1 --budget 5
run 2 render knot.cot -o x.pfm --error -1
run 2 render knot.cot -o x.pfm --budget 0
run 2 render knot.cot --deep x.exr --error 1
run 2 verify knot.cot --error 1 --budget 5
run 3 render missing.cot -o x.pfm --error 1
run 2 render knot.cot -o x.pfm --error 1 --cutoff 3
run 2 octree knot.ply
run 2 octree -o x.cot
run 2 octree knot.ply ply.pfm -o x.cot
run 3 octree missing.ply -o x.cot
run 3 octree knot.cot -o x.cot
run 4 octree knot.ply -o /nowhere/x.cot
head -c 100000 knot.cot > cut.cot
run 3 render cut.cot -o x.pfm --error 1
run 3 info cut.cot
grep -q '^conic: error: cut.cot: .*(at byte ' err || fail "a cut file: $(cat err)"
[[ ! -e x.cot && ! -e x.pfm ]] || fail "a failed run left its output"
[[ -z $(find . -name '.x*') ]] || fail "a failed run left a temporary file"
[[ $failures -eq 0 ]]
