#!/usr/bin/env bash
# Runs that end at random moments: `python3 tests/cli/kills.py CONIC COUNT` is for more of them.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

if ! command -v python3 > /dev/null || ! "$conic" --version | grep '^In this build:' | grep zstd | grep OpenEXR | grep -q libpng; then
  echo "skipped: there is no python3, or this build is without zstd, OpenEXR or libpng" >&2
  exit 77
fi
python3 "$1/tests/cli/kills.py" "$conic" 54 > table || fail "$(grep -v '^    ' table)"
tail -n 1 table
[[ $failures -eq 0 ]]
