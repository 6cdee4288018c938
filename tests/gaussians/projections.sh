#!/usr/bin/env bash
# conic render --projection and --eye of Gaussian scenes, their cameras in JSON, and what refuses them.
set -uo pipefail

source "$1/tests/support/program.bash"

# Four Gaussians of a quarter: in the middle, to the right of it, above it, before it.
row() { # X, Y, Z as the bytes of floats
  printf "$1$2$3"'\0\0\200\76\0\0\200\76\0\0\200\76\377\0\0\377\377\200\200\200'
}
zero='\0\0\0\0' one='\0\0\200\77' minus='\0\0\200\277'
{ row "$zero" "$zero" "$zero"; row "$one" "$zero" "$zero"; row "$zero" "$minus" "$zero"; row "$zero" "$zero" "$one"; } > four.splat

for projection in perspective orthographic fisheye panorama; do
  run 0 render four.splat --profile exact --projection $projection --size 60x40 --aov rgba,Z,P -o $projection.exr \
    --json $projection.json
  grep -q '"pixels_covered": [1-9]' $projection.json || fail "$projection is empty: $(cat $projection.json)"
  # the camera that it tells draws the same picture
  perl -0777 -ne '/"camera": (\{.*?\]\]\s*\})/s && print $1' $projection.json > camera.json
  run 0 render four.splat --profile exact --camera camera.json --aov rgba,Z,P -o again.exr
  run 0 diff $projection.exr again.exr
done
for projection in orthographic fisheye panorama; do
  run 1 diff perspective.exr $projection.exr
  run 2 render four.splat --profile gsplat-1.6 --projection $projection -o a.exr
  grep -q 'profile exact' err || fail "gsplat by $projection: $(cat err)"
done
grep -q '"kind": "orthographic"' orthographic.json || fail "no kind: $(cat orthographic.json)"

# A panorama is twice as wide as high, level, and taken amid the scene or from --eye.
run 0 render four.splat --profile exact --projection panorama -o a.exr --json -
grep -q '"height": 512' out || fail "a panorama's size: $(cat out)"
run 0 render four.splat --profile exact --projection panorama --eye 0.5,0.5,0 --size 60x30 --azimuth 0 -o a.exr --json -
grep -q '\[0, 1, 0, -0.5\]\|\[0, -1, 0, 0.5\]\|\[-*0, -*1, -*0, -*0.5\]' out || fail "the eye: $(grep world_to out)"
run 2 render four.splat --profile exact --eye 1,2 -o a.exr
run 2 render four.splat --profile exact --camera camera.json --eye 1,2,3 -o a.exr
run 2 render four.splat --profile exact --projection fisheye --prefilter 1 -o a.exr
run 0 render four.splat --profile exact --projection orthographic --prefilter 1 --size 60x40 -o a.exr

# What judges takes neither, and says so.
run_as_typed 2 verify four.splat --profile exact --prefilter 1 --size 40x40
grep -q 'prefilter' err || fail "verify: $(cat err)"
run_as_typed 2 verify four.splat --profile exact --projection fisheye --size 40x40
grep -q 'pinholes alone' err || fail "verify: $(cat err)"

# A file's camera that distorts, and a source that cannot draw it.
sed -i 's/"kind": "equirectangular",/"lens": "opencv", "distortion": [-0.1, 0.01, 0.001, 0.001],/' camera.json
sed -i 's/"width": 60/"width": 61/' camera.json
run 0 render four.splat --profile exact --camera camera.json -o a.exr
run 2 render four.splat --profile inria-2023 --camera camera.json -o a.exr
grep -q 'lens that distorts.*profile exact' err || fail "a lens: $(cat err)"
run 0 convert four.splat -o four.ply
run 0 render four.ply --camera camera.json -o a.exr

[[ $failures -eq 0 ]]
