#!/usr/bin/env bash
# What conic draws in the profiles of gsplat, beside what gsplat's own code for torch draws of real scenes: within 1e-5,
# but where the decisions of a pixel are nearer than roundings. And its derivatives, beside those of torch's automatic
# differentiation of that code, in double: within 1e-9. CONIC_GSPLAT names folders that hold a gsplat, with a
# colon between; without it, it is the installed one.
set -uo pipefail

source "$1/tests/support/program.bash"
data=$1/../shared/data/gaussians

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
if [[ -z $python || -z $folders || ! -e $data/biker.spz ]]; then
  echo "skipped: torch (Debian: python3-torch), gsplat (pip download --no-deps gsplat, unpacked, in CONIC_GSPLAT) or" \
    "$data/biker.spz is not there"
  exit 77
fi
IFS=: read -ra folders <<< "$folders"
export PYTHONDONTWRITEBYTECODE=1
for folder in "${folders[@]}"; do
  for what in pictures gradients; do
    "$python" "$1/tests/gaussians/torch_$what.py" "$conic" "$folder" "$data" > table || fail "$folder: $(cat table)"
    cat table
  done
done
[[ $failures -eq 0 ]]
