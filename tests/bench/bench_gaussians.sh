#!/usr/bin/env bash
# conic bench of Gaussian scenes: a line for each profile, with the picture of conic render.
set -uo pipefail

source "$1/tests/support/program.bash"
has() { # PATTERN: in the output
  grep -qe "$1" out || fail "no \"$1\" in: $(head -c 1500 out)"
}
small=(--size 64x48 --repeat 1)

run 0 bench --scenes gaussians-1k --isa scalar,auto --threads 1,2 "${small[@]}" --json old.json
has '^gaussians-1k@64x48/gsplat-1.6/scalar/1 '
has '^gaussians-1k@64x48/exact/[a-z0-9]*/2 '
[[ $(grep -c '"identical": true' old.json) -eq $(grep -c '^gaussians' out) ]] || fail "a picture is not plain C's"
[[ $(grep '"rgba": "' old.json | sort -u | wc -l) -eq 2 ]] || fail "not two pictures"
grep -qE '"fragments": [1-9][0-9]{3}' old.json || fail "no pairs"
run 0 bench --scenes gaussians-1k,sphere-1k --profiles khr-2026 --isa scalar --threads 1 "${small[@]}" --compare old.json
has '^gaussians-1k@64x48/khr-2026/scalar/1 '
has '^sphere-1k@64x48/conic/scalar/1 '
run 0 bench --scenes gaussians-1k --profiles all --threads 1 "${small[@]}" --floor
[[ $(grep -c '^gaussians' out) -eq 34 ]] || fail "not a line and a floor of each profile: $(cat out)"
grep -q '^| resolve\|nan' out && fail "a stage that is not there"

# A file by its camera and framed
run 0 make gaussians -n 1k -o g.ply
cat > camera.json << 'END'
{"width": 64, "height": 48, "fx": 80, "fy": 75, "cx": 32, "cy": 24,
 "world_to_camera": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]}
END
for profile in gsplat-1.6 exact; do
  run 0 render g.ply -o g.exr --camera camera.json --profile $profile --json render.json --aov rgba,Z,count,id
  run 0 bench g.ply --camera camera.json --profiles $profile --threads 1 "${small[@]}" --json -
  for plane in rgba Z count id; do
    grep -qF "$(grep -o "\"$plane\": \"[0-9a-f]*\"" render.json)" out || fail "bench draws $plane otherwise than render"
  done
done
run 0 bench g.ply --profiles exact --threads 1 "${small[@]}"
has '^g.ply@64x48/exact/'

run 2 bench --scenes gaussians-1k --profiles gsplat-1.7
grep -q 'did you mean gsplat-1' err || fail "$(cat err)"
run 2 bench --scenes gaussian-1k
grep -q 'did you mean gaussians' err || fail "$(cat err)"
run 3 bench absent.ply
[[ $failures -eq 0 ]]
