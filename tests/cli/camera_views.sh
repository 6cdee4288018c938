#!/usr/bin/env bash
# --camera and --view: one picture through every kind of camera file, whatever is drawn; which view is meant; what the
# files of all views are called; sizes; and what is refused.
set -uo pipefail

source "$1/tests/support/program.bash"
garden=$1/../shared/data/gaussians/garden.npz
says() { # TEXT
  grep -qF -- "$1" err || fail "it does not say '$1': $(cat err)"
}

# One camera in files of every kind
printf '{"width": 32, "height": 24, "fx": 30, "fy": 30, "cx": 16, "cy": 12,
  "world_to_camera": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 4], [0, 0, 0, 1]]}' > own.json
mkdir -p colmap/sparse/0
printf '# by hand\n3 PINHOLE 32 24 30 30 16 12\n4 SIMPLE_RADIAL 32 24 30 16 12 0.1\n' > colmap/sparse/0/cameras.txt
printf '9 0 1 0 0 0 0 4 3 in/one.png\n1 2 -1\n8 0 1 0 0 0 0 5 3 in/two.png\n\n7 0 1 0 0 0 0 5 4 wide.png\n\n' \
  > colmap/sparse/0/images.txt
printf '{"w": 32, "h": 24, "fl_x": 30, "frames": [{"file_path": "in/one.png",
  "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 4], [0, 0, 0, 1]]}, {"file_path": "in/two.png",
  "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]]}]}' > transforms.json
printf '[{"id": 0, "img_name": "one", "width": 32, "height": 24, "position": [0, 0, 4],
  "rotation": [[1, 0, 0], [0, -1, 0], [0, 0, -1]], "fx": 30, "fy": 30}]' > cameras.json

"$conic" make sphere -n 500 -o sphere.ply
printf 'v %s\n' '0 0 0' '1 0 0' '1 0 1' '0 0 1' > square.obj
printf 'f 1 2 3 4\n' >> square.obj
"$conic" octree sphere.ply -o sphere.cot
"$conic" layer sphere.ply -o sphere.lpc
printf 'ply\nformat ascii 1.0\nelement vertex 1\n' > one.ply
printf 'property float %s\n' x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3 >> one.ply
printf 'end_header\n0 0 0 1 1 1 3 -1 -1 -1 1 0 0 0\n' >> one.ply
for scene in sphere.ply square.obj sphere.cot sphere.lpc 'square.obj --as hybrid' 'one.ply --profile exact'; do
  # shellcheck disable=SC2086
  run 0 render $scene --camera own.json -o own.pfm
  for camera in 'colmap --view one' 'colmap/sparse/0/images.txt --view in/one.png' 'transforms.json --view 0' cameras.json; do
    # shellcheck disable=SC2086
    run 0 render $scene --camera $camera -o other.pfm
    cmp -s own.pfm other.pfm || fail "$scene is another picture by $camera"
  done
done

# Which view
run 2 render sphere.ply --camera colmap -o a.pfm
says 'colmap: it has 3 views: in/one.png, in/two.png, wide.png; give --view INDEX (from 0), NAME or all, too'
run 2 render sphere.ply --camera colmap --view three -o a.pfm
says 'colmap: there is no view three; there are 3, from in/one.png to wide.png'
run 2 render sphere.ply --view one -o a.pfm
says '--view has no effect: it needs a file of cameras'
run 2 render sphere.ply --camera colmap --view all --turntable 3 -o a.pfm
run 2 explain sphere.ply --camera colmap --view all --pixel 1,1
says 'it takes one view'
run 0 render sphere.ply --camera colmap --view wide -o a.pfm
run 2 verify sphere.ply --camera colmap --view wide
says 'a lens that distorts'
run 0 render one.ply --profile exact --camera colmap --view wide -o a.pfm # which draws by any lens
rm a.pfm
run 0 explain sphere.ply --camera colmap --view 1 --pixel 16,12 --json explained.json
run 0 verify sphere.ply --camera transforms.json --view two --pixels 50
run 0 render sphere.ply --camera transforms.json --view two -o two.pfm --json two.json
grep -q '"index": 1' two.json && grep -q '"name": "in/two.png"' two.json || fail "the view is not told"
cmp -s own.pfm two.pfm && fail "both views are one picture"
[[ ! -e a.pfm ]] || fail "a picture of what was refused"

# All views: numbered from 0, or by name, and each as it is by itself
mkdir out.d
holds() { # NAMES: what is in the folder `out.d`, which is then emptied
  local found
  found=$(cd out.d && echo *)
  [[ $found == "$*" ]] || fail "written: $found, and not $*"
  rm -f out.d/*
}
run 0 render sphere.ply --camera transforms.json --view one -o one.pfm
run 0 render sphere.ply --camera transforms.json --view all -o out.d/a.pfm -o out.d/b%02d.pfm -o out.d/%s.pfm
cmp -s two.pfm out.d/a.0001.pfm && cmp -s one.pfm out.d/b00.pfm && cmp -s two.pfm out.d/two.pfm ||
  fail "a view is another picture among all"
holds a.0000.pfm a.0001.pfm b00.pfm b01.pfm one.pfm two.pfm
run_as_typed 0 render sphere.ply --camera transforms.json --view 1 -o two.pfm # by the studio's light
run_as_typed 0 render sphere.ply --camera transforms.json --view all -o out.d/a.pfm
cmp -s two.pfm out.d/a.0001.pfm || fail "a view is lit in another way among all"
rm out.d/*
run 0 render sphere.ply --camera transforms.json --view all --frames 1 -o out.d/a.pfm
holds a.0001.pfm
for frames in 2 0:2 1:0 x; do
  run 2 render sphere.ply --camera transforms.json --view all --frames $frames -o out.d/a.pfm
done
printf '{"w": 32, "h": 24, "fl_x": 30, "frames": [{"file_path": "l/x.png", "h": 12,
  "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 4], [0, 0, 0, 1]]}, {"file_path": "r/x.png",
  "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]]}]}' > pair.json
run 2 render sphere.ply --camera pair.json --view all -o out.d/%s.pfm
says 'two views would be written to out.d/x.pfm'
run 2 render sphere.ply --camera pair.json --view x -o out.d/a.pfm
says '2 views are called x'
run 0 render sphere.ply --camera pair.json --view all -o out.d/a.pfm # of two sizes
head -c 9 out.d/a.0000.pfm | grep -q '32 12' || fail "the first view has the second's size"
cp sphere.ply out.d/a.0001.pfm
run 2 render out.d/a.0001.pfm --camera pair.json --view all -o out.d/a.pfm
says 'is an input'
rm out.d/*

# Sizes: half as large is what the middle of a camera of half the focal length shows
run 0 render sphere.ply --camera own.json --size 16x12 -o half.pfm
sed 's/32/16/; s/24/12/; s/: 30/: 15/g; s/: 16, "cy": 12/: 8, "cy": 6/' own.json > half.json
run 0 render sphere.ply --camera half.json -o by-hand.pfm
cmp -s half.pfm by-hand.pfm || fail "--size does not scale the camera"
printf '{"camera_angle_x": 1, "frames": [{"file_path": "r_0",
  "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 4], [0, 0, 0, 1]]}]}' > nerf.json
run 3 render sphere.ply --camera nerf.json -o a.pfm
says 'nerf.json: it does not say how large its pictures are; give --size WxH, too (line 1)'
run 0 render sphere.ply --camera nerf.json --size 20x20 -o a.pfm

# What a file lists, and what JSON tells is a camera again
run 0 info colmap
grep -q '^views      3$' out && grep -q '^  2    wide.png .* lens radial$' out || fail "the views are not listed: $(cat out)"
run 0 info transforms.json --json -
grep -q '"format": "transforms"' out || fail "the format is not told"
run 0 render sphere.ply --camera colmap --view one -o a.pfm --json a.json
sed -n '/"camera": {/,/^  }/p' a.json | sed 's/.*"camera": //; s/^  },$/}/' > again.json
run 0 render sphere.ply --camera again.json -o again.pfm
cmp -s a.pfm again.pfm || fail "the camera of the JSON is another one"

# What is missing, and what is no camera
mkdir empty
run 3 render sphere.ply --camera empty -o a.pfm
says 'the directory holds no cameras'
run 3 render sphere.ply --camera sphere.ply -o a.pfm

# Packed archives, as numpy writes them
python=
for candidate in python3 /usr/bin/python3; do
  "$candidate" -c 'import numpy' 2> /dev/null && python=$candidate && break
done
if [[ -n $python ]] && "$conic" --version | grep -q '^In this build:.*zlib'; then
  "$python" - << 'END'
import numpy
v = numpy.diag([1.0, -1.0, -1.0, 1.0])
v[2, 3] = 4
k = numpy.array([[30, 0, 16], [0, 30, 12], [0, 0, 1]])
numpy.savez('stored.npz', viewmats=v[None].astype('f4'), Ks=k[None], width=32, height=24)
numpy.savez_compressed('packed.npz', viewmats=numpy.asfortranarray(v[None]), Ks=k[None].astype('f4'), width=32, height=[24])
END
  run 0 render sphere.ply --camera own.json -o own.pfm
  for archive in stored packed; do
    run 0 render sphere.ply --camera $archive.npz -o other.pfm
    cmp -s own.pfm other.pfm || fail "another picture by $archive.npz"
  done
fi
if [[ -r $garden ]]; then
  run 0 render sphere.ply --camera "$garden" --view all --size 54x35 -o out.d/g.pfm
  holds g.0000.pfm g.0001.pfm g.0002.pfm
fi

# A program that knows no other centre than the picture's
sed 's/"cx": 16/"cx": 17/' own.json > aside.json
run 2 render one.ply --camera aside.json --profile inria-2023 -o a.pfm
says 'inria-2023 ignores the camera'
run 0 render one.ply --camera aside.json --profile inria-2023 --ignore-center -o aside.pfm
run 0 render one.ply --camera own.json --profile inria-2023 -o own.pfm
cmp -s aside.pfm own.pfm || fail "the centre is not ignored"
run 0 render one.ply --camera aside.json --profile gsplat-1.6 -o aside.pfm
run 0 render one.ply --camera own.json --profile gsplat-1.6 -o own.pfm
cmp -s aside.pfm own.pfm && fail "gsplat ignores the centre"

[[ $failures -eq 0 ]]
