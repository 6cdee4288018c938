#!/usr/bin/env bash
# COPC, EPT and Potree 2: the same picture from disk and web, whatever the threads and the memory; and what is spoiled.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

if ! "$conic" --version | grep '^In this build:' | grep zstd | grep -q CURL || ! command -v python3 > /dev/null; then
  echo "skipped: this build is without zstd or libcurl, or there is no python3" >&2
  exit 77
fi
python3 "$1/tests/cli/hierarchies.py" "$conic" "$1/../shared/data/clouds" > table || fail "$(cat table)"
tail -n 1 table
[[ $failures -eq 0 ]]
