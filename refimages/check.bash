#!/usr/bin/env bash
# One reference image: drawn anew, it has the same bits, and looks the same. check.bash SOURCE_FOLDER CONIC NAME
set -uo pipefail

refimages=$1/refimages
conic=$2
name=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

bash "$refimages/run" "$conic" "$1/../shared/data" "$name" || exit $?
read -ra limits < "$refimages/$name/limits"
failed=0
cmp -s "$refimages/$name/hash" hash || {
  echo "other bits than before:"
  diff "$refimages/$name/hash" hash
  failed=1
}
"$conic" diff "$refimages/$name/ref.png" out.png "${limits[@]}" || failed=1
[[ $failed -eq 0 ]] || echo "scripts/golden $name shows the difference"
exit $failed
