#!/usr/bin/env bash
# No option of conic render is without effect in silence: option_effects.py. And old spellings of options do what the new
# ones do, and say these, once, and not with -q.
set -uo pipefail

source "$1/tests/support/program.bash"
python=$(command -v python3) || {
  echo "skipped: python3 is not installed"
  exit 77
}
mkdir pairs
"$python" "$1/tests/cli/option_effects.py" "$conic" "$PWD/pairs" || fail "options without effect"

# old OLD -- NEW: both draw the same, and only the old one is told about.
old() {
  local former=() rest=("$@") old
  while [[ ${rest[0]} != -- ]]; do
    former+=("${rest[0]}")
    rest=("${rest[@]:1}")
  done
  old=$(printf '%s\n' "${former[@]}" | grep -xE -e "--($old_names)")
  [[ $old ]] || fail "${former[*]}: none of these is old"
  rm -rf a b && mkdir a b
  cd a || exit 1
  run_as_typed 0 render "../$scene" --size 40x40 "${former[@]}"
  grep -v '^conic: render: --.* is now -' err | grep -v '^conic: up' && fail "${former[*]}: says more than the new words"
  for word in $old; do
    [[ $(grep -c "^conic: render: $word is now -" err) == 1 ]] || fail "$word is not told about: $(cat err)"
  done
  run_as_typed 0 render "../$scene" --size 40x40 -q "${former[@]}"
  [[ ! -s err ]] || fail "-q ${former[*]}: $(cat err)"
  cd ../b || exit 1
  run_as_typed 0 render "../$scene" --size 40x40 "${rest[@]:1}"
  grep 'is now' err && fail "${rest[*]}: is said to be old"
  cd ..
  diff -r -x out -x err a b > /dev/null || fail "${former[*]} and ${rest[*]} draw different pictures"
}
old_names=$("$conic" help --format json | "$python" -c 'import json, sys
for command in json.load(sys.stdin)["commands"]:
    if command["name"] == "render":
        print("|".join(option["name"][2:] for option in command["old_spellings"]))')
scene=pairs/splats.ply
old --overdraw o.pfm -- --show overdraw:o.pfm
old --overdraw o.pfm --overdraw-colors confetti -- --show overdraw-confetti:o.pfm
old -o p.pfm --color-by height --legend --legend-out l.pfm --color-range 0,0.2 -- \
  -o p.pfm --color-by height --show legend --show legend:l.pfm --ramp 0,0.2
old -o p.exr --compression none -- -o p.exr --exr none
old -o bare --format exr -- -o exr:bare
old -o p.exr --cryptomatte -- -o p.exr --aov cryptomatte
old -o p.pfm --stereo 0.1 --convergence 2 -- -o p.pfm --stereo 0.1:2
old -o p.pfm --accumulate 3 --aperture 0.2 --blades 5 -- -o p.pfm --accumulate 3 --aperture 0.2:5
scene=pairs/octree.cot
old --boxes b.pfm --box-level 2 -- --show boxes@2:b.pfm
old --boxes b.pfm -- --show boxes:b.pfm
scene=pairs/hybrid.chy
old --clusters c.pfm -- --show clusters:c.pfm
old -o p.pfm --error 2 --color-error 50 -- -o p.pfm --error 2:50
scene=pairs/mesh.obj
old -o p.pfm --smooth -- -o p.pfm --crease all
scene=pairs/raw.las
old -o p.pfm --method patch --degree 2 --h 3x -- -o p.pfm --method patch:2:3x
scene=pairs/gaussians.spz
old -o p.pfm --profile inria-2023 --camera ../pairs/camera.json --ignore-center -- \
  -o p.pfm --profile inria-2023:ignore-center --camera ../pairs/camera.json
run_as_typed 2 render pairs/octree.cot -o p.pfm --box-level 2
run_as_typed 2 render pairs/splats.ply -o p.pfm --overdraw-colors log
for bad in what:o.png overdraw overdraw: boxes@:b.png boxes@128:b.png boxes@x:b.png overdraw@2:o.png clusters; do
  run_as_typed 2 render pairs/octree.cot -o p.pfm --show "$bad"
done

# Gaussians among surfaces: a place is of the scene alone, and what cannot be together is named.
run_as_typed 0 render pairs/gaussians.spz pairs/hybrid.chy -o p.pfm --size 20x20 --place gaussians.spz=0,0,1
run_as_typed 2 render pairs/gaussians.spz pairs/splats.ply pairs/hybrid.chy -o p.pfm
grep -q 'hybrid.chy: a hybrid is drawn without other surfaces' err || fail "$(cat err)"
run_as_typed 2 render pairs/gaussians.spz pairs/mesh.obj -o p.pfm --device opencl
grep -q 'not both together' err || fail "$(cat err)"
run_as_typed 2 render pairs/gaussians.spz pairs/mesh.obj -o p.exr --aov doubt --projection fisheye
grep -q 'doubt, with surfaces among Gaussians, is of a perspective camera' err || fail "$(cat err)"
run_as_typed 0 render pairs/gaussians.spz pairs/mesh.obj -o p.exr --aov ao --projection fisheye --samples 2 --size 20x20

# The other commands that draw use the same table.
run 0 render pairs/splats.ply --size 20x20 -o theirs.exr --aov rgba,Z
for command in "judge --picture theirs.exr" verify "explain --pixel 3,3"; do
  # shellcheck disable=SC2086 # words
  run 2 ${command%% *} pairs/splats.ply ${command#"${command%% *}"} --size 20x20 --profile gsplat-1.6
  grep -q 'error: [a-z]*: --profile has no effect: it acts on Gaussian scenes' err || fail "$command: $(cat err)"
done
run 2 gradient pairs/splats.ply --weights theirs.exr -o g.ply --profile gsplat-1.6
run 0 judge pairs/splats.ply --size 20x20 --picture theirs.exr

# Files of which none says how it was made.
"$conic" render pairs/splats.ply --size 20x20 -o x.jpg --no-shot 2> err # with whatever this build writes
grep -q 'warning: render: --no-shot has no effect' err || fail "--no-shot of a .jpg: $(cat err)"

# What is asked for and cannot be written is no success.
run_as_typed 2 render pairs/splats.ply -o x.png --show legend:legend.png
[[ ! -e x.png && ! -e legend.png ]] || fail "a picture in spite of wrong usage"

exit $((failures > 0))
