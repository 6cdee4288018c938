#!/usr/bin/env bash
# conic's package for Python, with the build's library.
set -euo pipefail
source "$(dirname "$0")/../support/python.bash"
cd "$1/tests/python"
with_conic "$python" -W error::ResourceWarning -m unittest -q test_arrays test_commands test_judge test_runs test_shots
