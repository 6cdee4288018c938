#!/usr/bin/env bash
# What gsplat's own code for torch draws of the suite, in floats, is right. CONIC_GSPLAT names folders that hold a gsplat,
# with a colon between; without it, it is the installed one.
set -uo pipefail

source "$1/tests/support/program.bash"

finds() { # PYTHON MODULE: the folder that the module's own lies in; importing torch takes seconds
  "$1" -c 'import importlib.util, os, sys
found = importlib.util.find_spec(sys.argv[1])
print(os.path.dirname(os.path.dirname(found.origin)) if found else "")' "$2" 2> /dev/null
}

python=
for candidate in python3 /usr/bin/python3; do
  [[ -n $(finds $candidate torch) && -n $(finds $candidate numpy) ]] && python=$candidate && break
done
folders=${CONIC_GSPLAT-$(finds "${python:-python3}" gsplat)}
if [[ -z $python || -z $folders ]]; then
  echo "skipped: torch (Debian: python3-torch) or gsplat (pip download --no-deps gsplat, unpacked, in CONIC_GSPLAT) is" \
    "not there"
  exit 77
fi
run 0 conformance suite
IFS=: read -ra folders <<< "$folders"
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
