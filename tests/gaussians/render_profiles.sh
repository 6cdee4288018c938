#!/usr/bin/env bash
# conic render --profile: which scenes are composited, by what, and which bits come out.
set -uo pipefail

source "$1/tests/support/program.bash"
data=$1/../shared/data/gaussians

# Two Gaussians at the same place, as .splat has them.
row='\0\0\0\0\0\0\200\77\0\0\0\100\0\0\200\77\0\0\200\77\0\0\0\77\1\2\3\4\200\177\200\200'
printf "$row$row" > two.splat
run 0 convert two.splat -o two.ply

hash_of() { # PLANE, of the JSON in `out`
  grep -o "\"$1\": \"[0-9a-f]*\"" out | head -1
}

# By default exact; with --plain, as splats; --profile goes before both.
run_as_typed 0 render two.ply --size 40x40 -o a.exr --json -
grep -q '"profile": "exact"' out || fail "the default is not exact: $(cat out)"
run 0 render two.ply --size 40x40 -o a.exr --json -
grep -q '"profile"' out && fail "--plain composites"
plain=$(hash_of rgba)
run_as_typed 0 render two.ply --plain --profile surface --size 40x40 -o a.exr --json -
[[ $(hash_of rgba) == "$plain" ]] || fail "surface is not what --plain draws"
for profile in inria-2023 gsplat-1.5 gsplat-1.5-aa gsplat-1.6 gsplat-1.6-aa 2dgs-2024 2dgs-gsplat khr-2026 exact; do
  run 0 render two.ply --profile $profile --size 40x40 --aov rgba,T,Z,N,count,id,last,medianZ,inverseZ -o $profile.exr --json -
  grep -q "\"profile\": \"$profile\"" out || fail "$profile: $(cat out)"
  wanted=$(hash_of rgba)$(hash_of T)$(hash_of count)
  for how in "--threads 1" "--isa scalar" "--isa sse2" "--tile 16"; do
    # shellcheck disable=SC2086
    "$conic" render two.ply --plain --profile $profile --size 40x40 --aov rgba,T,count -o a.exr --json - $how > out 2> err || continue
    [[ $(hash_of rgba)$(hash_of T)$(hash_of count) == "$wanted" ]] || fail "$profile $how: other bits"
  done
done
run 1 diff exact.exr gsplat-1.6.exr
# What is named is drawn as its program draws it, a sample a pixel; what is looked at has several.
for pair in ':2' '--profile gsplat-1.6:1' '--profile exact:1' '--profile gsplat-1.6 --quality good:2' '--profile surface:2'; do
  # shellcheck disable=SC2086
  run_as_typed 0 render two.ply --size 40x40 -o a.exr --json - ${pair%:*}
  grep -q "\"samples\": ${pair#*:}," out || fail "${pair%:*}: $(grep samples out)"
done
# exact takes a filter, and no other profile does.
run 0 render two.ply --profile exact --prefilter 1 --size 40x40 --aov rgba,T,Z,N,count,id,last,medianZ,inverseZ -o a.exr
run 1 diff exact.exr a.exr
run 0 render two.ply --profile exact --prefilter 0 --size 40x40 --aov rgba,T,Z,N,count,id,last,medianZ,inverseZ -o a.exr
run 0 diff exact.exr a.exr
run 2 render two.ply --profile gsplat-1.6 --prefilter 1 --size 40x40 -o a.exr
for what in "--exposure auto" "--error 1"; do
  # shellcheck disable=SC2086
  run_as_typed 2 render two.ply --size 40x40 -o a.exr $what
done
run_as_typed 0 verify two.ply --size 40x40
run_as_typed 0 verify two.ply --size 40x40 --profile exact
run_as_typed 0 render two.ply --size 40x40 -o a.png --overdraw o.png --samples 3 --background 1,0,0
run 2 render two.ply --profile gsplat-9 --size 40x40 -o a.exr
run 2 render two.ply --size 40x40 --aov T -o a.exr
grep -q 'Gaussian' err || fail "T of splats: $(cat err)"

if [[ ! -e $data/biker.spz ]]; then
  echo "skipped: $data/biker.spz is not there"
  [[ $failures -eq 0 ]]
  exit
fi
# The same scene twice, as two formats round it, in the frame of one.
run 0 convert "$data/biker.spz" -o a.ply
run 0 render a.ply --profile exact --size 200x200 -o a.exr
run 0 render "$data/biker.compressed.ply" --profile exact --size 200x200 -o b.exr
run 1 diff a.exr b.exr --json -
psnr=$(grep -o '"psnr": [0-9.]*' out | grep -o '[0-9.]*$')
perl -e 'exit !($ARGV[0] > 45)' "${psnr:-0}" || fail "biker differs by file: $psnr dB"

[[ $failures -eq 0 ]]
