#!/usr/bin/env bash
# 3dgut-2025 through fisheyes and lenses: as numpy has it, as the oracle has it, and what refuses other cameras.
set -uo pipefail

source "$1/tests/support/program.bash"

PYTHONDONTWRITEBYTECODE=1 python3 "$1/tests/gaussians/gut_cameras.py" "$conic" > table || fail "numpy's pictures"
cat table

# Its own judge: no pixel is wrong, and a picture of another lens is.
for camera in fisheye turned fourth barrel folded radial opencv strong down right up left; do
  run_as_typed 0 verify large.ply --profile 3dgut-2025 --camera $camera.json --json v.json
  run_as_typed 0 render large.ply --profile 3dgut-2025 --camera $camera.json -o $camera.exr
  run_as_typed 0 judge large.ply --profile 3dgut-2025 --camera $camera.json --picture $camera.exr --floats own
  run_as_typed 0 explain large.ply --profile 3dgut-2025 --camera $camera.json --pixel 50,30
  grep -q '"contributions"' out || fail "explain by $camera: $(head -c 300 out)"
done
run_as_typed 1 judge large.ply --profile 3dgut-2025 --camera turned.json --picture fourth.exr --floats own
grep -q 'wrong' out || fail "another lens: $(head -c 300 out)"

# Others are refused, and the profiles of pinholes refuse these.
alter() { # EXPRESSION, a pattern of what the program then says
  sed "$1" opencv.json > other.json
  for command in "render -o a.exr" "verify" "project -o a.npz"; do
    run_as_typed 2 ${command%% *} large.ply --profile 3dgut-2025 --camera other.json ${command#"${command%% *}"}
    grep -q "3dgut-2025 takes.*$2" err || fail "$1: $(cat err)"
  done
}
alter 's/"opencv"/"thin-prism"/' 'its lens thin-prism'
alter 's/"opencv"/"fov"/' 'its lens fov'
alter 's/"opencv"/"radial"/' 'its lens radial'
alter 's/"lens"/"kind": "fisheye", "lens"/' 'is fisheye, its lens opencv'
alter 's/"lens": "opencv"/"kind": "orthographic"/' 'is orthographic'
alter 's/"lens": "opencv"/"kind": "equirectangular"/' 'is equirectangular'
run_as_typed 2 render large.ply --profile exact --camera down.json -o a.exr
grep -q 'rolling shutter.*3dgut-2025' err || fail "exact by a shutter: $(cat err)"
sed 's/"shutter": "[a-z-]*",/"shutter": "global",/' down.json > other.json
run_as_typed 3 render large.ply --profile 3dgut-2025 --camera other.json -o a.exr
run_as_typed 0 render large.ply --profile 3dgut-2025 --camera down.json -o down.exr --json down_told.json
perl -0777 -ne '/"camera": (\{.*\]\s*\})/s && print $1' down_told.json > told.json
grep -q '"shutter": "top-to-bottom"' told.json || fail "no shutter is told: $(head -c 300 down_told.json)"
run_as_typed 0 render --again down.exr -o again.exr
run_as_typed 0 diff down.exr again.exr
run_as_typed 2 render large.ply --profile gsplat-1.6 --camera opencv.json -o a.exr
grep -q 'pinholes alone' err || fail "gsplat-1.6: $(cat err)"

[[ $failures -eq 0 ]]
