#!/usr/bin/env bash
# Files of version 3 as a stranger reads them, who has their page alone: every sample once, with all that it came with.
set -uo pipefail

source "$1/tests/support/python.bash"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$python" "$1/tests/cli/layers_format.py" "$2" "$work"
