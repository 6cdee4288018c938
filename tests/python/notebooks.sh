#!/usr/bin/env bash
# The notebooks run from the first cell to the last, and hold no outputs.
set -euo pipefail
source "$(dirname "$0")/../support/python.bash"
with_conic "$python" "$1/tests/python/notebooks.py" "$1"/python/notebooks/*.ipynb
