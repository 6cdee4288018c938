#!/usr/bin/env bash
# conic judge --gradients on a renderer in NumPy: its floats are right, and each mistake planted in it is named.
set -uo pipefail

if ! python3 -c 'import numpy' 2> /dev/null; then
  echo "skipped: python3-numpy is not installed"
  exit 77
fi
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
script=$(realpath "$1/tests/judge/planted_gradients.py") program=$(realpath "$2")
cd "$folder" && python3 "$script" "$program"
