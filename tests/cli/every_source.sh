#!/usr/bin/env bash
# Of every kind of source: options of work change neither camera nor light nor colours, and what is asked for is drawn and
# written, or refused by its name: every_source.py.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"
if ! "$conic" --version | grep '^In this build:' | grep -q zstd || ! command -v python3 > /dev/null; then
  echo "skipped: this build is without zstd, or there is no python3" >&2
  exit 77
fi
python3 "$1/tests/cli/every_source.py" "$conic" "$1/../shared/data/clouds/simple_with_page.copc.laz"
