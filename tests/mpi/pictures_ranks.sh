#!/usr/bin/env bash
# conic-mpi: one picture of any scene is shared out in windows, and has the bits of one process.
set -uo pipefail

source "$1/tests/support/program.bash"
source "$1/tests/support/ranks.bash"
source "$1/tests/support/torus.bash"

torus 20 12 torus.obj picture.pfm
torus 14 8 glass.obj picture.pfm 0.4
"$conic" make knot -n 1500 -o knot.ply
"$conic" make gaussians -n 300 -o cloud.ply
counted='"(splats|triangles)_[a-z]*"|"(fragments|triangle_fragments|pixels_covered|entries)":'

alike() { # NAME, RANKS, OPTIONS …: of one process and of several
  local name=$1 n=$2
  "$conic" render "${@:3}" --plain --threads 1 -o "$name.alone.exr" --json "$name.alone.json" || fail "$name: cannot be drawn"
  err=$name.err ranks "$n" 0 render "${@:3}" --plain --threads 1 -o "$name.exr" --json "$name.json" || return
  same_hashes "$name.alone.json" "$name.json" "$name"
  cmp "$name.alone.exr" "$name.exr" || fail "$name: the file differs"
  [[ $(grep -E "$counted" "$name.alone.json") == "$(grep -E "$counted" "$name.json")" ]] || fail "$name: other counts"
  grep -q '"shares": "windows"' "$name.json" || fail "$name is not drawn in windows"
  grep -o '"units": [0-9]*' "$name.json" | awk '{n += $2} END {exit n < 2}' || fail "$name: it was not parted"
}

alike mixed 3 torus.obj knot.ply --as mesh --size 200x130 --aov rgba,Z,N,albedo,weight,count,id
alike lit 2 glass.obj knot.ply --as mesh --size 150x130 --samples 2 --transparency --ao 5 --shadow --light 1,1,1 \
  --light lamp:0,2,2:3,3,3 --aov rgba,Z,ao,shadow
alike hybrid 2 torus.obj --as hybrid --size 140x130 --projection fisheye --aov rgba,id,cluster --exposure auto
alike gaussians 3 cloud.ply --profile inria-2023 --size 200x130 --aov rgba,Z,N,count,id,T,last
alike rays 2 cloud.ply --profile exact --projection panorama --samples 2 --size 130x140 --aov rgba,Z

exit $((failures > 0))
