#!/usr/bin/env bash
# The structs that Python fills and reads are those of the headers, member by member.
set -euo pipefail
source "$(dirname "$0")/../support/python.bash"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$python" "$1/tests/python/layouts.py" "$1" write "$work/layouts.c"
cc -std=c11 -I "$1/include" -I "$1" -o "$work/layouts" "$work/layouts.c"
"$work/layouts" > "$work/layouts.txt"
"$python" "$1/tests/python/layouts.py" "$1" compare "$work/layouts.txt"

# A member that is missing is found.
sed '0,/^conic_camera 0 width .*/s//conic_camera 0 width 0 8/' "$work/layouts.txt" > "$work/other.txt"
if "$python" "$1/tests/python/layouts.py" "$1" compare "$work/other.txt" > /dev/null; then
  echo "another layout is taken for the same"
  exit 1
fi
