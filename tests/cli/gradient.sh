#!/usr/bin/env bash
# conic gradient: exit codes, what it writes and says, and the same bytes from any number of threads.
set -uo pipefail

source "$1/tests/support/program.bash"
has() { # PATTERN: in the output
  grep -qe "$1" out || fail "no \"$1\" in: $(head -c 1500 out)"
}

# Three Gaussians of several colours, faint and opaque, as .splat has them; the first two are at one place.
size='\0\0\200\76\0\0\0\77\0\0\200\76' turn='\200\177\220\200'
printf '\0\0\0\0\0\0\200\77\0\0\0\100'"$size"'\1\2\3\204'"$turn" > three.splat
printf '\0\0\0\0\0\0\200\77\0\0\0\100'"$size"'\377\376\3\200'"$turn" >> three.splat
printf '\0\0\200\76\0\0\200\77\0\0\200\77'"$size"'\177\100\60\360'"$turn" >> three.splat
run 0 convert three.splat -o three.ply
run 0 render three.splat --size 40x30 -o w.pfm
run 0 info three.ply --json info.json

# Of every profile that has a derivative.
for profile in exact inria-2023 gsplat-1.5 gsplat-1.5-aa gsplat-1.6 gsplat-1.6-aa khr-2026; do
  run 0 gradient three.splat --profile $profile --size 40x30 --weights w.pfm -o g.ply --json g.json
  has '^L = [0-9.e+]*; [1-3] of 3 Gaussians are shown, [0-3] with a decision in doubt ('
  run 0 gradient three.splat --profile $profile --size 40x30 --weights w.pfm -o h.ply --threads 1
  cmp -s g.ply h.ply || fail "$profile: other bytes with one thread"
done
grep -aq '^property double rot_3$' g.ply || fail "no property rot_3"
grep -aq '^property uint doubt$' g.ply || fail "no property doubt"
grep -aq '^comment gradient by s and o$' g.ply || fail "it does not say by what"
grep -q '"parameters": "activated"' g.json || fail "JSON does not say by what"
run 0 gradient three.ply --profile exact --size 40x30 --weights w.pfm -o raw.ply --raw --no-doubts --json -
has '"parameters": "raw"'
has '"world_to_camera": \[\['
grep -q doubtful out && fail "doubts, unasked"
grep -aq '^comment gradient by ln s and logit o$' raw.ply || fail "it does not say by what"
cmp -s g.ply raw.ply && fail "--raw changes nothing"

# Framed and drawn as conic does by itself; --quiet hides no result.
run_as_typed 0 gradient three.splat --size 40x30 --weights w.pfm --json one.json --quiet
has '^L = '

# What .npy holds: 1 × 1 × 5 numbers of float64.
printf '\223NUMPY\1\0\166\0%-117s\n' "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1, 5), }" > w.npy
printf '\0\0\0\0\0\0\360\77\0\0\0\0\0\0\0\100\0\0\0\0\0\0\0\0\0\0\0\0\0\0\360\77\0\0\0\0\0\0\0\0' >> w.npy
run 0 gradient three.splat --profile khr-2026 --size 1x1 --weights w.npy -o g.ply
has '^L = '
sed 's/(1, 1, 5)/(5, 1, 1)/' w.npy > bad.npy
run 3 gradient three.splat --profile khr-2026 --size 1x1 --weights bad.npy -o g.ply
printf '\0\0\0\0\0\0\370\177' | dd of=w.npy bs=1 seek=128 conv=notrunc status=none
run 3 gradient three.splat --profile khr-2026 --size 1x1 --weights w.npy -o g.ply

# Judged: what conic finds is right; the same of another profile, or of other parameters, is wrong.
at="--size 40x30 --weights w.pfm"
# shellcheck disable=SC2086 # words
{
  run 0 gradient three.ply --profile gsplat-1.6 $at -o g.ply --no-doubts --quiet
  run 0 judge three.ply --profile gsplat-1.6 $at --gradients g.ply --json judged.json
  has '^Gaussians 3 equal, 0 rounding, 0 explained, 0 wrong$'
  has '^right$'
  grep -q '"verdict": "right"' judged.json || fail "JSON gives no verdict: $(cat judged.json)"
  run 1 judge three.ply --profile khr-2026 $at --gradients g.ply
  has '^worst     Gaussian [0-2]: [a-z]*\[[0-9]*\] is '
  has '^WRONG$'
  run 0 judge three.ply --profile khr-2026 $at --gradients g.ply --max-wrong 3 --quiet
  has '^right$'
  run 1 judge three.ply --profile gsplat-1.6 $at --gradients g.ply --raw
  run 0 gradient three.ply --profile gsplat-1.6 $at -o g.ply --no-doubts --raw --quiet
  run 0 judge three.ply --profile gsplat-1.6 $at --gradients g.ply --raw --floats own --json -
  has '"parameters": "raw"'
  run 2 judge three.ply --profile exact $at --gradients g.ply
  run 2 judge three.ply --profile gsplat-1.6 --size 40x30 --gradients g.ply
  run 2 judge three.ply --profile gsplat-1.6 $at --picture w.pfm
  run 2 judge three.ply --profile gsplat-1.6 $at --gradients g.ply --json g.ply
  run 3 judge three.ply --profile gsplat-1.6 $at --gradients three.splat
  run 3 judge three.ply --profile gsplat-1.6 --size 41x30 --weights w.pfm --gradients g.ply
  run 0 make plane -n 4 -o plane.ply
  run 3 judge three.ply --profile gsplat-1.6 $at --gradients plane.ply
}

# What is refused.
rm -f g.ply
run 2 gradient three.splat --profile exact --size 40x30 -o g.ply
run 2 gradient three.splat --profile exact --size 40x30 --weights w.pfm
run 2 gradient three.splat --profile 2dgs-2024 --size 40x30 --weights w.pfm -o g.ply
run 2 gradient three.splat --profile surface --size 40x30 --weights w.pfm -o g.ply
run 2 gradient three.splat --profile exact --prefilter 0.3 --size 40x30 --weights w.pfm -o g.ply
run 2 gradient three.splat --profile exact --samples 2 --size 40x30 --weights w.pfm -o g.ply
run 2 gradient three.splat --profile exact --size 40x30 --weights w.pfm -o g.png
run 2 gradient three.splat --profile exact --size 40x30 --weights w.pfm -o w.pfm
run 3 gradient three.splat --profile exact --size 41x30 --weights w.pfm -o g.ply
run 3 gradient three.splat --profile exact --size 40x30 --weights three.splat -o g.ply
run 3 gradient three.splat --profile exact --size 40x30 --weights none.exr -o g.ply
run 4 gradient three.splat --profile exact --size 40x30 --weights w.pfm -o nowhere/g.ply
[[ ! -e g.ply ]] || fail "something stands there after a refusal"

[[ $failures -eq 0 ]]
