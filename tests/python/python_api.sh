#!/usr/bin/env bash
# conic's package for Python, with the build's library.
set -euo pipefail
source "$(dirname "$0")/../support/python.bash"
cd "$1/tests/python"
modules=(test_arrays test_commands test_judge test_runs test_shots)
if [[ $sanitizer ]]; then # it takes ten times as long, and processes begin ten times as late
  export CONIC_CALLS=15
else
  modules+=(test_processes)
fi
with_conic "$python" -W error::ResourceWarning -m unittest -q "${modules[@]}"
