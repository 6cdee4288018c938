#!/usr/bin/env bash
# conic verify and conic explain of Gaussian scenes: exit codes, what they say, and the plane doubt.
set -uo pipefail

source "$1/tests/support/program.bash"
data=$1/../shared/data/gaussians
has() { # PATTERN: in the output
  grep -qe "$1" out || fail "no \"$1\" in: $(head -c 1500 out)"
}

# Two Gaussians at one place, faint and of several colours, as .splat has them.
place='\0\0\0\0\0\0\200\77\0\0\0\100' size='\0\0\200\77\0\0\200\77\0\0\0\77' turn='\200\177\200\200'
printf "$place$size"'\1\2\3\204'"$turn$place$size"'\377\376\3\200'"$turn" > two.splat
run 0 convert two.splat -o two.ply

# Every profile, drawn here and read from files.
for profile in exact inria-2023 gsplat-1.5 gsplat-1.5-aa gsplat-1.6 gsplat-1.6-aa 2dgs-2024 2dgs-gsplat khr-2026; do
  run 0 verify two.splat --profile $profile --size 40x40
  has '^pass$'
  has '^judged    1600 of 1600 pixels: .* 0 wrong$'
  has '^medianZ  *max '
  run 0 verify two.splat --profile $profile --size 20x20 --samples 2
done
run 0 render two.splat --profile gsplat-1.6 --size 40x40 --aov rgba,Z,N,count,id,T,medianZ,inverseZ,last -o a.exr
run 0 verify two.splat --profile gsplat-1.6 --size 40x40 --image a.exr
run 1 verify two.splat --profile khr-2026 --size 40x40 --image a.exr
has '^worst     pixel [0-9]*,[0-9]*: '
has '^FAILED$'
run 1 verify two.splat --profile khr-2026 --size 40x40 --image a.exr --json -
has '"pass": false'
run 3 verify two.splat --profile gsplat-1.6 --size 41x40 --image a.exr
run 0 verify two.splat --profile exact --size 40x40 --samples 2 --background 1,0.5,0 --aov rgba
grep -q '^Z' out && fail "Z, unasked"
run 0 verify two.splat --profile exact --size 40x40 --pixels 100
has '^judged    100 of 1600 pixels'
cp out first
run 0 verify two.splat --profile exact --size 40x40 --pixels 100 --threads 1
cmp -s out first || fail "other pixels with one thread"
run 0 verify two.splat --profile exact --size 40x40 --quiet
has '^pass$'
run 2 verify two.splat --profile exact --size 40x40 --against exact
run 2 verify two.splat --profile exact --size 40x40 --aov albedo
run 2 verify two.splat --profile exact --size 40x40 --aov doubt
run_as_typed 0 verify two.splat --size 40x40
has 'doubtful'
run_as_typed 0 verify two.ply --size 40x40 --profile surface
has 'unstable'

# In exact, the order of the two is in doubt wherever both are; the plane and explain say so.
run 0 render two.splat --profile exact --size 40x40 --aov rgba,doubt -o doubt.exr --json -
has '"doubt": "'
run 0 info doubt.exr
has 'doubt'
run 0 explain two.splat --profile exact --size 40x40 --pixel 20,20
has '"profile": "exact"'
has '"doubts": [1-9]'
has '"doubt": \["order"\]'
has '"end": "all"'
has '"composited": 2'
[[ $(grep -c '"gaussian": ' out) == 2 ]] || fail "not two Gaussians: $(cat out)"
run 0 explain two.splat --profile gsplat-1.6 --size 40x40 --pixel 20,20
has '"doubts": 0'
run 2 explain two.splat --profile exact --size 40x40 --pixel 40,20
run 2 explain two.splat --profile exact --size 40x40 --splat 0
run 0 explain two.ply --profile surface --size 40x40 --splat 0
run 2 render two.ply --profile surface --size 40x40 --aov doubt -o a.exr

# With a surface behind them
printf 'v -9 -9 3\nv 9 -9 3\nv 0 12 3\nf 1 3 2\n' > wall.obj
both=(two.splat wall.obj --profile gsplat-1.6 --size 40x40)
run 0 render "${both[@]}" -o both.exr
run 0 judge "${both[@]}" --picture both.exr
run 1 judge "${both[@]}" --picture a.exr
run 0 explain "${both[@]}" --pixel 20,20
has '"surface": {'
run 0 make gaussians -n 9 -o nine.ply
run 0 project nine.ply --profile gsplat-1.6 --size 40x40 -o nine.npz
run 0 gradient "${both[@]}" --weights both.exr -o both.ply
run 2 judge "${both[@]}" --weights both.exr --gradients both.ply
grep -q 'leave the surfaces out; conic gradient takes both' err || fail "$(cat err)"
run 2 judge nine.ply wall.obj --profile gsplat-1.6 --size 40x40 --intermediates nine.npz
grep -q 'before they are composited: leave the surfaces out' err || fail "$(cat err)"
run 2 project "${both[@]}" -o t.csv
grep -q 'leave the others out; conic render, verify' err || fail "$(cat err)"

# Glass among Gaussians: each sample, and the mean that is drawn
printf 'newmtl pane\nKd 0.8 0.3 0.2\nd 0.4\n' > pane.mtl
printf 'mtllib pane.mtl\nusemtl pane\nv -2 -2 -1\nv 2 -2 1\nv 2 2 1\nv -2 2 -1\nf 1 2 3 4\n' > pane.obj
run 0 make gaussians -n 100 -o scene.ply
glass=(scene.ply pane.obj --as mesh --profile gsplat-1.6 --size 40x30 --transparency)
run 0 verify "${glass[@]}" --sample 3
has '0 wrong$'
run 0 verify "${glass[@]}" --accumulate 5
has '^samples   5, 0 pixels of their mean wrong$'
has '^judged    6000 of 6000 pixels: .* 0 wrong$'
run 0 render "${glass[@]}" --accumulate 5 --aov rgba,T -o glass.exr
run 0 verify "${glass[@]}" --accumulate 5 --image glass.exr --aperture 0
run 1 verify "${glass[@]}" --accumulate 4 --image glass.exr
has '^samples   4, [1-9][0-9]* pixels of their mean wrong$'
has '^worst     pixel'
run 1 verify "${glass[@]:0:8}" --accumulate 5 --image glass.exr
run 2 verify "${glass[@]}"
grep -q 'give --accumulate N' err || fail "$(cat err)"
run 2 verify "${glass[@]}" --accumulate 2 --aov rgba,Z
grep -q 'it judges rgba and T' err || fail "$(cat err)"
run 2 verify pane.obj --as mesh --transparency --sample 1
grep -q 'those alone are judged as opaque' err || fail "$(cat err)"

if [[ ! -e $data/biker.spz ]] || ! "$conic" --version | grep -q '^In this build:.*zstd'; then
  echo "skipped: $data/biker.spz is not there, or this build does not read it"
  [[ $failures -eq 0 ]]
  exit
fi
run 0 verify "$data/biker.spz" --profile gsplat-1.6 --size 1920x1080 --pixels 2000
run 0 verify "$data/biker.spz" --profile exact --size 300x300 --pixels 2000
has '^doubtful  .*order'

[[ $failures -eq 0 ]]
