#!/usr/bin/env bash
# Ranks that are killed at random moments: `python3 tests/mpi/rank_kills.py CONIC_MPI COUNT` is for more of them.
set -uo pipefail
source "$1/tests/support/program.bash"
source "$1/tests/support/ranks.bash"

if ! command -v python3 > /dev/null || ! "$conic" --version | grep '^In this build:' | grep -q OpenEXR; then
  echo "skipped: there is no python3, or this build is without OpenEXR"
  exit 77
fi
python3 "$1/tests/mpi/rank_kills.py" "$conic_mpi" 3 "${launcher[@]}" > table || fail "$(grep -v '^    ' table)"
tail -n 1 table
[[ $failures -eq 0 ]]
