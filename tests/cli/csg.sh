#!/usr/bin/env bash
# conic csg: what the command line promises. What it makes is held by tests/surface/test_solids.c.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

run 0 make cube -n 3000 -o cube.ply
run 0 make sphere -n 3000 -o ball.ply --far 0.9,0.7,0.8
run 0 csg cube.ply ball.ply --difference -o bitten.ply
run 0 csg cube.ply ball.ply --difference -o one.ply --threads 1
cmp -s bitten.ply one.ply || fail "threads change the file"
"$conic" csg - ball.ply --difference -o piped.ply < cube.ply || fail "from standard input"
cmp -s bitten.ply piped.ply || fail "a pipe changes the file"

# Meshes and raw points are solids, too.
cat > tent.obj << 'END'
v -1 -1 -1
v 1 -1 -1
v 0 1 -1
v 0 0 1
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
END
run 0 csg ball.ply tent.obj --union -o union.ply

for options in "cube.ply ball.ply -o x.ply" "cube.ply ball.ply -o x.ply --union --difference" "cube.ply -o x.ply --union" \
  "cube.ply ball.ply ball.ply -o x.ply --union" "cube.ply ball.ply --union" "cube.ply ball.ply -o ball.ply --union" \
  "cube.ply ball.ply -o x.png --union"; do
  # shellcheck disable=SC2086 # several words
  run 2 csg $options
done
run 3 csg cube.ply gone.ply -o x.ply --union
run 0 make sphere -n 500 -o far.ply --far 9,9,9
run 3 csg cube.ply far.ply -o x.ply --intersection
[[ ! -e x.ply ]] || fail "a file that was refused is there"
[[ $failures -eq 0 ]]
