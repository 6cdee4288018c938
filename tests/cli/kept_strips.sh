#!/usr/bin/env bash
# A picture in strips that is ended at some moment is gone on with to the bits of one that never was; what is kept and
# wrong is drawn again, and what is kept of another picture is refused.
set -uo pipefail

source "$1/tests/support/program.bash"

"$conic" make knot -n 2000 -o knot.ply
picture=(render knot.ply --plain --size 300x500 --threads 1 --memory 2 --compression none)
kept=("${picture[@]}" --resume here/a.exr -o here/a.exr)
facts() { # JSON FILE: hashes, and what is counted of the picture, whoever drew its strips
  sed -n '/"hash": {/,/}/p' "$1"
  grep -E '"(splats_[a-z]*|fragments|pixels_covered)"' "$1"
}
mkdir here
run_as_typed 0 "${picture[@]}" -o whole.exr --json whole.json

# Goes on, with so many rows that are finished. go_on WHAT ROWS ARGUMENTS …
go_on() {
  run_as_typed 0 "${kept[@]}" "${@:3}"
  cmp whole.exr here/a.exr || fail "$1: what is gone on with is another picture"
  [[ $(ls -A here) == a.exr ]] || fail "$1: beside a whole picture lies $(ls -A here)"
  grep -q "^conic: $2 of 500 rows were finished" err || fail "$1: not $2 rows were finished: $(cat err)"
}
as_stopped() { # FOLDER
  rm -rf here && cp -r "$1" here
}

# A disk that is full leaves what is finished; of that a run without hashes knows none.
for name in plain hashed; do
  [[ $name == plain ]] && report=() || report=(--json killed.json)
  (ulimit -f 2100 && run_as_typed 4 "${kept[@]}" --resumable "${report[@]}"; exit $failures) || fail "$name: no full disk"
  [[ $(ls -A here) == $'a.exr.part\na.exr.strips' ]] || fail "a full disk leaves $(ls -A here)"
  mv here $name && mkdir here
done
as_stopped hashed
go_on "with hashes" 320 --json again.json
[[ $(facts whole.json) == "$(facts again.json)" ]] || fail "other facts: $(diff <(facts whole.json) <(facts again.json))"
as_stopped plain
run_as_typed 0 "${kept[@]}" --json again.json
[[ $(facts whole.json) == "$(facts again.json)" ]] || fail "hashes of rows that were kept without are other ones"

# Ended at any other moment: before a record was whole, or before what it tells of had come to the disk
as_stopped plain
truncate -s 13507 here/a.exr.strips
go_on "a torn record" 128
as_stopped plain
truncate -s 1000000 here/a.exr.part
go_on "rows that are not on the disk" 128
as_stopped plain
truncate -s 200 here/a.exr.strips
run_as_typed 0 "${kept[@]}"
cmp whole.exr here/a.exr || fail "gone on with from nothing is another picture"
as_stopped plain
rm here/a.exr.part
run_as_typed 0 "${kept[@]}" --threads 2
cmp whole.exr here/a.exr || fail "without its rows it is another picture"

# What is wrong is drawn again, and else nothing
as_stopped plain
printf x | dd of=here/a.exr.part bs=1 seek=700000 conv=notrunc 2> dd.err
(ulimit -f 2100 && run_as_typed 4 "${kept[@]}")
printf x | dd of=here/a.exr.part bs=1 seek=1300000 conv=notrunc 2> dd.err
head -c 2000000 /dev/zero >> here/a.exr.part
go_on "rows that are wrong" 256

# Of another picture nothing is taken, and one that is held keeps none.
as_stopped plain
run_as_typed 3 "${kept[@]}" --zoom 2
grep -q 'here/a.exr.strips: cannot go on: .*options' err || fail "told is not that it is another picture: $(cat err)"
cp knot.ply first.ply
printf x | dd of=knot.ply bs=1 seek=2000 conv=notrunc 2> dd.err
run_as_typed 3 "${kept[@]}"
mv first.ply knot.ply
run_as_typed 3 "${kept[@]/a.exr/b.exr}"
grep -q 'here/b.exr.strips: cannot read' err || fail "told is not that there is nothing: $(cat err)"
diff -r plain here || fail "what is kept does not stay with another picture"
run_as_typed 2 "${kept[@]/here*/here/a.png}"
run_as_typed 2 "${kept[@]}" --memory 1000
run_as_typed 2 "${kept[@]}" -o elsewhere.exr
run_as_typed 2 render knot.ply --plain --size 300x500 --memory 1000 --resumable -o here/a.exr
grep -q 'in strips' err || fail "told is not that only strips are kept: $(cat err)"
run_as_typed 0 "${kept[@]}"

# --memory that bounds nothing is refused.
small=(render knot.ply --size 30x50 --memory 1000)
run_as_typed 0 "${small[@]}" -o small.exr
for words in '-o small.png' '-o small.exr --shadow' '-o small.exr --accumulate 2' '-o small.exr -o small.pfm' \
  '-o small.png --as hybrid' '-o small.exr --show overdraw:small.png'; do
  # shellcheck disable=SC2086
  run_as_typed 2 "${small[@]}" $words
  grep -q -- '--memory has no effect' err || fail "$words: $(cat err)"
done

# A signal leaves what is finished; each of several pictures keeps its own strips.
"$conic" "${picture[@]}" --samples 16 --resumable -o here/b.exr > out 2> err &
for ((i = 0; i < 1000; i++)); do
  [[ ! -s here/b.exr.strips ]] || break
  sleep 0.01
done
kill -TERM $!
wait $!
got=$?
[[ $got -eq 143 && -e here/b.exr.part ]] || fail "stopped: exit code $got, and $(ls -A here)"
rm here/*
run_as_typed 0 "${picture[@]}" --turntable 2 -o whole_%d.exr
turn=("${picture[@]}" --turntable 2 --resume here/t_%d.exr --resumable -o here/t_%d.exr)
(ulimit -f 2100 && run_as_typed 4 "${turn[@]}")
[[ -s here/t_1.exr.strips ]] || fail "the frame that was stopped keeps no strips: $(ls -A here)"
run_as_typed 0 "${turn[@]}"
grep -q '^conic: 320 of 500 rows were finished' err || fail "a frame does not go on: $(cat err)"
for i in 1 2; do
  cmp whole_$i.exr here/t_$i.exr || fail "frame $i is another picture"
done
[[ $(ls -A here) == $'t_%d.exr.frames\nt_1.exr\nt_2.exr' ]] || fail "frames leave $(ls -A here)"
exit $((failures > 0))
