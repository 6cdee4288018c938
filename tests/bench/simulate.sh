#!/usr/bin/env bash
# scripts/simulate: traces, what the model makes of them where that can be told without it, and what the script writes.
set -uo pipefail

source "$1/tests/support/program.bash"
script=$1/scripts/simulate
if ! python3 -c 'import sys; assert sys.version_info >= (3, 9)' 2> /dev/null; then
  echo "skipped: no Python of 3.9 or later"
  exit 77
fi
PYTHONDONTWRITEBYTECODE=1 python3 "$1/tests/bench/simulate.py" "$script" || fail "the model is wrong"

# simulate EXIT_CODE ARGUMENTS …
simulate() {
  local wanted=$1 got
  shift
  python3 "$script" "$@" > out 2> err < /dev/null
  got=$?
  [[ $got -eq $wanted ]] || fail "simulate $*: exit code $got instead of $wanted: $(head -c 300 out err)"
}

# Two ranks open for a second; then each draws two units of a second, the last one of rank 1 half as long.
cat > trace.json <<'END'
{"traceEvents": [
  {"name": "scene 0", "cat": "open", "ts": 1e6, "dur": 1e6, "pid": 0},
  {"name": "scene 0", "cat": "open", "ts": 1e6, "dur": 1e6, "pid": 1},
  {"name": "frame 0", "cat": "unit", "ts": 2e6, "dur": 1e6, "pid": 0},
  {"name": "frame 1", "cat": "unit", "ts": 2e6, "dur": 1e6, "pid": 1},
  {"name": "frame 2", "cat": "unit", "ts": 3e6, "dur": 1e6, "pid": 0},
  {"name": "frame 3", "cat": "unit", "ts": 3e6, "dur": 5e5, "pid": 1}]}
END
simulate 0 trace.json --ranks 1,4 --latency 0 --json model.json --svg model.svg
cat > wanted <<'END'
4 units on 2 ranks took 3.000 s; 3.000 s by the model

| ranks | s | efficiency | rank hours | most is lost by | s |
|---|---|---|---|---|---|
| 1 | 4.500 | 1.00 | 0.0013 | open | 1.000 |
| 4 | 2.000 | 0.56 | 0.0022 | open | 1.000 |
END
cmp wanted out || fail "the table is another: $(cat out)"
for line in '  "units": 4,' '    "ranks": 2,' '  "estimates": [' '      "limit": "open",' '        "merge": 0,'; do
  grep -qxF -- "$line" model.json || fail "the JSON lacks $line"
done
# Six boxes of 700/3.24 pixels a second (the second unit of rank 1 is half as long), and the legend's six keys.
[[ $(grep -c '<rect x=' model.svg) -eq 6 && $(grep -c '<polygon' model.svg) -eq 6 ]] || fail "not six events are drawn"
[[ $(grep -c 'width="283.3" .*#0072b2' model.svg) -eq 3 && $(grep -c 'width="141.7" .*#0072b2' model.svg) -eq 1 ]] ||
  fail "units are not as long as they took: $(grep '<rect x=' model.svg)"
simulate 0 trace.json --quiet --json - --ranks 1
head -n 2 out | cmp - <(printf '{\n  "units": 4,\n') || fail "the JSON is not on standard output"
simulate 0 trace.json --json - --ranks 1 --times 3
grep -q '"times": 3,' out && ! grep -q '^|' out || fail "the table is in the JSON"

# What is wrong is told in a line that names the file or the option.
for wrong in '' '[]' '{}' '{"traceEvents": []}' '{"traceEvents": [{"cat": "unit", "dur": 1}' '{"traceEvents": [3]}'; do
  printf '%s' "$wrong" > wrong.json
  simulate 3 wrong.json
  grep -q '^simulate: error: wrong.json: ' err || fail "it is not told: $(cat err)"
done
simulate 3 nothing.json
simulate 3 trace.json --processor
grep -q 'has no processor time' err || fail "a trace without processor time is taken"
for wrong in '--ranks 0' '--ranks 1,x' '--ranks 65537' '--latency -1' '--bandwidth 0' '--times 1.5' '--nothing 1'; do
  simulate 2 trace.json $wrong
done
simulate 2 trace.json --svg one --json one
simulate 2
simulate 4 trace.json --json nowhere/model.json
[[ -z $(ls -A | grep '^\.') ]] || fail "something is left: $(ls -A)"

# The command that it was says where it is.
for words in 'simulate trace.json' 'simulate --help' 'help simulate'; do
  run_as_typed 2 $words
  [[ $(wc -l < err) -eq 1 ]] && grep -q 'scripts/simulate' err || fail "conic $words does not name the script: $(cat err)"
done
exit $((failures > 0))
