#!/usr/bin/env bash
# The whole suite: no larger than 69 MB, 40 cases of each profile, and what conic draws of it is right, case by case; so
# is what the tests' own renderers draw, which share nothing with conic and fuse, order and approximate by chance.
set -uo pipefail

source "$1/tests/support/program.bash"

run 0 conformance suite
bytes=$(find suite -type f -printf '%s\n' | awk '{ sum += $1 } END { print sum }')
[[ $bytes -lt 69000000 ]] || fail "the suite has $bytes bytes"
cut -f 4 suite/cases.tsv | grep -v surface | sort | uniq -c | awk '$1 < 40 { print; few = 1 } END { exit few }' ||
  fail "profiles with few cases"
CONIC=$conic "$1/examples/conformance/run-conic" suite pictures || fail "run-conic"
run 0 judge --suite suite --pictures pictures
cat out
grep -q "^right: $(wc -l < suite/cases.tsv) of " out || fail "not all cases are judged"

# They know some profiles. They leave no broken records out, and do not draw splats next to the eye.
rm -rf pictures
mkdir pictures
while IFS=$'\t' read -r name scene camera profile background; do
  [[ $name != L7-* ]] || continue # which takes them long
  case $profile in
    exact | inria-2023-aa | mip-2023 | brush-1 | splat-2023 | playcanvas-2 | spark-2 | gs3d-0.4 | 3dgut-2025) continue ;;
    surface) renderer=("$3/tests/plain_splats") ;;
    *) renderer=("$3/tests/plain_renderer" --profile "$profile" --background "$background") ;;
  esac
  "${renderer[0]}" "suite/$scene" "suite/$camera" "${renderer[@]:1}" --floats 7 -o "pictures/$name.npy" ||
    fail "$name is not drawn"
done < suite/cases.tsv
profiles=$(cut -f 4 suite/cases.tsv | sort -u | grep -v '^exact$\|-2023-aa$\|^mip-\|^brush-\|^splat-\|^playcanvas-\|^spark-\|^gs3d-\|^3dgut-' | paste -sd ,)
run 1 judge --suite suite --pictures pictures --profile "$profiles" --level 6
cat out
[[ $(grep -c '^wrong    L5-broken-\|^wrong    L6-steep-' out) -eq $(grep -c '^wrong ' out) ]] || fail "the plain renderers"
grep -q '^missing' out && fail "pictures are missing"

[[ $failures -eq 0 ]]
