#!/usr/bin/env bash
# conic bench: what it prints and writes, and what it refuses. No test here knows a time.
set -uo pipefail

source "$1/tests/support/program.bash"
has() { # PATTERN: in the output
  grep -qe "$1" out || fail "no \"$1\" in: $(head -c 1500 out)"
}
lines() { # NUMBER: of lines in the statistics in FILE
  [[ $(grep -cE '^    "[^"]+/[a-z]+/[a-z0-9]+/[0-9]+": \{' "$2") -eq $1 ]] || fail "not $1 lines: $(grep -E '^    "' "$2")"
}

small=(--size 64x48 --repeat 2)

# The table, and the statistics
run 0 bench --scenes sphere-2k,mixed-100 --methods conic,nearest --isa scalar,auto --threads 1,2 "${small[@]}" --json old.json
has '^sphere-2k@64x48/conic/scalar/1 '
has '^mixed-100@64x48/nearest/[a-z0-9]*/2 '
[[ $(grep -c '^[a-z0-9-]*@' out) -eq 16 ]] || fail "not 16 lines in the table"
lines 16 old.json
[[ $(grep -c '"identical": true' old.json) -eq 16 ]] || fail "not every picture is said to be right"
grep -q '"wrong_pictures": 0' old.json || fail "no count of wrong pictures"
for key in cycles instructions cpu_ms; do
  [[ $(grep -c "\"$key\": [0-9n]" old.json) -eq 16 ]] || fail "no $key, not even null"
done
# One picture by every instruction set and number of threads: two methods and two scenes, four in all
[[ $(grep '"rgba": "' old.json | sort -u | wc -l) -eq 4 ]] || fail "not four pictures"
# The same as conic render draws
run 0 make sphere -n 2k -o sphere.ply
run 0 bench sphere.ply --scenes sphere-2k --threads 1 "${small[@]}" --json -
lines 2 out
run 0 render sphere.ply -o sphere.pfm --method conic --size 64x48 --json render.json
run 0 bench sphere.ply --threads 1 "${small[@]}" --json -
grep -qF "$(grep -o '"rgba": "[0-9a-f]*"' render.json)" out || fail "bench draws a file otherwise than render"
cat > camera.json << 'END'
{"width": 90, "height": 90, "fx": 80, "fy": 75, "cx": 44, "cy": 36,
 "world_to_camera": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 3], [0, 0, 0, 1]]}
END
run 0 render sphere.ply -o sphere.pfm --method conic --camera camera.json --cull back --json render.json
run 0 bench sphere.ply --camera camera.json --cull back --size 90x90 --repeat 1 --threads 1 --json -
grep -qF "$(grep -o '"rgba": "[0-9a-f]*"' render.json)" out || fail "bench takes the camera otherwise than render"

# What chooses what it draws does so as conic render does, by every number of threads
run 0 octree sphere.ply -o sphere.cot
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' > solid.obj
run 0 hybrid solid.obj -o solid.chy
run 0 bench sphere.cot solid.chy --error 0.5,8 --threads 1,2 "${small[@]}" --json chosen.json
[[ $(grep -cE '^    "(sphere.cot|solid.chy):(0.5|8)px@64x48/conic/[a-z0-9]+/[12]": \{' chosen.json) -eq 8 ]] || fail "not 8 lines"
[[ $(grep '"rgba": "' chosen.json | sort -u | wc -l) -eq 3 && $(grep -c '"identical": true' chosen.json) -eq 8 ]] ||
  fail "not three pictures: two errors of the sphere, and a solid that is the same in both"
run 0 render sphere.cot -o sphere.pfm --method conic --size 64x48 --error 8 --json render.json
[[ $(grep -cF "$(grep -o '"rgba": "[0-9a-f]*"' render.json)" chosen.json) -eq 2 ]] || fail "bench chooses otherwise than render"
# A frame from every side, and one that is the same again
run 0 bench solid.chy --turntable 5 --threads 1 --size 64x48 --json turned.json
grep -q '"frames": 5,' turned.json || fail "not a frame a view"
run 0 bench solid.chy --repeat 1 --threads 1 --size 64x48 --json still.json
[[ $(grep '"rgba": "' turned.json) == "$(grep '"rgba": "' still.json)" ]] || fail "the turntable does not begin where it stands"

# More threads than there are: the first line of a scene has their schedules, of the tasks that they would have
run 0 bench --scenes sphere-30k --threads 1,2 --simulate-threads 2,40 "${small[@]}" --json simulated.json
has '^| 40 | frame |'
[[ $(grep -c '"schedules"' simulated.json) -eq 1 && $(grep -c '"identical": true' simulated.json) -eq 2 ]] ||
  fail "not one list of schedules"
[[ $(grep -A4 '"name": "project"' simulated.json | grep -c '"tasks": 15,') -eq 2 ]] || fail "not 15 chunks of 2048"
run 0 bench --command "render sphere.ply -o whole.pfm --size 64x48 -q" --repeat 2 --simulate-threads 4,40
has '^| 40 | frame |'
has '^| | tile | [0-9]'
run_as_typed 0 render sphere.ply -o plain.pfm --size 64x48
cmp whole.pfm plain.pfm || fail "a command that is simulated does something else"
run 3 bench --command "render none.ply -o whole.pfm" --simulate-threads 4
run 2 bench --scenes sphere-2k --simulate-threads 1
run 2 bench --scenes sphere-2k --simulate-threads 4 --turntable 5

# Comparing with an earlier run
run 0 bench --scenes sphere-2k,plane-500 --isa scalar --threads 1 "${small[@]}" --compare old.json --json new.json
has '^times as fast as old.json'
has '^1 line is not in it'
[[ $(grep -c '"speedup": {' new.json) -eq 1 ]] || fail "not one speedup"
# The same run is as fast; one whose quartiles lie apart is not
sed -E 's/("ms_quartiles": \[)[^]]*/\10, 1e9/' old.json > wide.json
run 0 bench --scenes sphere-2k --isa scalar --threads 1 "${small[@]}" --compare wide.json
has 'as fast, within the noise$'
sed -E 's/("ms_quartiles": \[)[^]]*/\11e-9, 1e-9/' old.json > apart.json
run 0 bench --scenes sphere-2k --isa scalar --threads 1 "${small[@]}" --compare apart.json
grep -q 'within the noise' out && fail "a millionth of the time is as fast"
# Half the old time is half the speed, and no failure
sed -E '/"ms": \{/,/\}/s/("frame": )[0-9.e+-]+/\10.000001/' old.json > fast.json
run 0 bench --scenes sphere-2k --isa scalar --threads 1 "${small[@]}" --compare fast.json --json -
has '"frame": [0-9.]*e-0'

# The curve's and the machine's tables
run 0 bench --curve --quick --repeat 1 --threads 1 --size 64x64
has '^cost curve'
has '^sphere-100k@512x512/conic/'
run 0 bench --floor --scenes sphere-2k --threads 1 "${small[@]}" --json floor.json
has '^1 thread: reads [0-9.]*, writes [0-9.]*, copies [0-9.]*, moves [0-9.]* GB/s'
has '^| accumulate | '
grep -q '"floor_ms": {' floor.json || fail "no floor in the statistics"
run 0 bench --machine --threads 1 --json -
grep -q '"operations_per_s": [0-9]' out || fail "no rate of the machine"
lines 0 out
run 0 bench --scenes plane-100 --threads 1 "${small[@]}" --quiet
has '^plane-100@64x48/' # the table is the result
[[ ! -s err ]] || fail "--quiet says more than its result: $(< err)"
if command -v python3 > /dev/null; then
  for file in old.json new.json floor.json; do
    python3 -m json.tool < $file > /dev/null || fail "$file is not JSON"
  done
fi

# The kernels alone
run 0 bench --kernels --quick
for family in project visibility 'triangles draw' texture 'surface plane' cover; do
  grep -qE "^$family .* scalar .* 1\.00 x$" out || fail "bench --kernels: no $family"
done

# Refusals
refused() { # EXIT_CODE PATTERN ARGUMENTS …
  run "$1" bench "${@:3}"
  [[ $(wc -l < err) -eq 1 ]] || fail "bench ${*:3}: not one line: $(cat err)"
  grep -qe "$2" err || fail "bench ${*:3}: no \"$2\" in: $(cat err)"
}
refused 2 'did you mean sphere?' --scenes spere-2k
refused 2 'how many splats' --scenes sphere-many
refused 2 'how many splats' --scenes sphere-0
refused 2 'it takes LIST' --scenes ''
refused 2 'no list' --scenes sphere-2k,
refused 2 'did you mean affine?' --methods afine
refused 2 'unknown instruction set' --isa mmx
refused 2 'threads' --threads many
refused 2 'no error in pixels' sphere.cot --error -1
refused 2 'no effect with --turntable' --turntable 3 --repeat 3
refused 2 'of Gaussians' --scenes gaussians-100 --turntable 3
refused 2 'scenes of its own' --curve --scenes sphere-2k
refused 2 'nothing else' --kernels --machine
refused 2 'needs an input' --camera camera.json
refused 3 'absent.ply' absent.ply
refused 3 'absent.json' --scenes sphere-2k --compare absent.json
echo '{"splats_in": 3}' > other.json
refused 3 'no "lines"' --scenes sphere-2k --compare other.json
echo '{"lines": {"sphere-2k' > cut.json
refused 3 'cut.json' --scenes sphere-2k --compare cut.json
case $(uname -m) in
  x86_64) refused 4 'neon' --isa neon ;;
  *) refused 4 'avx2' --isa avx2 ;;
esac

[[ $failures -eq 0 ]]
