#!/usr/bin/env bash
# Other libraries' files, and their values: laspy, pye57, plyfile and trimesh, as far as they are installed.
set -uo pipefail

source "$1/tests/support/python.bash"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$python" "$1/tests/formats/others.py" "$2" "$work"
