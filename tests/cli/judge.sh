#!/usr/bin/env bash
# conic judge: what conic draws is right, whatever draws it and in whatever file it is; what differs is wrong; and what
# it says of it, in words, JSON, a map and a page.
set -uo pipefail

source "$1/tests/support/program.bash"
has() { # PATTERN: in the output
  grep -qe "$1" out || fail "no \"$1\" in: $(head -c 1500 out)"
}
told() { # PATTERN: in what is said of an error, which is one line
  grep -qe "$1" err && [[ $(wc -l < err) == 1 ]] || fail "no single line with \"$1\" in: $(head -c 800 err)"
}
if ! "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  echo "skipped: the runs draw EXR files, which this build does not write"
  exit 77
fi

# Gaussians, by every profile: two, the one behind the other, faint and of several colours, as .splat has them.
place='\0\0\0\0\0\0\200\77\0\0\0\100' behind='\0\0\0\77\0\0\200\76\0\0\200\77' size='\0\0\200\77\0\0\200\77\0\0\0\77' turn='\200\177\200\200'
printf "$place$size"'\1\2\3\204'"$turn$behind$size"'\377\376\3\200'"$turn" > two.splat
all=rgba,Z,N,count,id,T,medianZ,inverseZ,last
for profile in exact inria-2023 gsplat-1.5 gsplat-1.5-aa gsplat-1.6 gsplat-1.6-aa 2dgs-2024 2dgs-gsplat khr-2026; do
  run 0 render two.splat --profile $profile --size 32x24 --aov $all -o a.exr
  run 0 judge two.splat --profile $profile --size 32x24 --picture a.exr
  has '^right: 0 of 768 judged pixels are wrong$'
done
for floats in own strict fast; do
  run 0 judge two.splat --profile khr-2026 --size 32x24 --picture a.exr --floats $floats
done
run 1 judge two.splat --profile gsplat-1.6 --size 32x24 --picture a.exr
has '^WRONG: [0-9]* of 768 judged pixels are wrong$'
has '^worst     pixel [0-9]*,[0-9]*: .* it may be '
has '^          gaussian 0: weight '
run 0 judge two.splat --profile gsplat-1.6 --size 32x24 --picture a.exr --aov id
run 0 judge two.splat --profile gsplat-1.6 --size 32x24 --picture a.exr --max-wrong 768
has '^right: '
run 0 judge two.splat --profile khr-2026 --size 32x24 --picture a.exr --pixels 50 --time
has '^right: 0 of 50 judged pixels are wrong (the picture has 768)$'
has '^judge .* s$'
run 0 judge two.splat --profile khr-2026 --size 32x24 --picture a.exr --quiet
has '^right: 0 of 768 judged pixels are wrong$'

# A blank picture is no clue; who stands in a Gaussian is told how little can be seen wrong; and not all want a diagnosis.
camera='"width": 32, "height": 24, "fx": 30, "fy": 30, "cx": 16, "cy": 12, "world_to_camera": [[1,0,0,0],[0,-1,0,0],[0,0,-1'
echo "{$camera,2],[0,0,0,1]]}" > before.json
echo "{$camera,0.2],[0,0,0,1]]}" > inside.json
run 0 make gaussians -n 60 -o many.ply
{ printf 'PF\n32 24\n-1.0\n' && head -c 9216 /dev/zero; } > blank.pfm
run 1 judge many.ply --camera before.json --profile gsplat-1.6 --picture blank.pfm
has '^diagnosis the picture is blank'
run 1 judge many.ply --camera before.json --profile gsplat-1.6 --picture blank.pfm --no-diagnosis
if grep -q '^diagnosis' out; then fail "--no-diagnosis diagnoses"; fi
run 0 render many.ply --camera inside.json --profile gsplat-1.6 -o inside.exr
run 1 judge many.ply --camera inside.json --profile gsplat-1.6 --picture inside.exr --json j.json
has '^UNDECIDED: 0 of 768'
has '^vague     [1-9].* by Gaussians [0-9]'
grep -q '"verdict": "undecided"' j.json || fail "the JSON does not say undecided"
run 0 judge many.ply --camera inside.json --profile gsplat-1.6 --picture inside.exr --allow-vague
has '^right: 0 of 768'

# Splats by every method, a mesh and a hybrid; conic's own files say how many samples they have.
run 0 make knot -n 500 -o knot.ply
printf 'v -1 -1 0\nv 1 -1 0\nv 1 1 .5\nv -1 1 .2\nv 0 0 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n' > tent.obj
for method in conic affine ray auto disc point; do
  run 0 render knot.ply --method $method --size 48x40 --aov all -o k.exr
  run 0 judge knot.ply --method $method --size 48x40 --picture k.exr
  run 0 judge knot.ply --method $method --size 48x40 --picture k.exr --floats own
  has '^right: 0 of 1920 judged pixels are wrong$'
done
run 1 judge knot.ply --method conic --size 48x40 --picture k.exr
has '^          splat [0-9]*: weight '
run 0 render tent.obj --as mesh --size 48x40 --aov all -o t.exr
run 0 judge tent.obj --as mesh --size 48x40 --picture t.exr
run 1 judge tent.obj --as mesh --size 48x40 --picture t.exr --shade none
has '^          triangle [0-9]*: weight '
run 0 hybrid tent.obj -o tent.chy
run 0 render tent.chy --size 48x40 -o t.exr
run 0 judge tent.chy --size 48x40 --picture t.exr
run 0 render knot.ply --size 48x40 --samples 3 -o k.exr
run 0 judge knot.ply --size 48x40 --picture k.exr
run 1 judge knot.ply --size 48x40 --picture k.exr --samples 1

# Planes in files beside the picture.
run 0 render two.splat --profile khr-2026 --size 32x24 --aov $all -o p.pfm
ls p.Z.pfm p.id.pfm p.T.pfm > /dev/null || fail "no planes beside p.pfm"
run 0 judge two.splat --profile khr-2026 --size 32x24 --picture p.pfm
has '^medianZ '
has '^id '
head -c 100 p.Z.pfm > cut && cp cut p.Z.pfm
run 3 judge two.splat --profile khr-2026 --size 32x24 --picture p.pfm
told 'p.Z.pfm: '

# JSON, the map and the page.
run 0 render two.splat --profile khr-2026 --size 32x24 --aov rgba,Z -o a.exr
run 1 judge two.splat --profile exact --size 32x24 --picture a.exr --json j.json --map m.png --report r.html
for key in verdict pixels equal rounding explained wrong diagnosis worst explained_by; do
  grep -q "\"$key\":" j.json || fail "no $key in the JSON"
done
grep -q '"verdict": "wrong"' j.json || fail "the JSON does not say wrong"
grep -q 'conic judge' r.html && [[ $(grep -o 'data:image/png;base64,' r.html | wc -l) -ge 7 ]] || fail "the page lacks pictures"
! grep -qi 'http\|<script\|src="[^d]' r.html || fail "the page needs something else"
grep -q 'Pixel [0-9]*, [0-9]*' r.html || fail "the page names no pixel"
run 0 judge two.splat --profile khr-2026 --size 32x24 --picture a.exr --json j.json --report r.html --map m.png
grep -q '"diagnosis": \[\]' j.json && grep -q '"verdict": "right"' j.json || fail "the JSON does not say right"
[[ $(head -c 4 m.png | tail -c 3) == PNG ]] || fail "the map is no PNG"

# What cannot be judged.
run 3 judge two.splat --profile khr-2026 --size 33x24 --picture a.exr
told 'a.exr: it has 32 x 24 pixels'
head -c 700 a.exr > cut.exr
run 3 judge two.splat --profile khr-2026 --size 32x24 --picture cut.exr
told 'cut.exr: '
run 3 judge two.splat --profile khr-2026 --size 32x24 --picture none.exr
told 'none.exr: '
run 3 judge two.splat --profile khr-2026 --size 32x24 --picture two.splat
told 'two.splat: '
run 3 judge knot.ply --size 32x24 --picture a.exr --aov weight
told 'no plane that is judged'
run 2 judge two.splat --profile khr-2026 --size 32x24
run 2 judge two.splat --profile khr-2026 --size 32x24 --picture a.exr --map a.exr
run 2 judge two.splat --profile khr-2026 --size 32x24 --picture a.exr --aov albedo
run 2 judge two.splat --profile khr-2026 --size 32x24 --picture a.exr --report r.txt.png

# Pictures that others write: NumPy's, and PNG of 8 and 16 bits.
if ! python3 -c 'import numpy' 2> /dev/null; then
  echo "skipped: pictures of NumPy's, since python3-numpy is not installed"
  [[ $failures -eq 0 ]]
  exit
fi
run 0 render two.splat --profile khr-2026 --size 32x24 --aov rgba,Z,id -o p.pfm
python3 "$1/tests/cli/judge_pictures.py" p
judge() { # EXIT_CODE PICTURE ARGUMENTS …
  run "$1" judge two.splat --profile khr-2026 --size 32x24 --picture "${@:2}"
}
for file in rgb.npy rgb64.npy chw.npy batch.npy half.npy bytes.npy floor.npy words.npy all.npz deflated.npz; do
  judge 0 $file
  has '^right: '
done
judge 0 rgb.npy && has '^Z '
judge 1 wrong.npy && has '^WRONG: 1 of 768'
judge 1 wrong.npy && has 'pixel 5,7: G is '
judge 0 wrong.npy --max-wrong 1
judge 1 nan.npy && has '^WRONG: 2 of 768'
judge 1 floor.npy --codes nearest
judge 3 size.npy && told 'size.npy: it has 31 x 24'
judge 3 shape.npy && told 'shape'
judge 3 cut.npy && told 'cut.npy: '
judge 3 names.npz && told 'names.npz: '
if ! "$conic" --version | grep -q '^In this build:.*libpng'; then
  echo "skipped: PNG files, which this build does not read by itself"
  [[ $failures -eq 0 ]]
  exit
fi
for file in codes8.png codes16.png opaque8.png; do
  judge 0 $file
  has '^right: '
done
judge 0 opaque8.png && has '^alpha is full'
judge 0 srgb8.png --transfer srgb
judge 1 srgb8.png
judge 1 toned8.png
judge 3 cut.png && told 'cut.png: '
run 0 render knot.ply --size 48x40 --background none -o k.png # sRGB, and straight alpha
run 0 judge knot.ply --size 48x40 --picture k.png
run 1 judge knot.ply --size 48x40 --picture k.png --transfer linear

[[ $failures -eq 0 ]]
