#!/usr/bin/env bash
# A run that is stopped leaves nothing behind and says so by its exit code; and the progress bar, on terminals that have
# a cursor only.
set -uo pipefail

source "$1/tests/support/program.bash"
set -m # else what runs in the background ignores Ctrl-C
mkdir outputs

# Starts a run that takes long, waits until it writes (only then are signals caught), and sends it each signal in turn.
stop() { # EXIT_CODE, SIGNALS …
  local wanted=$1 got name
  shift
  "$conic" make sphere -n 2G -o outputs/a.ply > out 2> err &
  for ((i = 0; i < 600; i++)); do
    [[ -z $(ls -A outputs) ]] || break
    sleep 0.1
  done
  for name in "$@"; do
    kill "-$name" $! 2> /dev/null
  done
  wait $!
  got=$?
  [[ $got -eq $wanted ]] || fail "a run that is stopped by $*: exit code $got instead of $wanted"
  [[ $(wc -l < err) -eq 1 ]] || fail "a run that is stopped by $*: not one line: $(cat err)"
  [[ -z $(ls -A outputs) ]] || fail "a run that is stopped by $* leaves $(ls -A outputs)"
}
stop 143 TERM
stop 130 INT
stop 129 HUP
stop 152 XCPU
# Signals that come at once, as from a terminal or from timeout, are one
stop 143 TERM TERM
stop 130 INT INT

# What waits for a pipe is woken
mkfifo pipe
for input in pipe -; do
  "$conic" render $input -o outputs/a.pfm > out 2> err <> pipe &
  process=$!
  exec 9<> pipe
  sleep 0.5
  kill -INT $process
  wait $process
  got=$?
  [[ $got -eq 130 ]] || fail "a run that waits for a pipe: exit code $got"
  exec 9>&-
done

# A run that does not listen, as where all splats lie in one tile, is ended all the same, by itself or by a later signal
yes '1 1 1' | head -n 2000000 > slow.xyz
for signals in INT "INT INT"; do
  "$conic" render slow.xyz --up y -o outputs/a.png > out 2> err &
  process=$!
  sleep 2
  for name in $signals; do
    kill -"$name" $process 2> /dev/null
    sleep 0.3
  done
  wait $process
  got=$?
  [[ $got -eq 130 ]] || fail "a run that does not listen to $signals: exit code $got"
  [[ $(wc -l < err) -eq 1 ]] || fail "a run that does not listen to $signals: not one line: $(cat err)"
  [[ -z $(ls -A outputs) ]] || fail "a run that does not listen to $signals leaves $(ls -A outputs)"
done
set +m

# What has no reader is no longer written
"$conic" make sphere -n 2M -o - 2> err | head -c 1 > /dev/null
got=${PIPESTATUS[0]}
[[ $got -eq 141 ]] || fail "a run whose reader goes away: exit code $got"

# The progress bar of a turntable names the frame
"$conic" make sphere -n 2000 -o a.ply
if [[ -n $(type -P script) ]] && script -qec true /dev/null > /dev/null 2>&1 < /dev/null; then
  turn="'$conic' render --plain a.ply -o turned.pfm --turntable 20 --size 256x192 --samples 8 --threads 1"
  TERM=xterm script -qec "$turn" /dev/null > out 2> err < /dev/null
  grep -q 'frame [0-9]*/20' out || fail "no frame in the progress bar: $(head -c 300 out)"
  for kind in TERM=dumb TERM=; do
    env $kind script -qec "$turn" /dev/null > out 2> err < /dev/null
    [[ ! -s out ]] || fail "with $kind there is a progress bar: $(head -c 300 out)"
  done
else
  echo "skipped: there is no script(1) to make a terminal"
fi

[[ $failures -eq 0 ]]
