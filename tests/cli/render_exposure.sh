#!/usr/bin/env bash
# conic render --exposure: a number of stops, or auto, which is the same picture as the number that it finds.
set -uo pipefail

source "$1/tests/support/program.bash"
value() { # KEY FILE
  sed -nE "s/^ *\"$1\": \"?([^\",]*)\"?,?$/\1/p" "$2" | head -n 1
}

"$conic" make knot -n 5000 -o knot.ply
picture="--size 96x64 --samples 2"
for light in '' '--background 3,3,3' '--background none --aov rgba' '--cull back --turntable 3'; do
  # shellcheck disable=SC2086 # options and their values
  run 0 render knot.ply $picture $light --exposure auto -o auto.pfm --json auto.json
  stops=$(value exposure auto.json)
  [[ $stops != 0 ]] || fail "$light: the picture is as bright as it was"
  # shellcheck disable=SC2086
  run 0 render knot.ply $picture $light --exposure "$stops" -o fixed.pfm --json fixed.json
  [[ $(value exposure fixed.json) == "$stops" ]] || fail "$light: the exposure is not told"
  for file in auto*.pfm; do
    cmp "$file" "fixed${file#auto}" || fail "$light: $file is not the picture of --exposure $stops"
  done
  [[ ${last-$stops} == "$stops" || $light == *turntable* ]] || fail "$light: the background has a say in the exposure"
  last=$stops
  rm -f auto*.pfm fixed*.pfm
done
# Of a film, the first frame's goes for all; one frame by itself has its own
printf '%s\n' '-1 0 0 20 20 20' '-1 0 1 20 20 20' '-1 1 0 20 20 20' '-1 1 1 20 20 20' \
  '1 0 0 255 255 255' '1 0 1 255 255 255' '1 1 0 255 255 255' '1 1 1 255 255 255' > sides.xyz
turn="--size 32x32 --shade none --azimuth 90 --elevation 0 --turntable 2 --exposure auto"
# shellcheck disable=SC2086
run 0 render sides.xyz $turn -o turn.pfm --json turn.json
# shellcheck disable=SC2086
run 0 render sides.xyz $turn -o first.pfm --frames 1 --json first.json
# shellcheck disable=SC2086
run 0 render sides.xyz $turn -o second.pfm --frames 2 --json second.json
[[ $(value exposure turn.json) == "$(value exposure first.json)" ]] || fail "the first frame's exposure is not kept"
[[ $(value exposure turn.json) != "$(value exposure second.json)" ]] || fail "the second frame looks like the first"
# shellcheck disable=SC2086
run 0 render knot.ply $picture --exposure auto --threads 1 -o one.pfm
# shellcheck disable=SC2086
run 0 render knot.ply $picture --exposure auto --threads 3 --isa scalar -o three.pfm
cmp one.pfm three.pfm || fail "threads or instructions change the exposure"

for wrong in '' autos 101 -101 1x nan; do
  run 2 render knot.ply -o a.pfm "--exposure=$wrong"
done
for command in verify 'explain --pixel 1,1'; do
  # shellcheck disable=SC2086
  run 2 $command knot.ply --exposure auto
done
if "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  run 0 render knot.ply --size 8x8 --exposure auto -o a.exr
  grep -qa conicExposure a.exr || fail "the exposure is not in the picture's header"
fi

[[ $failures -eq 0 ]]
