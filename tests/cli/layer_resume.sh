#!/usr/bin/env bash
# conic layer and merge with --resumable and --resume: whatever has ended them, they are gone on with to the same bytes,
# and then nothing is left beside the file.
set -uo pipefail

source "$1/tests/support/program.bash"

small=(--cloud-size 64 --threads 1)
"$conic" make knot -n 24000 -o large.ply
run_as_typed 0 layer large.ply -o whole.lpc "${small[@]}"

n_listed() { # WHAT: parts of that name which out.lpc.branches lists
  cat out.lpc.branches/*.list 2> /dev/null | grep -c "^$1 "
}
# stop_at KIB ARGUMENTS …: where the clouds, which go to one file, are so many, as on a disk that is full
stop_at() {
  (ulimit -f "$1" && exec "$conic" "${@:2}" > out 2> err < /dev/null)
  [[ $? -eq 4 ]] || fail "conic ${*:2}, up to $1 KiB: exit code $?: $(cat err)"
  [[ $(n_listed branch) -gt 0 ]] || fail "conic ${*:2}, up to $1 KiB, keeps nothing"
}
# is_done WHOLE: out.lpc, which nothing lies beside, hidden or not
is_done() {
  cmp "$1" out.lpc || fail "what is gone on with is another file than $1"
  [[ ! -e out.lpc.branches && -z $(ls -A | grep '^\.') ]] || fail "something is left: $(ls -A)"
  rm -f out.lpc
}

# At several moments, and a list whose last line is torn
both=(--resumable --resume out.lpc)
n_before=0
for kib in 60 120 200; do
  stop_at $kib layer large.ply -o out.lpc "${small[@]}" "${both[@]}"
  n=$(n_listed branch)
  [[ $n -gt $n_before ]] || fail "up to $kib KiB there are $n branches, not more than $n_before"
  n_before=$n
  printf 'file 0123\nfile 45' >> out.lpc.branches/0.list
done
run_as_typed 0 layer large.ply -o out.lpc "${small[@]}" --resume out.lpc --json kept.json
grep -q '"samples_finished": [1-9]' kept.json || fail "nothing of what was finished is told: $(grep finished kept.json)"
grep -q '^conic: [0-9]* of 24000 samples were in finished branches' err || fail "how much was finished: $(cat err)"
is_done whole.lpc

# However the options are spelled, and with more memory
stop_at 120 layer large.ply -o out.lpc "${small[@]}" --resumable
run_as_typed 0 layer --memory 512 -k 20 --cutoff 1.5 --cloud-size=64 ./large.ply --resume out.lpc -o out.lpc --json kept.json
grep -q '"samples_finished": [1-9]' kept.json || fail "other words for the same are not gone on with"
is_done whole.lpc

# Killed, whatever it does then
"$conic" layer large.ply -o out.lpc "${small[@]}" "${both[@]}" > out 2> err < /dev/null &
sleep 0.3
kill -9 $! 2> /dev/null
wait $! 2> /dev/null
run_as_typed 0 layer large.ply -o out.lpc "${small[@]}" "${both[@]}"
is_done whole.lpc

# A branch that is not as it was written is made again; another key, or nothing to go on with, is told of.
stop_at 120 layer large.ply -o out.lpc "${small[@]}" --resumable
branch=$(ls out.lpc.branches/*.branch | head -n 1)
printf x | dd of="$branch" bs=1 seek=500 conv=notrunc 2> dd.err
run_as_typed 3 layer large.ply -o out.lpc --cloud-size 65 "${both[@]}"
grep -q '^conic: error: out.lpc.branches/0.list: cannot go on: it was begun with other' err || fail "another key: $(cat err)"
cp large.ply before.ply
printf x | dd of=large.ply bs=1 seek=99999 conv=notrunc 2> dd.err
run_as_typed 3 layer large.ply -o out.lpc "${small[@]}" "${both[@]}"
mv before.ply large.ply
touch -d @1 large.ply # which is small, so that its time is of no matter
run_as_typed 0 layer large.ply -o out.lpc --cloud-size 64 --threads 2 "${both[@]}"
is_done whole.lpc
run_as_typed 3 layer large.ply -o out.lpc "${small[@]}" --resume out.lpc
grep -q '^conic: error: out.lpc.branches/0.list: cannot read: No such file' err || fail "nothing to go on with: $(cat err)"
run_as_typed 0 layer large.ply -o out.lpc "${small[@]}" "${both[@]}" --json begun.json
grep -q '"samples_finished": 0,' begun.json || fail "a run that begins goes on with something"
is_done whole.lpc

# What goes on is kept likewise: its bytes decide the key, too.
run_as_typed 0 merge whole.lpc whole.lpc -o merged.lpc
stop_at 120 merge whole.lpc whole.lpc -o out.lpc "${both[@]}"
run_as_typed 0 merge whole.lpc whole.lpc -o out.lpc "${both[@]}"
is_done merged.lpc
cp whole.lpc more.lpc
"$conic" make sphere -n 9000 -o few.ply
run_as_typed 0 layer few.ply --append -o more.lpc
cp whole.lpc out.lpc
stop_at 140 layer few.ply --append -o out.lpc --resumable
cmp whole.lpc out.lpc || fail "a file that goes on is gone before it is whole"
run_as_typed 0 layer few.ply --append -o out.lpc --resume out.lpc
is_done more.lpc

# What is estimated of inputs is kept: zeros in its place become another file, so it is taken.
mkdir tiles
for i in 1 2 3; do
  "$conic" make knot -n 5000 -o a.ply
  "$conic" cut a.ply -o tiles/$i.las --box -9,-9,-9,9,9,9 --quiet
done
run_as_typed 0 layer tiles -o tiles.lpc --payload full "${small[@]}"
stop_at 200 layer tiles -o out.lpc --payload full "${small[@]}" --resumable
cp -r out.lpc.branches kept
run_as_typed 0 layer tiles -o out.lpc --payload full "${small[@]}" "${both[@]}"
is_done tiles.lpc
for is_listed in 0 1; do
  cp -r kept out.lpc.branches
  before=$(sha256sum < kept/1.axes)
  head -c "$(stat -c %s kept/1.axes)" /dev/zero > out.lpc.branches/1.axes
  after=$(sha256sum < out.lpc.branches/1.axes)
  [[ $is_listed -eq 0 ]] || sed -i "s/${before%% *}/${after%% *}/" out.lpc.branches/0.list
  run_as_typed 0 layer tiles -o out.lpc --payload full "${small[@]}" "${both[@]}"
  [[ $is_listed -eq 0 ]] || ! cmp -s tiles.lpc out.lpc || fail "what was estimated is not taken"
  [[ $is_listed -eq 1 ]] || is_done tiles.lpc
done

# Wrong usage
run 2 layer large.ply -o out.lpc --resume other.lpc
grep -q -- 'give -o other.lpc, too' err || fail "another file: $(cat err)"
run 2 layer - -o out.lpc --resumable
grep -q 'standard input cannot be gone on with' err || fail "standard input: $(cat err)"

exit $((failures > 0))
