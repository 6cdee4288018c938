#!/usr/bin/env bash
# What `conic render FILE -o OUT` does when nothing else is said: the outline fills the picture, stands upright, and has
# soft edges.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$(dirname "$0")/../support/program.bash"

# box FILE.pfm: the part of the width and of the height where something white is, how many pixels are partly so, and
# the part of all that are wholly
box() {
  python3 - "$1" << 'END'
import struct, sys
with open(sys.argv[1], 'rb') as file:
    kind, size, scale = file.readline().strip(), file.readline().split(), float(file.readline())
    width, height = int(size[0]), int(size[1])
    values = struct.unpack('<%df' % (width * height * 3), file.read())
assert kind == b'PF' and scale < 0, kind
rows, columns, soft, full = set(), set(), 0, 0
for i in range(width * height):
    alpha = values[3 * i]
    if alpha > 0:
        rows.add(i // width)
        columns.add(i % width)
        soft += alpha < 0.999
        full += alpha >= 0.999
print('%.3f %.3f %d %.3f' % ((max(columns) + 1 - min(columns)) / width, (max(rows) + 1 - min(rows)) / height, soft,
                             full / (width * height)))
END
}

# between VALUE LOW HIGH
between() {
  awk "BEGIN { exit !($1 >= $2 && $1 <= $3) }"
}

# A white slab that lies in the plane of x and y, and the same slab on its edge; without normals and faces
for ((i = 0; i < 60; i++)); do
  for ((j = 0; j < 40; j++)); do
    echo "$i $j 0.$((i * j % 7))"
  done
done > flat.xyz
awk '{ print $1, $3, -$2 }' flat.xyz > upright.xyz
look="--shade none --background 0,0,0 --size 200x200"

run_as_typed 0 render flat.xyz -o flat.pfm $look --json flat.json
grep -q '^conic: up: z, as it lies flat; --up says otherwise$' err || fail "up is not told: $(cat err)"
read -r width height soft full < <(box flat.pfm)
between "$width" 0.88 0.92 || between "$height" 0.88 0.92 || fail "the outline fills $width × $height of the picture"
between "$width" 0 0.92 && between "$height" 0 0.92 || fail "the outline fills $width × $height of the picture"
[[ $soft -gt 100 ]] || fail "$soft pixels are partly covered"
run_as_typed 0 render flat.xyz -o up.pfm $look --up z
[[ ! -s err ]] || fail "something is told of what was said: $(cat err)"
"$conic" diff flat.pfm up.pfm > out || fail "--up z is another picture: $(cat out)"

# Other shapes of picture; and the pictures of a turntable, none of which is larger
run_as_typed 0 render flat.xyz -o wide.pfm --shade none --background 0,0,0 --size 300x100
read -r width height soft full < <(box wide.pfm)
between "$width" 0.88 0.92 || between "$height" 0.86 0.94 || fail "of a wide picture $width × $height are filled"
run_as_typed 0 render flat.xyz -o turn.pfm $look --turntable 3
for i in 1 2 3; do
  read -r width height soft full < <(box turn.000$i.pfm)
  between "$width" 0.5 0.92 || fail "turn $i is $width wide"
done

# What streams is no different: it is looked at from six sides first
if "$conic" --version | grep '^In this build:' | grep -q zstd; then
  for shape in flat upright; do
    run 0 layer $shape.xyz -o $shape.lpc
    run_as_typed 0 render $shape.lpc -o layers.pfm $look
    read -r width height soft full < <(box layers.pfm)
    between "$width" 0.86 0.93 || between "$height" 0.86 0.93 || fail "of $shape.lpc $width × $height are filled"
    run_as_typed 0 render $shape.xyz -o points.pfm $look --json points.json
    run_as_typed 0 render $shape.lpc -o layers.pfm $look --json layers.json
    cmp <(grep -A1 '"up"' points.json) <(grep -A1 '"up"' layers.json) || fail "$shape.lpc stands otherwise"
  done
fi

# A slope is seen from its front, whichever way it faces, unless the azimuth is given
covers() { # the part that is covered by slope.*
  run_as_typed 0 render "$1" -o slope.pfm $look "${@:2}"
  read -r width height soft full < <(box slope.pfm)
  echo "$full"
}
for direction in 0 90 180 270; do
  awk -v d=$direction '{ a = d * 0.0174532925; print $1, $2, -0.8 * ($1 * cos(a) + $2 * sin(a)) }' flat.xyz > slope.xyz
  full=$(covers slope.xyz)
  between "$full" 0.25 0.7 || fail "a slope that faces $direction covers $full"
  sides="$(covers slope.xyz --azimuth 30) ${sides:-}"
done
[[ $(printf '%s\n' $sides | sort -g | head -1) < 0.1 ]] || fail "a slope from the azimuth that is given: $sides"
if [[ -f flat.lpc ]]; then
  run 0 layer slope.xyz -o slope.lpc
  full=$(covers slope.lpc)
  between "$full" 0.25 0.7 || fail "slope.lpc covers $full"
fi

# The quality names samples and method; what is given goes first, and what is measured has one sample
sample_of() { # the picture's method, and whether it has soft pixels
  run_as_typed 0 render flat.xyz -o sampled.pfm $look --json sampled.json "$@"
  read -r width height soft full < <(box sampled.pfm)
  echo "$(grep -o '"method": "[a-z]*"' sampled.json | cut -d'"' -f4) $((soft > 0))"
}
for pair in ':auto 1' '--quality draft:conic 0' '--quality good:auto 1' '--quality final:auto 1' \
  '--quality draft --samples 2:conic 1' '--quality final --samples 1:auto 0' '--quality final --method disc:disc 1' \
  '--repeat 2:auto 0' '--plain:auto 0' '--plain --quality draft:conic 0' '--quality sketch:conic 0'; do
  # shellcheck disable=SC2086
  got=$(sample_of ${pair%:*})
  [[ $got == "${pair#*:}" ]] || fail "${pair%:*}: $got"
done

# A sketch leaves raw points out, and says so in its shot
awk 'BEGIN { for (i = 0; i < 50000; i++) print i % 250, int(i / 250), 0.1 * (i % 7) }' > many.xyz
run_as_typed 0 render many.xyz -o sketch.png --size 100x100 --quality sketch --json sketch.json
grep -q '"splats_in": 25000,' sketch.json || fail "a sketch of 50000 points has $(grep splats_in sketch.json)"
run_as_typed 0 render --again sketch.png -o again.png
"$conic" diff sketch.png again.png > out || fail "a sketch is another again: $(cat out)"

# Longitude and latitude become metres
awk '{ printf "%.7f %.7f %.2f\n", -123.07 + $1 * 1e-5, 44.05 + $2 * 1e-5, 100 + 10 * $3 }' flat.xyz > degrees.xyz
run_as_typed 0 render degrees.xyz -o degrees.pfm $look
grep -q 'degrees of longitude and latitude: drawn in metres about -123.069705, 44.050195' err || fail "$(cat err)"
read -r width height soft full < <(box degrees.pfm)
between "$width" 0.88 0.92 || between "$height" 0.88 0.92 || fail "degrees fill $width × $height"
run_as_typed 0 prepare degrees.xyz -o degrees.ply
grep -q 'degrees of longitude and latitude.*reproject' err || fail "prepare: $(cat err)"

[[ $failures -eq 0 ]]
