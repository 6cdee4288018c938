#!/usr/bin/env bash
# conic hybrid, conic render and conic info of a .chy: what the command line promises.
set -uo pipefail
# shellcheck source=tests/program.bash
source "$1/tests/program.bash"

value() { # KEY FILE: the first value of a key in a JSON file
  sed -nE "s/^ *\"$1\": \"?([^\",]*)\"?,?$/\1/p" "$2" | head -n 1
}

hashes() { # FILE
  sed -n '/"hash"/,/}/p' "$1"
}

"$1/scripts/terrain-mesh" 60 60 > hill.obj

run 0 hybrid hill.obj -o hill.chy --json made.json
[[ $(value triangles_in made.json) == 7200 && $(value bytes made.json) == $(stat -c %s hill.chy) ]] || fail "counts"
[[ $(value triangles made.json) -gt 0 && $(value surfels made.json) -gt 0 ]] || fail "not both kinds"
[[ $(value open_edges made.json) == 240 && $(value nan made.json) == 0 ]] || fail "oddities of an open sheet"
run 0 hybrid hill.obj -o one.chy --threads 1
cmp -s one.chy hill.chy || fail "threads change the file"
run 0 info hill.chy --check --json info.json
[[ $(value kind info.json) == chy && $(value sound info.json) == true ]] || fail "info"
[[ $(value surfels info.json) == "$(value surfels made.json)" ]] || fail "info: surfels"

# A mesh that becomes a hybrid on the way is the file; nothing but the choice changes a picture.
picture="--size 160x120 --aov rgba,Z,id,cluster"
run 0 render hill.chy -o a.pfm $picture --json file.json
run 0 render hill.obj --as hybrid -o b.pfm $picture --json mesh.json
[[ -n $(hashes file.json) && $(hashes file.json) == "$(hashes mesh.json)" ]] || fail "--as hybrid is another picture"
[[ $(value cluster file.json) =~ ^[0-9a-f]{16}$ ]] || fail "no plane cluster"
for other in "--threads 1" "--isa scalar" "--tile 16"; do
  # shellcheck disable=SC2086 # an option and its value
  run 0 render hill.chy -o c.pfm $picture $other --json other.json
  [[ $(hashes file.json) == "$(hashes other.json)" ]] || fail "$other changes the picture"
done

# All in one kind; fewer with an error.
run 0 render hill.chy -o t.pfm $picture --only triangles --json triangles.json
[[ $(value splats_in triangles.json) == 0 && $(value surfel_patches triangles.json) == 0 ]] || fail "--only triangles"
run 0 render hill.chy -o s.pfm $picture --only surfels --json surfels.json
[[ $(value triangle_patches surfels.json) == 0 && $(value splats_in surfels.json) -gt 0 ]] || fail "--only surfels"
last=100000
for error in 0.25 1 4; do
  run 0 render hill.chy -o e.pfm $picture --error $error --json error.json
  triangles=$(value triangles_in error.json)
  n=$(($(value splats_in error.json) + ${triangles:-0}))
  [[ $n -lt $last && $n -gt 0 ]] || fail "--error $error draws $n after $last"
  last=$n
done

# Refused, and nothing is left under the output's name.
run 2 hybrid -o x.chy
run 2 hybrid hill.obj
run 2 hybrid hill.obj hill.obj -o x.chy
run 2 hybrid hill.obj -o x.chy --sampling dice
run 3 hybrid missing.obj -o x.chy
printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\n' > points.obj
run 3 hybrid points.obj -o x.chy
printf 'v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n' > line.obj
run 3 hybrid line.obj -o x.chy
run 3 hybrid hill.obj -o x.chy --texture missing.png
[[ ! -e x.chy ]] || fail "a file that is none"
head -c 1000 hill.chy > cut.chy
run 3 render cut.chy -o x.pfm
run 3 info cut.chy
run 2 render hill.chy hill.obj -o x.pfm
run 2 render hill.obj -o x.pfm --only surfels
run 2 render hill.obj -o x.pfm --aov cluster
run 2 render hill.chy -o x.pfm --budget 10
run 2 verify hill.chy

[[ $failures -eq 0 ]]
