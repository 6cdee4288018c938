#!/usr/bin/env bash
# A real scan, all planes: whatever the number of threads and the size of the tiles, the same picture, by conic's own
# comparison, by its hashes and, where it is there, by OpenImageIO's.
set -euo pipefail

scan=$1/../shared/data/lion.ply
conic=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

if [[ ! -e $scan ]]; then
  echo "skipped: $scan is not there"
  exit 77
fi
if ! "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  echo "skipped: this build has no format for all planes"
  exit 77
fi

draw() { # NAME, options …
  "$conic" render --plain "$scan" --up z --size 400x300 --aov all -o "$1.exr" --json "$1.json" "${@:2}"
  grep -A8 '"hash"' "$1.json" > "$1.hash"
}
draw first --threads 1 --tile 64
draw other --threads 1 --tile 64 --azimuth 31
if cmp -s first.hash other.hash || "$conic" diff first.exr other.exr > diff.out; then
  echo "the comparison sees no difference where one is"
  exit 1
fi
for way in '1 16' '2 64' '7 16'; do
  draw second --threads "${way% *}" --tile "${way#* }"
  cmp first.hash second.hash
  "$conic" diff first.exr second.exr > diff.out || { cat diff.out; exit 1; }
  if command -v idiff > /dev/null; then
    idiff -q -a first.exr second.exr
  fi
done
command -v idiff > /dev/null || echo "no idiff here: the pictures were not compared by it"
