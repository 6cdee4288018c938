#!/usr/bin/env bash
# What gsplat's own code for torch draws of the suite, in floats, is right.
set -uo pipefail

source "$1/tests/support/program.bash"
source "$1/tests/support/torch.bash"

if [[ -z $python || ${#folders[@]} -eq 0 ]]; then
  echo "skipped: torch (Debian: python3-torch) or gsplat (pip download --no-deps gsplat, unpacked, in CONIC_GSPLAT) is" \
    "not there"
  exit 77
fi
run 0 conformance suite
for folder in "${folders[@]}"; do
  rm -rf pictures
  "$python" "$1/examples/conformance/run-gsplat.py" suite pictures "$folder" || fail "$folder: the runner ends"
  profiles=$(ls pictures | sed -n 's/^L1-ball-\(.*[0-9a]\)\.npy$/\1/p' | paste -sd ,)
  [[ -e pictures/L1-disc-2dgs-gsplat.npy ]] && profiles+=,2dgs-gsplat
  run 0 judge --suite suite --pictures pictures --profile "$profiles"
  echo "$folder, $profiles:"
  cat out
done
[[ $failures -eq 0 ]]
