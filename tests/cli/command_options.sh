#!/usr/bin/env bash
# No option of the commands beside conic render is without effect in silence: command_options.py. And no message names an
# option that conic help does not show: option_names.py.
set -uo pipefail

source "$1/tests/support/program.bash"
python=$(command -v python3) || {
  echo "skipped: python3 is not installed"
  exit 77
}
mkdir pairs
"$python" "$1/tests/cli/command_options.py" "$conic" "$PWD/pairs" || fail "options without effect"
"$conic" help --format json > table.json
"$python" "$1/tests/cli/option_names.py" "$1" table.json || fail "messages name options that there are not"

exit $((failures > 0))
