#!/usr/bin/env bash
# conic render --ao, --shadow and --sky with a picture, of every kind of scene, and conic prepare --bake.
set -uo pipefail

source "$1/tests/support/program.bash"

if ! "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  echo "skipped: the planes are written as EXR files, which this build does not write"
  exit 77
fi
has_zstd=0
if "$conic" --version | grep -q '^In this build:.*zstd'; then
  has_zstd=1
fi

hash_of() { # FILE.json PLANE
  sed -n '/"hash"/,/}/s/.*"'"$2"'": "\([0-9a-f]*\)".*/\1/p' "$1"
}

run 0 make knot -n 5000 -o knot.ply
run 0 octree knot.ply -o knot.cot
printf 'v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv .5 1 .5\nf 5 2 1\nf 5 3 2\nf 5 4 3\nf 5 1 4\n' > tent.obj
printf 'v -2 0 -2\nv 3 0 -2\nv 3 0 3\nv -2 0 3\nf 9 8 7 6\n' >> tent.obj
scenes=("knot.ply" "knot.cot --error 2" "tent.obj" "tent.obj --as hybrid")
if [[ $has_zstd -eq 1 ]]; then
  run 0 layer knot.ply -o knot.lpc
  scenes+=("knot.lpc")
fi

# Light changes colours and fills its planes, and nothing else; threads and tiles change no bit of it.
# shellcheck disable=SC2086 # a scene is a file and its options
for scene in "${scenes[@]}"; do
  lit="$scene --size 64x64 --samples 2 --light 1,1,0.3 --aov rgba,Z,ao,shadow"
  run 0 render $scene --size 64x64 --samples 2 --light 1,1,0.3 --aov rgba,Z -o a.exr --json plain.json
  run 0 render $lit --ao 5 --shadow -o b.exr --json lit.json
  run 0 render $lit --ao 5 --shadow -o c.exr --json again.json --threads 3 --tile 8
  cmp -s b.exr c.exr || fail "$scene: threads or tiles change its light"
  [[ $(hash_of plain.json Z) == "$(hash_of lit.json Z)" ]] || fail "$scene: light changes Z"
  [[ $(hash_of plain.json rgba) != "$(hash_of lit.json rgba)" ]] || fail "$scene: light changes nothing"
  [[ $(sed -n 's/.*"splats_drawn": //p' plain.json) == "$(sed -n 's/.*"splats_drawn": //p' lit.json)" ]] ||
    fail "$scene: light changes what was counted"
done

# The planes alone ask for what fills them.
run 0 render knot.ply --size 32x32 --aov ao,shadow -o planes.exr --json planes.json
grep -q '"ao": 64' planes.json || fail "--aov ao draws no maps"

# A picture of the sky.
run 0 render knot.ply --size 32x16 --background 1,2,3 -o sky.exr
run 0 render knot.ply --size 32x32 --light none --sky sky.exr --ao 4 -o lit.exr --json sky.json
grep -q '"sky_picture": "sky.exr"' sky.json || fail "the sky is not named"
run 2 render knot.ply --size 32x32 --sky sky.exr -o lit.exr
run 3 render knot.ply --size 32x32 --sky none.exr --ao 4 -o lit.exr
run 2 render knot.ply --camera top --gsd 0.1 --shadow -o top.exr
run 2 render knot.ply --ao 0 -o lit.exr

# Baked into points: as a value by name, which colours can be made of, and as their colours.
run 0 prepare knot.ply --bake ao --directions 4 -o ao.ply --json bake.json
grep -q '"baked_directions": 4' bake.json || fail "--bake does not say from how many directions"
grep -aq '^property float ao$' ao.ply || fail "--bake ao writes no ao"
run 0 render ao.ply --size 32x32 --color-by ao -o ao.png
run 0 prepare knot.ply --bake color --directions 4 -o color.ply
run 2 prepare knot.ply --bake light -o color.ply

[[ $failures -eq 0 ]]
