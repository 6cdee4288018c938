#!/usr/bin/env bash
# --method patch: what the command line promises of it.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

value() { # KEY FILE: the first number of a key in a JSON file
  sed -nE "s/^ *\"$1\": \"?([^\",]*)\"?,?$/\1/p" "$2" | head -n 1
}

hashes() { # FILE
  sed -n '/"hash": {/,/}/p' "$1"
}

run 0 make torus -n 1000 --jitter 0.5 -o torus.ply

# Near by, patches; the numbers add up, and the ids are those of points.
run 0 render torus.ply -o near.pfm --method patch --zoom 3 --size 96x96 --aov all --json near.json
[[ $(value method near.json) == patch && $(value conic near.json) -gt 1000 ]] || fail "method, or what draws the samples"
[[ $(value patches near.json) -gt 100 && $(value splats near.json) -lt 50 ]] || fail "no patches near by"
n_in=$(($(value splats near.json) + $(sed -n '/"primitives"/,/}/p' near.json | value samples /dev/stdin)))
[[ $n_in -eq $(value splats_in near.json) ]] || fail "primitives don't add up: $n_in"
# From afar, the very picture of the splats, given their tolerance.
run 0 render torus.ply -o far.pfm --method patch --zoom 0.2 --size 96x96 --aov all --epsilon 0.1 --json far.json
run 0 render torus.ply -o far.pfm --zoom 0.2 --size 96x96 --aov all --epsilon 0.1 --json splats.json
[[ $(value patches far.json) -eq 0 && $(value splats far.json) -eq 1000 ]] || fail "patches from afar"
[[ $(hashes far.json) == "$(hashes splats.json)" ]] || fail "the picture from afar is not that of the splats"

# Threads, tiles and instruction sets change no bit, nor does drawing twice.
for options in "--threads 5 --tile 16" "--isa scalar" "--repeat 3"; do
  # shellcheck disable=SC2086 # options are words
  run 0 render torus.ply -o again.pfm --method patch --zoom 3 --size 96x96 --aov all --json again.json $options
  [[ $(hashes again.json) == "$(hashes near.json)" ]] || fail "$options: other bits"
done

# A frame of a turntable, whose grids are partly those of the one before, is the picture drawn alone.
run 0 render torus.ply -o turn.pfm --method patch --zoom 3 --size 96x96 --turntable 5
run 0 render torus.ply -o alone.pfm --method patch --zoom 3 --size 96x96 --azimuth 318
cmp -s turn.0005.pfm alone.pfm || fail "a frame of a turntable is not the picture drawn alone"

# The oracle, explanations and samples.
run 0 verify torus.ply --method patch --zoom 3 --size 48x48
run 0 explain torus.ply --method patch --zoom 3 --size 48x48 --pixel 24,30 --json pixel.json
[[ $(value method pixel.json) == patch && $(value id pixel.json) -lt 1000 && $(value point pixel.json) -lt 1000 ]] ||
  fail "explain: whose samples these are"
run 0 render torus.ply -o samples.pfm --method patch --zoom 3 --size 48x48 --samples 2

# Raw points, trees of splats, other surfaces.
for ((i = 0; i < 400; i++)); do echo "$((i % 20)) $((i / 20)) $(((i * 37) % 5)).0e-1"; done > raw.xyz
run 0 render raw.xyz -o raw.pfm --method patch --size 48x48 --degree 2 --h 2x
run 0 octree torus.ply -o torus.cot
run 0 render torus.cot -o tree.pfm --method patch --zoom 3 --size 96x96 --aov all --json tree.json
[[ $(hashes tree.json) == "$(hashes near.json)" ]] || fail "other splats in the tree"
echo "1 2 3" > lone.xyz
run 0 render lone.xyz -o lone.pfm --method patch --size 16x16

# Out of sight from the first frame on: an empty picture.
run 0 render torus.ply -o empty.pfm --method patch --size 16x16 --near 100 --json empty.json
[[ $(value splats_in empty.json) -eq 0 && $(value pixels_covered empty.json) -eq 0 ]] || fail "the picture out of sight is not empty"

# What is asked for in vain.
run 2 render torus.cot -o x.pfm --method patch --error 2
run 2 render torus.ply -o x.pfm --method patch --deep x.exr
run 2 render torus.ply -o x.pfm --method patch --degree 5
run 2 render torus.ply -o x.pfm --method patch --as mesh
run 2 verify torus.ply --method patch --as mesh
run 2 bench --method patch
[[ ! -e x.pfm && ! -e x.exr ]] || fail "something was left of what failed"

exit $((failures > 0))
