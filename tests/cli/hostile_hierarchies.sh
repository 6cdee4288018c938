#!/usr/bin/env bash
# Some of the ways in which a web server answers badly, to COPC, EPT and Potree 2; scripts/hostile-hierarchies tries all.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

if ! "$conic" --version | grep '^In this build:' | grep zstd | grep -q CURL || ! command -v python3 > /dev/null; then
  echo "skipped: this build is without zstd or libcurl, or there is no python3" >&2
  exit 77
fi
python3 "$1/tests/cli/hostile_hierarchies.py" "$conic" "$1/../shared/data/clouds" 61 > table || fail "$(grep -v '^    ' table)"
grep cases table
[[ $failures -eq 0 ]]
