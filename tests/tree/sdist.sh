#!/usr/bin/env bash
# Python's archive of sources holds every folder that the build takes sources from. The rule is first tried on a list
# from which each folder in turn is missing.
set -uo pipefail

source_folder=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
manifest=$source_folder/python/pyproject.toml

# The folders that CMakeLists.txt names sources or headers of, but for what only ranks and tests need.
mapfile -t rooms < <(sed 's/#.*//' "$source_folder/CMakeLists.txt" | grep -oE '[a-z]+/(\*\.c|[a-z_/]*\.(c|in|cmake))' |
  sed 's|/.*||' | sort -u | grep -vxE 'mpi|tests|examples')
rooms+=(include)
[[ ${#rooms[@]} -ge 16 ]] || { echo "FAILED: only these are taken for rooms: ${rooms[*]}"; exit 1; }

missing() { # MANIFEST
  for room in "${rooms[@]}"; do
    grep -qxF "\"../$room\" = \"engine/$room\"" "$1" || echo "$room"
  done
}
for room in "${rooms[@]}"; do
  grep -vF "\"../$room\"" "$manifest" > "$work/manifest"
  [[ $(missing "$work/manifest") == *"$room"* ]] || { echo "FAILED: not seen that $room is missing"; exit 1; }
done
absent=$(missing "$manifest")
[[ -z $absent ]] || echo "FAILED: the archive of sources lacks" $absent "(python/pyproject.toml)"
for folder in $(sed -n 's|^"\.\./\([a-z/]*\)" = "engine/.*|\1|p' "$manifest"); do
  [[ -d $source_folder/$folder ]] || { echo "FAILED: there is no $folder for the archive of sources"; absent=$folder; }
done
[[ -z $absent ]]
