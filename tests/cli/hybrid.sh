#!/usr/bin/env bash
# conic hybrid, conic render and conic info of a .chy: what the command line promises.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

value() { # KEY FILE: the first value of a key in a JSON file
  sed -nE "s/^ *\"$1\": \"?([^\",]*)\"?,?$/\1/p" "$2" | head -n 1
}

hashes() { # FILE
  sed -n '/"hash"/,/}/p' "$1"
}

"$1/scripts/terrain-mesh" 60 60 > hill.obj

run 0 hybrid hill.obj --crease 0 -o hill.chy --json made.json # as --plain has it
[[ $(value triangles_in made.json) == 7200 && $(value bytes made.json) == $(stat -c %s hill.chy) ]] || fail "counts"
[[ $(value triangles made.json) -gt 0 && $(value surfels made.json) -gt 0 ]] || fail "not both kinds"
# More than came in is explained, and nothing else.
run 0 hybrid hill.obj --density 8 --most-error 9 -o more.chy --json more.json
[[ $(($(value triangles more.json) + $(value surfels more.json))) -gt 7200 ]] || fail "not more than the mesh"
grep -q "more primitives as built than came in: surfels" err && [[ -n $(value why_more more.json) ]] || fail "more, and no reason"
run 0 hybrid hill.obj --phase2 -2 -o same.chy --json same.json
[[ $(value triangles same.json) == 7200 && -z $(value why_more same.json) ]] || fail "a reason for what is not so"
[[ $(value open_edges made.json) == 240 && $(value nan made.json) == 0 ]] || fail "oddities of an open sheet"
run 0 hybrid hill.obj --crease 0 -o one.chy --threads 1
cmp -s one.chy hill.chy || fail "threads change the file"
run 0 info hill.chy --check --json info.json
[[ $(value kind info.json) == chy && $(value sound info.json) == true ]] || fail "info"
[[ $(value surfels info.json) == "$(value surfels made.json)" ]] || fail "info: surfels"

# A PLY that is read some faces at a time: of one cell it is the same file.
awk '/^v/ { v[n++] = $2 " " $3 " " $4 } /^f/ { f[m++] = "3 " $2 - 1 " " $3 - 1 " " $4 - 1 } END {
  print "ply\nformat ascii 1.0\nelement vertex " n "\nproperty float x\nproperty float y\nproperty float z"
  print "element face " m "\nproperty list uchar int vertex_indices\nend_header"
  for (i = 0; i < n; i++) print v[i]
  for (i = 0; i < m; i++) print f[i] }' hill.obj > hill.ply
run 0 hybrid hill.ply -o whole.chy
run 0 hybrid hill.ply --memory 200 -o parts.chy --json parts.json
cmp -s whole.chy parts.chy || fail "--memory makes another file of one cell"
[[ $(value triangles_in parts.json) == 7200 && $(value bytes parts.json) == $(stat -c %s parts.chy) ]] || fail "counts"
run 4 hybrid hill.ply --memory 9 -o x.chy
run 2 hybrid hill.ply --memory 200 --color-by height -o x.chy
run 3 hybrid hill.obj --memory 200 -o x.chy
[[ ! -e x.chy && -z $(find . -name '.conic*') ]] || fail "something is left behind"

# Points become triangles where they lie as a surface does, and stay splats at the border, on the way too.
{ printf 'ply\nformat ascii 1.0\nelement vertex 3721\nproperty float x\nproperty float y\nproperty float z\nend_header\n'
  sed -n 's/^v //p' hill.obj; } > cloud.ply
run 0 hybrid cloud.ply -o scan.chy --json scan.json
[[ $(value points_in scan.json) == 3721 && $(value splats_kept scan.json) -lt 600 ]] || fail "points: $(cat scan.json)"
[[ $(value why_more scan.json) == "a surface has two triangles"* ]] || fail "more than the points, and no reason"
[[ $(value triangles_in scan.json) -gt 6500 ]] || fail "few triangles of points"
run 0 info scan.chy --check
run 0 render scan.chy -o a.pfm --size 160x120 --error 1 --json file.json
run 0 render cloud.ply --as hybrid -o b.pfm --size 160x120 --error 1 --json mesh.json
[[ -n $(hashes file.json) && $(hashes file.json) == "$(hashes mesh.json)" ]] || fail "--as hybrid of points is another"

# A mesh that becomes a hybrid on the way is the file; nothing but the choice changes a picture.
picture="--size 160x120 --aov rgba,Z,id,cluster"
run 0 render hill.chy -o a.pfm $picture --json file.json
run 0 render hill.obj --as hybrid -o b.pfm $picture --json mesh.json
[[ -n $(hashes file.json) && $(hashes file.json) == "$(hashes mesh.json)" ]] || fail "--as hybrid is another picture"
[[ $(value cluster file.json) =~ ^[0-9a-f]{16}$ ]] || fail "no plane cluster"
for other in "--threads 1" "--isa scalar" "--tile 16"; do
  # shellcheck disable=SC2086 # an option and its value
  run 0 render hill.chy -o c.pfm $picture $other --json other.json
  [[ $(hashes file.json) == "$(hashes other.json)" ]] || fail "$other changes the picture"
done

# All in one kind; fewer with an error.
run 0 render hill.chy -o t.pfm $picture --only triangles --json triangles.json
[[ $(value splats_in triangles.json) == 0 && $(value surfel_patches triangles.json) == 0 ]] || fail "--only triangles"
run 0 render hill.chy -o s.pfm $picture --only surfels --json surfels.json
[[ $(value triangle_patches surfels.json) == 0 && $(value splats_in surfels.json) -gt 0 ]] || fail "--only surfels"
last=100000
for error in 0.25 1 4; do
  run 0 render hill.chy -o e.pfm $picture --error $error --json error.json
  triangles=$(value triangles_in error.json)
  n=$(($(value splats_in error.json) + ${triangles:-0}))
  [[ $n -lt $last && $n -gt 0 ]] || fail "--error $error draws $n after $last"
  last=$n
done

# An error that the kind cannot keep is owned up to
run 0 render hill.chy -o s.pfm $picture --only surfels --error 0.001 --json surfels.json
grep -q '^conic: warning: hill.chy: --only surfels cannot keep --error 0.001: ' err || fail "a broken --error goes unsaid"
[[ $(value error_px_asked surfels.json) == 0.001 ]] || fail "--error is not in the statistics"
perl -e 'exit !($ARGV[0] > 0.001)' "$(value error_px surfels.json)" || fail "the error that was reached is not there"
run 0 render hill.chy -o s.pfm $picture --only surfels --error 1000
[[ ! -s err ]] || fail "of an --error that is kept: $(cat err)"
# and so are surfels that nobody asked an error of, where they stand out by more than a pixel.
run 0 render hill.chy -o s.pfm --size 1024x1024 --only surfels
grep -q '^conic: warning: hill.chy: --only surfels stand out from the mesh: ' err || fail "surfels stand out unsaid"
run 0 render hill.chy -o s.pfm --size 1024x1024
[[ ! -s err ]] || fail "as built: $(cat err)"
run 0 render hill.chy -o s.pfm --size 64x48 --only surfels
[[ ! -s err ]] || fail "of small surfels: $(cat err)"

# Nor colours that the kind cannot keep.
run 0 hybrid hill.obj --crease 0 --color-by height --ramp diverging -o bands.chy
run 0 render bands.chy -o s.pfm $picture --only surfels --error 100 --json surfels.json
grep -q '^conic: warning: bands.chy: --only surfels cannot keep --error [0-9.]*:2: ' err || fail "other colours go unsaid"
perl -e 'exit !($ARGV[0] > 2)' "$(value color_error surfels.json)" || fail "the colours' error is not there"
run 0 render bands.chy -o s.pfm $picture --only surfels --error 100:100
[[ ! -s err ]] || fail "of a --color-error that is kept: $(cat err)"

# What looks round in a file looks so on the way, and else not.
run 0 hybrid hill.obj --smooth -o round.chy
run 0 render round.chy -o b.pfm $picture --json round.json
run 0 render hill.obj --as hybrid --smooth -o b.pfm $picture --json smooth.json
[[ $(hashes round.json) == "$(hashes smooth.json)" && $(hashes round.json) != "$(hashes file.json)" ]] ||
  fail "--smooth: another picture"

# Never more than the budget, and better with more of it.
last=1000000
for budget in 300 1000 4000 1M; do
  run 0 render hill.chy -o b.pfm $picture --budget $budget --json budget.json
  triangles=$(value triangles_in budget.json)
  n=$(($(value splats_in budget.json) + ${triangles:-0}))
  [[ $n -le ${budget/M/000000} && $n -gt 0 ]] || fail "--budget $budget draws $n"
  perl -e 'exit !($ARGV[0] < $ARGV[1])' "$(value error_px budget.json)" $last || fail "--budget $budget is no better"
  last=$(value error_px budget.json)
done
[[ $last == 0 && $n == 7200 ]] || fail "a budget for all is not the mesh"
run 0 render hill.chy -o b.pfm $picture --budget 1000 --json budget.json
run 0 render hill.obj --as hybrid -o b.pfm $picture --budget 1k --threads 1 --isa scalar --json other.json
[[ -n $(hashes budget.json) && $(hashes budget.json) == "$(hashes other.json)" ]] || fail "--budget: another picture"
# Far away nodes stand for many patches, down to a point for all; of triangles there are no nodes.
run 0 render hill.chy -o e.pfm --size 40x40 --error 6 --json error.json
[[ $(value joined_patches error.json) -gt 1 && $(value nodes error.json) -gt 0 ]] || fail "no nodes at 6 of 40 pixels"
run 0 render hill.chy -o b.pfm $picture --budget 1 --json budget.json
[[ $(value points budget.json) == 1 && $(value splats_in budget.json) == 1 ]] || fail "--budget 1 is not one point"
run 2 render hill.chy -o x.pfm --budget 10 --only triangles
grep -q '^conic: error: hybrid: the coarsest of what is in sight are [0-9]* triangles' err || fail "no word on the budget"

# The oracle draws what was chosen, splats and triangles in one picture, and agrees.
view="--size 100x80 --zoom 2"
for choice in "" "--error 1" "--error 4" "--error 20" "--budget 20" "--budget 1000" "--only surfels" "--only triangles" "--error 2 --passes 1" \
  "--error 2 --method ray --cull back" "--error 4 --samples 2"; do
  # shellcheck disable=SC2086 # options and their values
  run 0 verify hill.chy $view $choice --json verify.json
  [[ $(value pass verify.json) == true && $(value covered_pixels verify.json) -gt 1000 ]] || fail "verify $choice"
done
# shellcheck disable=SC2086
run 0 verify hill.obj --as hybrid $view --error 2
run 0 verify hill.obj --as mesh $view --pixels 2000
run 0 verify hill.chy --size 32x24 --error 2 --against exact
grep -q '^weights  *max ' out || fail "no errors of the weights"

# A pixel of both kinds: who is blended, and whose patch that is. The first on the way across the picture is taken.
run 0 hybrid hill.obj --most-error 0 -o both.chy
blended() { # KEY: how often, of what the pixel blends
  sed -n '/^  "blended"/,/^  \]/p' pixel.json | grep -c "\"$1\": "
}
for ((i = 0; i < 300; i++)); do
  # shellcheck disable=SC2086
  run 0 explain both.chy $view --pixel $((20 + i % 60)),$((24 + 4 * (i / 60))) --json pixel.json
  [[ $(blended triangle) -eq 1 && $(blended splat) -gt 1 ]] && break
done
[[ $i -lt 300 ]] || fail "no pixel of both kinds"
for key in blended contributions triangles cluster threshold; do
  grep -q "\"$key\":" pixel.json || fail "explain: no $key"
done
if command -v python3 > /dev/null; then
  python3 - pixel.json << 'END' || fail "the pixel does not add up"
import json, sys
pixel = json.load(open(sys.argv[1]))
blended, planes = pixel["blended"], pixel["planes"]
assert len(blended) == planes["count"] > 2
assert abs(sum(b["weight"] for b in blended) - planes["weight"]) < 1e-6 * planes["weight"]
assert abs(sum(b["share"] for b in blended) - 1) < 1e-6
assert all("splat" in b for b in blended[:-1]) and "triangle" in blended[-1]
visible = [c for c in pixel["contributions"] + pixel["triangles"] if c["verdict"] == "visible"]
assert [(c.get("splat"), c.get("triangle"), c["cluster"], c["depth"]) for c in visible] == [
    (b.get("splat"), b.get("triangle"), b["cluster"], b["depth"]) for b in blended]
assert planes["cluster"] in {b["cluster"] for b in blended}
END
fi
# shellcheck disable=SC2086
run 0 explain hill.chy $view --splat 3 --json splat.json
grep -q '"cluster": ' splat.json || fail "explain: no patch of the splat"
run 0 explain hill.chy --size 100x80 --dump-projection p.csv
run 2 explain hill.chy --only triangles --splat 0
run 2 explain hill.chy --size 100x80 --pixel 100,0

# Refused, and nothing is left under the output's name.
run 2 hybrid -o x.chy
run 2 hybrid hill.obj
run 2 hybrid hill.obj hill.obj -o x.chy
run 2 hybrid hill.obj -o x.chy --sampling dice
run 2 hybrid hill.obj -o x.chy --smooth --crease 20
run 2 render hill.chy -o x.pfm --error 1 --color-error 0
run 3 hybrid missing.obj -o x.chy
printf 'v nan 0 0\n' > points.obj
run 3 hybrid points.obj -o x.chy
printf 'v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n' > line.obj
run 3 hybrid line.obj -o x.chy
run 3 hybrid hill.obj -o x.chy --texture missing.png
[[ ! -e x.chy ]] || fail "a file that is none"
head -c 1000 hill.chy > cut.chy
run 3 render cut.chy -o x.pfm
run 3 info cut.chy
run 2 render hill.chy hill.obj -o x.pfm
run 2 render hill.obj -o x.pfm --only surfels
run 2 render hill.obj -o x.pfm --aov cluster
run 2 render hill.chy -o x.pfm --budget 10 --error 1
run 2 render hill.chy -o x.pfm --clusters
run 2 render hill.obj -o x.pfm --clusters c.png
run 0 render hill.obj --as mesh -o x.pfm --budget 100 --json lean.json
grep -q '"triangles": "levels"' lean.json || fail "a mesh's budget"
rm -f x.pfm
run 2 verify hill.chy hill.obj
run 2 verify hill.chy --aov cluster
run 2 verify hill.chy --error 1 --budget 1000
run 2 verify hill.obj --only surfels
run 2 explain hill.chy --pixel 1,1 --method patch
[[ ! -e x.pfm ]] || fail "a picture of what was refused"

[[ $failures -eq 0 ]]
