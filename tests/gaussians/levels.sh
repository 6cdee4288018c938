#!/usr/bin/env bash
# Gaussian scenes in levels on the command line: built without a word of how, drawn to the bit of the source or by less,
# and refused by name where they cannot be what is asked for.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

if ! "$conic" --version | grep '^In this build:' | grep -q zstd; then
  echo "skipped: this build has no zstd"
  exit 77
fi

number() { # KEY FILE: of gaussian_levels
  sed -nE "/gaussian_levels/,/}/s/^ *\"$1\": ([^,]*),?$/\1/p" "$2" | head -n 1
}

run 0 make gaussians -n 3000 --degree 1 -o balls.ply
run 0 layer balls.ply -o balls.lpc --cloud-size 256
run 0 layer balls.ply -o again.lpc --cloud-size 256 --payload gaussians --threads 3 --memory 16
cmp -s balls.lpc again.lpc || fail "threads or memory change the file"
run 0 info balls.lpc --check
grep -q '^gaussians .*3000, 3D, harmonics of degree 1' out || fail "info: $(cat out)"
for profile in exact gsplat-1.6; do
  run 0 render balls.ply --profile $profile --size 96x96 -o source.pfm
  run 0 render balls.lpc --profile $profile --size 96x96 -o whole.pfm --json whole.json
  cmp -s source.pfm whole.pfm || fail "$profile: drawn whole it is not the source's picture"
done
run 0 render balls.lpc --profile exact --size 96x96 --budget 700 -o few.pfm --json few.json
(($(number gaussians few.json) <= 700 && $(number gaussians_merged few.json) > 0)) || fail "--budget"
run 0 render balls.lpc --profile exact --size 96x96 --error 2 -o coarse.pfm --threads 3
run 0 render again.lpc --profile exact --size 96x96 --error 2 -o other.pfm --threads 1
cmp -s coarse.pfm other.pfm || fail "threads change a bit"
run 0 render balls.lpc balls.ply --profile exact --size 64x64 -o both.pfm

# Wherever it stands, as much of it is drawn; a picture is no farther from the whole one than it says.
run 0 make sphere -n 100 -o sphere.ply
place() { # JSON ARGUMENTS: of balls.lpc
  run 0 render balls.lpc --profile exact --size 96x96 --error 2 --json "$1" -o placed.pfm "${@:2}"
}
place here.json
for turned in 2,0,0,5,0,2,0,-1,0,0,2,3 "0,0,1,0,0,1,0,0,-1,0,0,0 --azimuth 300"; do
  # shellcheck disable=SC2086
  place there.json --place balls.lpc=$turned
  n=$(number gaussians there.json) is=$(number gaussians here.json) # of a turned one floats differ
  ((50 * (n > is ? n - is : is - n) <= is)) || fail "placed by $turned: $n Gaussians, not $is"
done
run 0 render balls.lpc sphere.ply --profile exact --size 96x96 --budget 700 -o few.pfm --json few.json
(($(number gaussians few.json) <= 700 && $(number gaussians_merged few.json) > 0)) || fail "--budget among surfaces"
run 0 verify balls.lpc sphere.ply --profile exact --size 64x64 --budget 700 --samples 1
run 3 render balls.lpc balls.ply --profile exact --size 96x96 --budget 700 -o no.pfm
grep -q 'without levels have 3000 Gaussians, and the budget is 700' err || fail "others over a budget: $(cat err)"

# A budget of several scenes is of all together, by one error; what is too little for the coarsest says how much is not.
run 0 render balls.lpc again.lpc --profile exact --size 96x96 --budget 900 -o few.pfm --json few.json \
  --place again.lpc=4,0,0 --threads 3
(($(number gaussians few.json) <= 900 && $(number gaussians few.json) > 600)) || fail "a budget of two scenes"
run 0 render balls.lpc again.lpc --profile exact --size 96x96 --budget 900 -o other.pfm \
  --place again.lpc=4,0,0 --threads 1
cmp -s few.pfm other.pfm || fail "threads change a bit of what shares a budget"
for scenes in balls.lpc "balls.lpc again.lpc"; do
  # shellcheck disable=SC2086
  run 3 render $scenes --profile exact --size 96x96 --budget 3 -o no.pfm
  least=$(sed -nE 's/.*its coarsest picture has ([0-9]+) Gaussians, and the budget is 3$/\1/p' err)
  [[ -n $least ]] || fail "a budget that is too small: $(cat err)"
  # shellcheck disable=SC2086
  run 0 render $scenes --profile exact --size 96x96 --budget "$least" -o few.pfm --json few.json
  [[ $(number gaussians few.json) == "$least" ]] || fail "the least of $scenes is not $least"
done
run 2 render balls.lpc --profile exact --size 96x96 --aov bound -o no.pfm
run 2 render balls.lpc --profile exact --size 96x96 --error 1 --accumulate 2 --aov bound -o no.pfm
bounded() { # SIZE ARGUMENTS: no pixel is off by more than the plane says, and no plane says more than the JSON
  run 0 render "${@:2}" --size "$1" --aov rgba,bound --json bound.json -o bound.pfm
  local without=() argument
  for argument in "${@:2}"; do
    [[ $argument == --error=* || $argument == --budget=* ]] || without+=("$argument")
  done
  run 0 render "${without[@]}" --size "$1" -o whole.pfm
  run 1 diff bound.pfm whole.pfm --json off.json
  python3 - bound.json off.json << 'END' || fail "${*:2}: the bound does not hold"
import json, sys
bound, off = json.load(open(sys.argv[1]))["bound"], json.load(open(sys.argv[2]))
sys.exit(not 0 < off["max_abs"] <= bound + 1e-7)
END
}
for profile in exact gsplat-1.6 khr-2026; do
  for azimuth in 0 130; do
    bounded 64x64 balls.lpc --profile $profile --azimuth $azimuth --error=0.5
    bounded 64x64 balls.lpc sphere.ply --profile $profile --azimuth $azimuth --budget=700
  done
done

run 2 layer balls.ply sphere.ply -o no.lpc
grep -q 'payload plain' err || fail "mixed inputs: $(cat err)"
run 2 layer balls.ply -o no.lpc --quantum 1
run 2 layer balls.ply --append -o balls.lpc
run 3 cut balls.lpc --box -1,-1,1,1 -o no.ply
grep -q 'a .lpc of Gaussians' err || fail "cut: $(cat err)"
run 3 render balls.lpc --profile surface -o no.png
run 0 layer balls.ply -o splats.lpc --payload plain
run 0 info splats.lpc
grep -q '^samples' out || fail "--payload plain keeps no splats"
cp balls.lpc older.lpc
printf '\4' | dd of=older.lpc bs=1 seek=8 conv=notrunc 2> /dev/null
for command in "render older.lpc --profile exact -o no.png" "info older.lpc" \
  "render older.lpc sphere.ply --profile exact -o no.png"; do
  # shellcheck disable=SC2086
  run 3 $command
  grep -q 'made by an older version; make it again with conic layer' err || fail "$command: $(cat err)"
done
head -c 3000 balls.lpc > no.lpc
run 3 render no.lpc --profile exact -o no.png
[[ $failures -eq 0 ]]
