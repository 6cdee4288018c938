#!/usr/bin/env bash
# What is drawn where nobody says as what: triangles where a file has faces, splats where not, by every command.
set -uo pipefail

# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

printf 'v %s\n' '0 0 0' '1 0 0' '1 0 1' '0 0 1' '.5 .5 .5' > tent.obj
printf 'f %s\n' '1 5 2' '2 5 3' '3 5 4' '4 5 1' >> tent.obj
{
  cat tent.obj
  printf 'v %s\n' '3 0 0' '3 1 0' '3 0 1'
} > beside.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 1 2\n' > line.obj
run 0 make sphere -n 500 -o ball.ply

# drawn SPLATS TRIANGLES FILES and options: what a picture is made of
drawn() {
  run_as_typed 0 render "${@:3}" -o a.pfm --size 64x64 --json a.json
  local is
  is=$(sed -n '/"primitives"/,/}/ s/.*"\(splats\|triangles\)": \([0-9]*\).*/\1 \2/p' a.json | paste -sd ' ')
  [[ $is == "splats $1${2:+ triangles $2}" ]] || fail "${*:3}: $is, not $1 and $2"
}

drawn 0 4 tent.obj
drawn 0 4 tent.obj --as auto --smooth
drawn 3 4 beside.obj
drawn 500 4 tent.obj ball.ply
drawn 500 '' ball.ply
drawn 4 '' line.obj
grep -q '^conic: warning: line.obj: no face has three .*; the points are drawn$' err || fail "no word about line.obj"
drawn 12 '' tent.obj --as points
drawn 12 '' tent.obj --plain
run_as_typed 2 render tent.obj -o a.pfm --smooth --crease 20
run_as_typed 2 render tent.obj -o a.pfm --as points --crease 20
run_as_typed 0 render tent.obj -o a.pfm --error 1
run_as_typed 0 verify beside.obj --size 48x48
run_as_typed 0 explain beside.obj --size 64x48 --pixel 20,25
run_as_typed 0 render tent.obj --method patch -o a.pfm --size 64x64
# What a model has and no picture shows is said, once
printf 'mtllib said.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nl 1 2\nl 2 3\n' > said.obj
printf 'newmtl a\nKd 1 0 0\nd 0.5\nTr 0.5\n' > said.mtl
run_as_typed 0 render said.obj -o said.pfm
[[ $(grep -c 'lines are not drawn.*(line 7)' err) -eq 1 && $(grep -c 'drawn opaque.*--transparency' err) -eq 1 ]] || fail "$(cat err)"
printf 'newmtl a\nKd 1 0 0\nd 1\nTr 0\n' > said.mtl
run_as_typed 0 render said.obj -o said.pfm
grep -q opaque err && fail "what is opaque is warned of"

# A value that is not understood: what the option is for stands beside it
run_as_typed 2 render said.obj -o said.pfm --tile many
grep -q 'it takes N: the edge, in pixels' err || fail "$(cat err)"

[[ $failures -eq 0 ]]
