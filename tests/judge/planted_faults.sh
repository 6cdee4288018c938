#!/usr/bin/env bash
# conic judge on a plain numpy renderer with faults that many make: each is named, or its place is told, and no fault
# gets a wrong name; some show in the suite. scripts/judge-campaign BUILD faults plants all of them in more scenes.
set -uo pipefail

if ! python3 -c 'import numpy' 2> /dev/null; then
  echo "skipped: python3-numpy is not installed"
  exit 77
fi
python3 "$1/tests/judge/planted_faults.py" "$1" "$2" 1 alpha-squared-weight no-half sh-direction exp2 cross-half \
  negative-colours black-tile-16 last-row-of-tiles lower-half every-third every-fifth-column \
  weight-after last-batch lists-1-sigma lists-2-sigma focal-exchanged background-twice background-forgotten \
  background-right scale-swapped jacobian-sign half-depth-key focal-1.02 nan checkers bgr shift-1px \
  alpha-1 right || exit 1
# And of faults that small pictures do not show each makes a case of the suite wrong.
python3 "$1/tests/judge/planted_faults.py" "$1" "$2" suite clamped,cover,tied over-16-tiles-dropped \
  tiles-from-100-dropped clamped-about-middle batches-dropped last-row-of-tiles right
