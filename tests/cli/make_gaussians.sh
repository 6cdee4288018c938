#!/usr/bin/env bash
# conic make gaussians: every format that its name asks for, the same Gaussians in all, and what is refused.
set -uo pipefail

source "$1/tests/support/program.bash"

run 0 make gaussians -n 2k --degree 1 -o a.ply --json a.json
grep -q '"scene": "gaussians"' a.json && grep -q '"points_out": 2000' a.json || fail "$(cat a.json)"
run 0 make gaussians -n 2k --degree 1 -o b.ply --threads 1
cmp -s a.ply b.ply || fail "not the same twice"
run 0 make gaussians -n 2k --degree 1 --seed 1 -o b.ply
cmp -s a.ply b.ply && fail "another seed is the same"
run 0 info a.ply --check
grep -q '^gaussians  2000, 3D, harmonics of degree 1$' out && grep -q '^sound      yes' out || fail "$(cat out)"
# .glb has floats, too, and a frame of its own: a picture by one camera of each is the same, turned.
run 0 make gaussians -n 2k --degree 1 -o a.glb
run 0 convert a.glb -o back.ply
run_as_typed 0 render a.ply -o a.pfm --size 64x48
run_as_typed 0 render back.ply -o back.pfm --size 64x48
run 0 diff a.pfm back.pfm --display both --min-psnr 60
run_as_typed 0 render a.ply -o a.pfm --size 64x48 --profile gsplat-1.6

run 2 make gaussians -o a.obj
run 2 make gaussians
run 2 make gaussians -o a.ply --jitter 1
run 2 make gaussians -o a.ply --degree 5
run 2 make sphere -o a.ply --degree 1
run 4 make gaussians -n 2k -o missing/a.ply
[[ $failures -eq 0 ]]
