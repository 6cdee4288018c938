#!/usr/bin/env bash
# What editors know of the options is what the program's table says: python/make-options makes it again, the same.
set -euo pipefail
source "$(dirname "$0")/../support/python.bash"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$python" "$1/python/make-options" --program "$2" --output "$work/_commands.pyi"
if ! diff "$1/python/conic/_commands.pyi" "$work/_commands.pyi"; then
  echo "python/conic/_commands.pyi is not that of the program's options: python/make-options makes it"
  exit 1
fi
