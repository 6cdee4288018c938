#!/usr/bin/env bash
# conic layer, and conic info of a .lpc: what the command line promises.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

if ! "$conic" --version | grep '^In this build:' | grep -q zstd; then
  run 0 make sphere -n 100 -o sphere.ply
  run 4 layer sphere.ply -o sphere.lpc
  grep -q 'need zstd' err || fail "a build without zstd does not say so: $(cat err)"
  echo "skipped: this build has no zstd"
  [[ $failures -eq 0 ]] && exit 77
  exit 1
fi

value() { # KEY FILE: the first value of a key in a JSON file
  sed -nE "s/^ *\"$1\": \"?([^\",]*)\"?,?$/\1/p" "$2" | head -n 1
}

is_sound() { # FILE
  run 0 info "$1" --check --json info.json
  [[ $(value kind info.json) == lpc && $(value sound info.json) == true ]] || fail "$1 is not sound"
}

run 0 make gyroid -n 60k -o gyroid.ply
run 0 layer gyroid.ply -o gyroid.lpc --json layer.json
[[ $(value points_in layer.json) == 60000 && $(value points_out layer.json) == 60000 ]] || fail "counts"
[[ $(value bytes layer.json) == $(stat -c %s gyroid.lpc) ]] || fail "bytes"
is_sound gyroid.lpc
[[ $(value points info.json) == 60000 && $(value clouds info.json) == $(value clouds layer.json) ]] || fail "info: counts"
awk -v p="$(value position info.json)" -v n="$(value normal info.json)" -v i="$(value index info.json)" \
  'BEGIN { exit !(p + n + i <= 28) }' || fail "over 28 bits a sample"
run 0 info gyroid.lpc
grep -q '^bits .* index' out || fail "info says nothing of bits"

# Threads and memory change no byte, and neither do pipes or a set in parts.
run 0 layer gyroid.ply -o other.lpc --threads 1 --memory 64
cmp -s gyroid.lpc other.lpc || fail "threads or memory change the file"
"$conic" layer - -o other.lpc < gyroid.ply || fail "from standard input"
cmp -s gyroid.lpc other.lpc || fail "a pipe changes the file"
run 0 layer gyroid.ply gyroid.ply -o other.lpc --cloud-size 512 --quantum 0.01 --json twice.json
[[ $(value points_out twice.json) == 120000 && $(value quantum twice.json) == 0.01 ]] || fail "two inputs"
is_sound other.lpc

# However few samples there are for the memory, all threads have some to grow: more than a turn of one branch each.
run 0 bench --command "layer gyroid.ply -o other.lpc -q" --repeat 1 --simulate-threads 2
[[ $(awk '/grow groups/ { print $6 }' out) -gt 2 ]] || fail "one thread grows all: $(cat out)"

# Of several inputs, what has no colours is white beside what has; the other way round nobody can know in time.
printf '0 0 0\n1 0 0\n0 1 0\n1 1 0\n' > grey.xyz
printf '5 0 0 255 0 0\n6 0 0 255 0 0\n5 1 0 255 0 0\n6 1 0 255 0 0\n' > red.xyz
run 0 layer red.xyz grey.xyz -o both.lpc
run 0 info both.lpc
grep -q '^samples *8, with colours' out || fail "layer drops colours or samples: $(cat out)"
run 3 layer grey.xyz red.xyz -o never.lpc
grep -q '^conic: error: red.xyz: has colours' err || fail "layer does not name the input that has colours: $(cat err)"

# Every kind of input: text, with raw points and with colours; a mesh; map coordinates.
printf '%s\n' '0 0 0 255 0 0' '1 0 0 0 255 0' '0 1 0 0 0 255' '1 1 0 9 9 9' '2 0 0 9 9 9' '2 1 0 1 1 1' '0 2 0 1 1 1' \
  '1 2 0 1 1 1' '2 2 0 7 7 7' > raw.xyz
run 0 layer raw.xyz -o raw.lpc
is_sound raw.lpc
[[ $(value points info.json) == 9 && $(value colors info.json) == true ]] || fail "raw points"
# What points up is kept, if all that goes in agree.
run 0 layer raw.xyz -o up.lpc --up -x
run 0 layer raw.xyz -o up.lpc --append
run 0 merge up.lpc up.lpc -o ups.lpc
run 0 merge up.lpc raw.lpc -o other.lpc
for name in up ups other; do
  run 0 render $name.lpc -o up.pfm --size 16x16 --json $name.json
done
[[ $(value up_basis up.json) == kind && $(value up_basis ups.json) == kind ]] || fail "what points up is not kept"
grep -A1 '"up"' ups.json | tr -d ' \n' | grep -q '"up":\[-1,0,0\]' || fail "something else points up: $(cat ups.json)"
[[ $(value up_basis other.json) == kind ]] && fail "what points up is of one input only"
# What lies on no surface is dots, as in prepare. They are drawn as the cloud's, and are still there in what is made of
# the file.
awk 'BEGIN { srand(1); for (i = 0; i < 400; i++) print rand(), rand(), rand() }' > dust.xyz
run 0 prepare dust.xyz -o dust.ply
count_dots() { # FILE JSON: the dots in the splats of a file
  run 0 cut "$1" -o cut.ply
  run 0 render cut.ply -o dots.pfm --size 16x16 --json "$2"
  value dots "$2"
}
n_dots=$(count_dots dust.ply dots.json)
[[ $n_dots -gt 300 ]] || fail "prepare finds $n_dots dots"
for payload in plain full; do
  run 0 layer dust.xyz -o dust.lpc --payload $payload
  is_sound dust.lpc
  run 0 layer dust.ply -o ready.lpc --payload $payload
  cmp -s dust.lpc ready.lpc || fail "$payload: prepared points make another file"
  run 0 layer raw.xyz -o both.lpc --payload $payload
  run 0 layer dust.ply -o both.lpc --append
  run 0 merge dust.lpc dust.lpc -o twice.lpc
  [[ $(count_dots dust.lpc dots.json) == "$n_dots" ]] || fail "$payload: dots are not kept"
  [[ $(count_dots both.lpc dots.json) == $((n_dots + 9)) ]] || fail "$payload: dots are not appended"
  [[ $(count_dots twice.lpc dots.json) == $((2 * n_dots)) ]] || fail "$payload: dots are not merged"
done
run 0 make torus -n 5k --far 500000,4000000,100 -o far.ply
run 0 layer far.ply -o far.lpc
is_sound far.lpc
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 4 3\n' > mesh.obj
run 0 layer mesh.obj -o mesh.lpc
is_sound mesh.lpc

# Killed at any moment, the file that was there is still there, and what lies beside it is swept away by the next build.
cp gyroid.lpc kept.lpc
run 0 make gyroid -n 400k -o large.ply
for seconds in 0.05 0.2 0.5; do
  "$conic" layer large.ply -o kept.lpc --memory 64 &
  sleep $seconds
  kill -9 $! 2> /dev/null
  wait $! 2> /dev/null
  cmp -s gyroid.lpc kept.lpc || "$conic" info kept.lpc --check --quiet > /dev/null || fail "kill -9 after $seconds s"
done
# On disks that cannot do without, a temporary file has a name for a moment, at which it can be killed, too.
rm -f .conic-spool-*
touch .kept.999999999-0.lpc .kept.$$-0.lpc .kept.999999998-0.lpc .conic-spool-abc012
touch -d '2 hours ago' .kept.999999999-0.lpc .kept.$$-0.lpc .conic-spool-abc012
run 0 layer raw.xyz -o kept.lpc
[[ ! -e .kept.999999999-0.lpc && ! -e .conic-spool-abc012 ]] || fail "what was left over is not swept away"
[[ -e .kept.$$-0.lpc && -e .kept.999999998-0.lpc ]] || fail "what others write is swept away"
rm .kept.*

# A disk that is full, as good as: a limit on the size of files.
(
  ulimit -f 200
  "$conic" layer large.ply -o full.lpc --memory 64 2> err
)
[[ $? -eq 4 && ! -e full.lpc ]] || fail "a full disk: $(cat err)"
grep -q '^conic: error: full.lpc: ' err || fail "a full disk is not told of: $(cat err)"

# Wrong usage, wrong inputs.
run 2 layer gyroid.ply
run 2 layer -o x.lpc
run 2 layer gyroid.ply -o x.lpc --cloud-size 3
run 2 layer gyroid.ply -o x.lpc --quantum 0
run 2 layer gyroid.ply -o x.lpc --memory 1
run 3 layer missing.ply -o x.lpc
run 3 layer gyroid.lpc -o x.lpc
run 4 layer gyroid.ply -o /nowhere/x.lpc
head -c 1000000 gyroid.ply > cut.ply
run 0 layer cut.ply -o x.lpc
grep -q '^conic: warning: cut.ply: the file ends within vertex' err || fail "a cut file is no warning: $(cat err)"
rm x.lpc
head -c 100000 gyroid.lpc > cut.lpc
run 3 info cut.lpc
grep -q '^conic: error: cut.lpc: .*(at byte ' err || fail "a cut file: $(cat err)"
[[ ! -e x.lpc ]] || fail "a failed run left its output"
[[ -z $(find . -name '.x*' -o -name '.full*') ]] || fail "a failed run left a temporary file"
[[ $failures -eq 0 ]]
