#!/usr/bin/env bash
# What conic draws in the profiles of gsplat, beside what gsplat's own code for torch draws of real scenes: within 1e-5,
# but where the decisions of a pixel are nearer than roundings. And its derivatives, beside those of torch's automatic
# differentiation of that code, in double: within 1e-9.
set -uo pipefail

source "$1/tests/support/program.bash"
source "$1/tests/support/torch.bash"
data=$1/../shared/data/gaussians

if [[ -z $python || ${#folders[@]} -eq 0 || ! -e $data/biker.spz ]]; then
  echo "skipped: torch (Debian: python3-torch), gsplat (pip download --no-deps gsplat, unpacked, in CONIC_GSPLAT) or" \
    "$data/biker.spz is not there"
  exit 77
fi
export PYTHONDONTWRITEBYTECODE=1
for folder in "${folders[@]}"; do
  for what in pictures gradients; do
    "$python" "$1/tests/gaussians/torch_$what.py" "$conic" "$folder" "$data" > table || fail "$folder: $(cat table)"
    cat table
  done
done
[[ $failures -eq 0 ]]
