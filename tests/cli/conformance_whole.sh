#!/usr/bin/env bash
# The whole suite: no larger than 30 MB, and what conic draws of it is right, case by case.
set -uo pipefail

source "$1/tests/support/program.bash"

run 0 conformance suite
bytes=$(find suite -type f -printf '%s\n' | awk '{ sum += $1 } END { print sum }')
[[ $bytes -lt 30000000 ]] || fail "the suite has $bytes bytes"
CONIC=$conic "$1/examples/conformance/run-conic" suite pictures || fail "run-conic"
run 0 judge --suite suite --pictures pictures
cat out
grep -q "^right: $(wc -l < suite/cases.tsv) of " out || fail "not all cases are judged"

[[ $failures -eq 0 ]]
