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

# Lamps light every kind of scene, with shadows and without.
# shellcheck disable=SC2086 # a scene is a file and its options
for scene in "${scenes[@]}"; do
  lamp="$scene --size 64x64 --samples 2 --light lamp:1,3,1:9 --aov rgba,shadow"
  run 0 render $lamp -o a.exr --json plain.json
  run 0 render $lamp --shadow -o b.exr --json lit.json
  run 0 render $lamp --shadow -o c.exr --json again.json --threads 3 --tile 8
  run 0 render $scene --size 64x64 --samples 2 --light none -o d.exr --aov rgba --json dark.json
  cmp -s b.exr c.exr || fail "$scene: threads or tiles change its lamp"
  [[ $(hash_of dark.json rgba) != "$(hash_of lit.json rgba)" ]] || fail "$scene: a lamp changes nothing"
done

# Samples of lamps and suns that have a size are the same, however a run is cut.
soft="knot.ply --size 32x32 --shadow --light 1,2,1:1:8deg --light lamp:0,3,0:5:0.5 --light lamp:2,2,0:3:1x0.5:-1,-1,0"
# shellcheck disable=SC2086 # several options
{
  run 0 render $soft --accumulate 6 -o whole.exr --json whole.json
  run 0 render $soft --accumulate 4 --resumable -o part.exr
  run 0 render $soft --accumulate 6 --resume part.exr -o rest.exr --json rest.json
  run 0 render ${soft//:8deg/} --accumulate 6 -o hard.exr --json hard.json
}
[[ $(hash_of whole.json rgba) == "$(hash_of rest.json rgba)" ]] || fail "a cut changes soft light"
[[ $(hash_of whole.json rgba) != "$(hash_of hard.json rgba)" ]] || fail "a sun's disc changes nothing"
grep -q '"kind": "rectangle"' whole.json || fail "the lamps are not named"

# What changes nothing is said, and nothing else.
warns() { # WORD, or none; OPTIONS
  local word="$1"
  shift
  "$conic" render knot.ply --size 16x16 -o w.exr "$@" 2> warned.txt || fail "$*: it ends with $?"
  if [[ -z $word ]]; then
    ! grep -q warning warned.txt || fail "$*: $(cat warned.txt)"
  else
    grep -q "warning: .*$word" warned.txt || fail "$*: it does not warn of $word"
  fi
}
warns 'shadow changes nothing' --shadow --light head
warns 'shadow changes nothing' --shadow --light none
warns 'no light (--shade none)' --ao 4 --shade none
warns 'shine from their middle' --shadow --light 1,2,1:1:2deg
warns '' --shadow --light 1,2,1
warns '' --shadow --light lamp:1,2,1 --light head
warns '' --shadow --shade none --aov shadow
warns '' --accumulate 2 --shadow --light 1,2,1:1:2deg

# The planes alone ask for what fills them.
run 0 render knot.ply --size 32x32 --aov ao,shadow -o planes.exr --json planes.json
grep -q '"ao": 64' planes.json || fail "--aov ao draws no maps"

# A picture of the sky.
run 0 render knot.ply --size 32x16 --background 1,2,3 -o sky.exr
run 0 render knot.ply --size 32x32 --light none --sky sky.exr --ao 4 -o lit.exr --json sky.json
grep -q '"sky_picture": "sky.exr"' sky.json || fail "the sky is not named"
run 0 render knot.ply --size 32x32 --light none --sky sky.exr --ao 4 --reflect 0.5 -o mirror.exr
run 0 render knot.ply --size 32x32 --light none --sky sky.exr --ao 4 --reflect 0.5 -o c.exr --threads 3 --tile 8
cmp -s mirror.exr c.exr || fail "threads or tiles change what is mirrored"
run 1 diff lit.exr mirror.exr
run 2 render knot.ply --size 32x32 --reflect 0.5 -o lit.exr
run 2 render knot.ply --size 32x32 --sky sky.exr -o lit.exr
run 3 render knot.ply --size 32x32 --sky none.exr --ao 4 -o lit.exr
printf 'PF\n2 1\n-1\n' > below.pfm
printf '\0\0\200\277%.0s' 1 2 3 4 5 6 >> below.pfm
"$conic" render knot.ply --size 32x32 --light none --sky below.pfm --ao 4 -o lit.exr 2> said.txt && fail "no light lights"
grep -q 'below.pfm: no light: no colour is above 0' said.txt || fail "a dark sky is not named: $(cat said.txt)"
run 2 render knot.ply --camera top:0.1 --shadow -o top.exr
run 2 render knot.ply --ao 0 -o lit.exr

# Baked into points: as a value by name, which colours can be made of, and as their colours.
run 0 prepare knot.ply --bake ao --directions 4 -o ao.ply --json bake.json
grep -q '"baked_directions": 4' bake.json || fail "--bake does not say from how many directions"
grep -aq '^property float ao$' ao.ply || fail "--bake ao writes no ao"
run 0 render ao.ply --size 32x32 --color-by ao -o ao.png
run 0 prepare knot.ply --bake color --directions 4 -o color.ply
run 2 prepare knot.ply --bake light -o color.ply

[[ $failures -eq 0 ]]
