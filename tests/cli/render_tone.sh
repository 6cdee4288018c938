#!/usr/bin/env bash
# conic render --tone: files of codes go through the curve; linear ones, other planes and display values do not.
set -uo pipefail

source "$1/tests/support/program.bash"
"$conic" make knot -n 5000 -o knot.ply
picture="knot.ply --size 96x64 --exposure 2 --aov rgba,N,albedo"
files=(pfm)
has_png=0
"$conic" --version | grep -q '^In this build:.*OpenEXR' && files+=(exr)
"$conic" --version | grep -q '^In this build:.*libpng' && has_png=1 files+=(png)

draw() { # NAME ARGUMENTS …
  local name=$1 file
  shift
  for file in "${files[@]}"; do
    # shellcheck disable=SC2086 # options and their values
    run 0 render $picture "$@" -o "$name.$file" --json "$name.json"
  done
}
is_same() { # FILE FILE
  cmp -s "$1" "$2" || fail "$1 is not $2"
}
is_other() {
  cmp -s "$1" "$2" && fail "$1 is $2"
}

draw plain
draw srgb --tone srgb
draw filmic --tone filmic
draw aces --tone aces
draw agx --tone agx
draw threads --tone aces --threads 3
for tone in srgb filmic aces agx; do
  is_same $tone.pfm plain.pfm
  [[ ! -e plain.exr ]] || is_same $tone.exr plain.exr
  grep -q "\"tone\": \"$tone\"" $tone.json || fail "$tone is not told"
  if ((has_png)); then
    is_same $tone.N.png plain.N.png
    is_same $tone.albedo.png plain.albedo.png
  fi
done
if ((has_png)); then
  is_same srgb.png plain.png
  is_same threads.png aces.png
  is_other filmic.png plain.png
  is_other aces.png plain.png
  is_other aces.png filmic.png
  is_other agx.png aces.png
  printf '\0\0\0\0\0\0\200\77\0\0\0\100\0\0\200\77\0\0\200\77\0\0\0\77\1\2\3\4\200\177\200\200' > two.splat
  run 0 render two.splat --profile exact --size 40x40 -o display.png
  run 0 render two.splat --profile exact --size 40x40 -o toned.png --tone filmic --json toned.json
  grep -q 'display values' err || fail "nobody says that the curve is not of display values"
  grep -q '"tone": "srgb"' toned.json || fail "a curve is told that was not used"
  is_same toned.png display.png
fi
run 2 render knot.ply -o a.pfm --tone reinhard
run 2 render knot.ply --camera top -o a.tif --tone aces
[[ $failures -eq 0 ]]
