#!/usr/bin/env bash
# Hundreds of ways in which a web server answers badly: what is late is told, what is wrong is refused, nothing is hidden.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

if ! "$conic" --version | grep '^In this build:' | grep zstd | grep -q CURL || ! command -v python3 > /dev/null; then
  echo "skipped: this build is without zstd or libcurl, or there is no python3" >&2
  exit 77
fi
python3 "$1/tests/cli/hostile_server.py" "$conic" > table || fail "$(grep -v '^    ' table)"
tail -n 1 table
[[ $failures -eq 0 ]]
