#!/usr/bin/env bash
# --color-by and what goes with it: which colours a picture has, what is said of them, and what cannot be.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

value() { # KEY FILE: the first value of a key in a JSON file
  sed -nE "s/^ *\"$1\": \"?([^\",]*)\"?,?$/\1/p" "$2" | head -n 1
}

# A slope of 20 x 20 points whose values grow along x; without colours.
{
  printf 'ply\nformat ascii 1.0\nelement vertex 400\nproperty float x\nproperty float y\nproperty float z\n'
  printf 'property float nx\nproperty float ny\nproperty float nz\n'
  printf 'property float Intensity\nproperty uchar scalar_Classification\nproperty int heat\nend_header\n'
  for ((i = 0; i < 400; i++)); do
    echo "$((i % 20)) $((i / 20)) $((i % 20 / 2)) 0 0 1 $((i % 20 * 10)) $((i % 3 * 2)) 7"
  done
} > slope.ply
picture="--size 64x64"

run 0 render slope.ply -o plain.pfm $picture --json plain.json
grep -q '"coloring"' plain.json && fail "--plain made colours"
run_as_typed 0 render slope.ply -o auto.pfm --size 64x64 --json auto.json
[[ $(value field auto.json) == intensity && $(value ramp auto.json) == grey && $(value scale auto.json) == root ]] ||
  fail "the intensity is not what a file without colours shows"
[[ $(value minimum auto.json) == 0 && $(value maximum auto.json) == 190 ]] || fail "limits of the intensity"
run_as_typed 0 render slope.ply -o rgb.pfm --size 64x64 --color-by rgb --json rgb.json
grep -q '"coloring"' rgb.json && fail "--color-by rgb made colours"
cmp -s auto.pfm rgb.pfm && fail "the intensity is not seen"

for by in intensity height classification normal heat x; do
  run 0 render slope.ply -o $by.pfm $picture --color-by $by --json $by.json
  [[ $(value field $by.json) == "$by" ]] || fail "--color-by $by: the field"
  [[ $by == heat ]] || ! cmp -s $by.pfm plain.pfm || fail "--color-by $by changes nothing"
done
[[ $(value ramp height.json) == terrain && $(value ramp classification.json) == classes ]] || fail "ramps"
[[ $(value ramp x.json) == sequential && $(value maximum classification.json) == 4 ]] || fail "ramps of values"
grep -q '"ramp"' normal.json && fail "normals have no ramp"
run 0 render slope.ply -o up.pfm $picture --color-by height --up y --json up.json
[[ $(value maximum up.json) == 19 && $(value maximum height.json) == 9 ]] || fail "height is not along --up"
run 0 render slope.ply -o range.pfm $picture --color-by x --color-range -5,5.5 --ramp heat --json range.json
[[ $(value minimum range.json) == -5 && $(value maximum range.json) == 5.5 && $(value ramp range.json) == heat ]] ||
  fail "--color-range, --ramp"
for threads in 1 3; do
  run 0 render slope.ply -o t$threads.pfm $picture --color-by x --threads $threads
done
cmp -s t1.pfm t3.pfm || fail "threads change the colours"

# Several inputs share one scale, which covers both.
sed -E '/end_header/,$ s/^([0-9]+) /10\1 /' slope.ply > far.ply
run 0 render slope.ply far.ply -o both.pfm $picture --color-by x --json both.json
[[ $(value minimum both.json) == 0 ]] && awk -v m="$(value maximum both.json)" 'BEGIN { exit !(m > 1000) }' ||
  fail "two inputs have two scales"

# The legend.
run 0 render slope.ply -o legend.pfm $picture --color-by x --legend --legend-out bar.pfm
cmp -s legend.pfm x.pfm && fail "--legend draws nothing"
[[ -s bar.pfm ]] || fail "--legend-out writes nothing"
run 0 render slope.ply -o plain2.pfm $picture --legend
grep -q "no legend" err || fail "--legend without colours is not told"
cmp -s plain2.pfm plain.pfm || fail "--legend without colours"

# What cannot be.
run 3 render slope.ply -o no.pfm --color-by intensty
grep -q "no field 'intensty' (did you mean 'Intensity'?); there are: x, y, z, nx, ny, nz, Intensity, scalar_Classification, heat" err ||
  fail "the fields are not listed"
run 2 render slope.ply -o no.pfm --color-by x --ramp sequentail
grep -q "did you mean 'sequential'" err || fail "no ramp is suggested"
run 2 render slope.ply -o no.pfm --color-by x --color-range 3,3
run 2 render slope.ply -o no.pfm --color-by x --color-range 3
run 2 render slope.ply -o no.pfm --color-by ""
run 2 render slope.ply -o no.pfm $picture --ramp heat
[[ ! -e no.pfm ]] || fail "a picture of what cannot be"

# The light on what shows values is grey, as the legend is true then, unless it is given.
for i in {0..99}; do echo "$((i % 10)) $((i / 10)) 0 $((i % 2))" ; done > value.txt
run_as_typed 0 render value.txt -o value.pfm --size 9x9 --columns x,y,z,v --color-by v --ramp grey --background 0,0,0 --json value.json
perl -0777 -ne 'my @sky = /"sky": \[\s*([\d.e-]+),\s*([\d.e-]+),\s*([\d.e-]+)/ or exit 1; exit !($sky[0] == $sky[1] && $sky[1] == $sky[2])' \
  value.json || fail "a coloured sky on values: $(cat value.json)"
run_as_typed 0 render value.txt -o value.pfm --size 9x9 --columns x,y,z,v --color-by v --json value.json --sky 0.1,0.2,0.3
grep -q '0.3' value.json || fail "the given sky is lost"

# Builders keep colours; what keeps colours has no fields, and heights and normals all the same.
run 0 prepare --plain slope.ply -o prepared.ply --color-by x --json prepavalue.json
[[ $(value maximum prepavalue.json) == 19 ]] || fail "prepare: the range"
run 0 render prepared.ply -o prepavalue.pfm $picture --shade none
run 0 render slope.ply -o unlit.pfm $picture --color-by x --shade none
cmp -s prepavalue.pfm unlit.pfm || fail "prepare keeps other colours than a picture has"
run 0 octree slope.ply -o slope.cot --color-by height --up z --json octree.json
[[ $(value maximum octree.json) == 9 ]] || fail "octree: the range"
run 0 render slope.cot -o cot.pfm $picture
cmp -s cot.pfm plain.pfm && fail "octree keeps no colours"
run 0 render slope.cot -o cot-normal.pfm $picture --color-by normal
run 3 render slope.cot -o no.pfm --color-by intensity
grep -q "it keeps colours, not 'intensity'" err || fail "octree: fields"
run 2 render slope.cot -o no.pfm --color-by height --error 2
if "$conic" --version | grep -q '^In this build:.*zstd'; then
  run 0 layer slope.ply -o slope.lpc --color-by x --json layer.json
  [[ $(value maximum layer.json) == 19 && $(value field layer.json) == x ]] || fail "layer: the range"
  run 0 render slope.lpc -o lpc.pfm $picture
  run 0 render slope.lpc -o lpc-height.pfm $picture --color-by height
  cmp -s lpc.pfm lpc-height.pfm && fail "layer: colours by height"
fi

# A mesh, as triangles and as a hybrid, whatever its materials.
printf 'mtllib none.mtl\nv 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 2\nf 1 2 3\nf 1 3 4\n' > mesh.obj
for as in mesh hybrid; do
  run 0 render mesh.obj -o $as.pfm $picture --as $as --color-by height --json $as.json
  [[ $(value maximum $as.json) == 3 ]] || fail "--as $as: the range"
  run 0 render mesh.obj -o white.pfm $picture --as $as
  cmp -s $as.pfm white.pfm && fail "--as $as: no colours"
done
run 3 render mesh.obj -o no.pfm --as mesh --color-by quality

# A texture that is not to be seen.
printf 'v %s\n' '0 0 0' '1 0 0' '0 1 1' > mesh.obj
echo 'f 1 2 3' >> mesh.obj
for command in "render mesh.obj -o x.png" "hybrid mesh.obj -o x.chy"; do
  # shellcheck disable=SC2086 # several words
  run 2 $command --texture x.jpg --color-by height
  grep -q -- '--texture has no effect: --color-by height colours' err || fail "$command: $(cat err)"
done

# What there is to colour by.
run 0 info slope.ply --check --json info.json
grep -q '"name": "scalar_Classification"' info.json || fail "info: the fields"
grep -A3 '"name": "Intensity"' info.json | grep -q '"maximum": 190' || fail "info: the largest value"
run 0 info slope.ply
grep -q '^values .*Intensity, scalar_Classification, heat' out || fail "info: the fields in words"
[[ $failures -eq 0 ]]
