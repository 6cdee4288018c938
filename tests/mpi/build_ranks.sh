#!/usr/bin/env bash
# conic-mpi: what several ranks make of points together is the file that one process makes, byte for byte.
set -uo pipefail

source "$1/tests/support/program.bash"
source "$1/tests/support/ranks.bash"

"$conic" make knot -n 3000 --noise 0.3 -o knot.ply
"$conic" make knot -n 40000 -o large.ply
"$conic" make terrain -n 3000 --noise 0.3 --ascii -o terrain.ply
sed '1,/^end_header/d' terrain.ply | cut -d' ' -f1-3 > points.xyz

# same_file RANKS OUT ARGUMENTS …: with -o OUT.
same_file() {
  local n=$1 out=$2
  "$conic" "${@:3}" -o "alone.$out" --threads 1 --json "alone.$out.json" -q || fail "conic ${*:3}"
  err=err.$out ranks "$n" 0 "${@:3}" -o "$out" --threads 1 --json "$out.json" -q --trace "$out.trace"
  cmp "alone.$out" "$out" || fail "$n ranks make another file: ${*:3}"
  [[ $(grep -c '"busy_ms"' "$out.json") -eq $n ]] || fail "the report is not about $n ranks: ${*:3}"
  diff <(facts "alone.$out.json") <(facts "$out.json") || fail "$n ranks count otherwise: ${*:3}"
  [[ $failures -eq 0 ]]
}
facts() { # JSON FILE: what does not depend on time and ranks
  grep -E '"(points_out|evaluations|rms|merged|done|error|mean_neighbours|flat|dots)"' "$1"
}

# What happens to one rank alone, in a folder without the input, is told once, and nobody waits for it.
lost_rank() { # OUT, ARGUMENTS …
  "${launcher[@]}" -n 3 sh -c '[ "${OMPI_COMM_WORLD_RANK:-$PMI_RANK}" != 1 ] || cd elsewhere; exec "$@"' sh \
    "$conic_mpi" "${@:2}" -o "$1" > "err.$1" 2>&1 < /dev/null && fail "one rank has failed, and the job has not: ${*:2}"
  [[ $(grep -c '^conic: error: .*knot.ply' "err.$1") -eq 1 ]] || fail "told is not once: $(head -c 600 "err.$1")"
  [[ ! -e $1 ]] || fail "one rank has failed, and there is a file"
  [[ $failures -eq 0 ]]
}
mkdir elsewhere

cells=(mls project knot.ply --h 0.2)
same_file 4 cells.ply "${cells[@]}" & jobs=$!
same_file 7 memory.ply "${cells[@]}" --memory 14 & jobs+=" $!"
same_file 2 thin.ply mls thin knot.ply & jobs+=" $!"
same_file 2 dense.ply mls densify knot.ply --count 5000 & jobs+=" $!"
same_file 3 baked.ply prepare points.xyz --bake ao --directions 7 & jobs+=" $!"
same_file 3 large.cot octree large.ply & jobs+=" $!"
lost_rank lost1.ply mls project knot.ply & jobs+=" $!"
lost_rank lost2.ply "${cells[@]}" & jobs+=" $!"
told_once err3 2 2 'standard input' mls project - -o a.ply & jobs+=" $!"

for job in $jobs; do
  wait "$job" || failures=$((failures + 1))
done
# What they shared and what each did itself is modelled on more ranks.
for traced in thin.ply baked.ply cells.ply; do
  model 3 "$traced.trace" --ranks 1,64
done
exit $((failures > 0))
