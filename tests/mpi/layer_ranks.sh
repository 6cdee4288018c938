#!/usr/bin/env bash
# conic-mpi layer: the file that several ranks build is the one that one process builds, byte for byte, however the
# inputs are shared; and what goes wrong on one rank leaves none.
set -uo pipefail

source "$1/tests/support/program.bash"
source "$1/tests/support/ranks.bash"

# Tiles of three kinds, of which some have no colours and some no normals; one large cloud; raw points with values
mkdir tiles bad none
"$conic" make knot -n 3000 -o tiles/a.ply
"$conic" make sphere -n 2000 -o tiles/c.ply
awk 'BEGIN { for (i = 0; i < 1500; i++) print i % 40 / 20, int(i / 40) / 20, (i % 7) / 100 }' > tiles/b.xyz
echo "no points" > tiles/readme.txt
"$conic" make knot -n 70000 -o large.ply
"$conic" cut large.ply -o raw.las --box -9,-9,-9,9,9,9 --quiet
cp tiles/a.ply bad/a.ply
head -c 60 tiles/c.ply > bad/b.ply

# same NAME RANKS ARGUMENTS …: as one process has built NAME.lpc
same() {
  err=err-$1-$2 ranks "$2" 0 layer "${@:3}" -o "$1-$2.lpc" --json "$1-$2.json" --threads 1 || return 1
  cmp "$1.lpc" "$1-$2.lpc" && return
  fail "$2 ranks build another file of $1"
  return 1
}

run_as_typed 0 layer tiles -o tiles.lpc
run_as_typed 0 layer tiles/a.ply tiles/b.xyz tiles/c.ply -o listed.lpc
cmp tiles.lpc listed.lpc || fail "a folder is not its files in the order of their names"
run_as_typed 0 layer tiles --payload full -o full.lpc
run_as_typed 0 layer large.ply --memory 16 -o large.lpc
raw=(--memory 16 --keep intensity --color-by height)
run_as_typed 0 layer raw.las "${raw[@]}" -o raw.lpc
few=(--memory 16 --where 'x > 0') # so few that their normals are estimated from all of them
run_as_typed 0 layer raw.las "${few[@]}" -o few.lpc

jobs=
for n in 1 3 7; do
  same tiles "$n" tiles & jobs+=" $!"
done
same full 3 tiles --payload full & jobs+=" $!"
same large 2 large.ply --memory 16 & jobs+=" $!"
same large 3 large.ply --memory 16 --trace trace.json & jobs+=" $!"
same raw 2 raw.las "${raw[@]}" & jobs+=" $!"
same few 2 raw.las "${few[@]}" & jobs+=" $!"
told_once err1 3 3 bad/b.ply layer bad -o failed.lpc & jobs+=" $!"
told_once err2 2 3 'it is a directory' layer none -o failed.lpc & jobs+=" $!"
told_once err3 2 3 'name it first' layer tiles/b.xyz tiles/a.ply -o failed.lpc & jobs+=" $!"
told_once err4 3 3 nothing.ply layer tiles nothing.ply -o failed.lpc & jobs+=" $!"
for job in $jobs; do
  wait "$job" || failures=$((failures + 1))
done
[[ ! -e failed.lpc && -z $(ls -A | grep '^\.') ]] || fail "what failed left a file: $(ls -A)"

# Each rank had a part, also of one file, and the trace is a job that can be modelled.
for report in tiles-3 large-2 raw-2; do
  ! grep -q '"units": 0' "$report.json" || fail "a rank has had nothing of $report: $(cat "$report.json")"
done
grep -q '"units": 0' few-2.json || fail "what is estimated from all points has been parted"
grep -q '"shares": "points"' large-3.json || fail "the report does not say what was shared"
for stage in exchange grow crown write; do
  [[ $(grep -c "\"name\": \"$stage .*\"stage\"" trace.json) -eq 3 ]] || fail "the trace lacks $stage"
done
model 4 trace.json --ranks 1,3,64

# What goes on is shared, too.
cp tiles.lpc more.lpc
cp tiles.lpc alone.lpc
run_as_typed 0 layer tiles/c.ply --append -o alone.lpc
ranks 2 0 layer tiles/c.ply --append -o more.lpc
cmp alone.lpc more.lpc || fail "two ranks append to another file"

exit $((failures > 0))
