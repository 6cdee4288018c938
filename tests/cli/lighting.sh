#!/usr/bin/env bash
# --light, --sky and --background: what is taken, what is refused, what moves with the camera, and what is there where
# nobody said.
# shellcheck disable=SC2086 # of options, several are one word
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$(dirname "$0")/../support/program.bash"

"$conic" make sphere -n 4000 -o ball.ply
look="--size 64x48 --json run.json"
draw() { # NAME, OPTIONS …: plainly
  run 0 render ball.ply -o "$1.pfm" $look "${@:2}"
}
hash_of() {
  draw x "$@"
  grep -o '"rgba": "[0-9a-f]*"' run.json
}
same() {
  [[ $(hash_of $1) == "$(hash_of $2)" ]] || fail "'$1' and '$2' are two pictures"
}
other() {
  [[ $(hash_of $1) != "$(hash_of $2)" ]] || fail "'$1' and '$2' are one picture"
}

# The picture's mean brightness, left and right of its middle, above and below it
sides() {
  python3 - "$1" << 'END'
import struct, sys
with open(sys.argv[1], 'rb') as file:
    file.readline()
    width, height = map(int, file.readline().split())
    file.readline()
    values = struct.unpack('<%df' % (width * height * 3), file.read())
sums = [0.0, 0.0, 0.0, 0.0]  # a PFM begins below
for i in range(width * height):
    sums[i % width >= width // 2] += values[3 * i + 1]
    sums[2 + (i // width < height // 2)] += values[3 * i + 1]
print(*('%.4f' % (s / sum(sums[:2])) for s in sums))
END
}

# The one white light by its several names
same '' '--light head'
same '' '--light head:1,1,1 --sky 0.05'
same '' '--light head:1 --sky 0.05,0.05,0.05:0.05'
same '' '--light head --light 1,2,3:0'
same '--light 1,2,3' '--light 1,2,3:1 --sky 0.05'
same '--light none --sky 0.05' '--light head:0'
same '--light camera:0,0,2 --azimuth 10' '--light camera:0,0,1 --azimuth 10'
same '--light studio' '--sky 0.17,0.19,0.22:0.055,0.05,0.045 --light studio'
other '' '--light camera:0,0,1'
other '' '--light studio'
same '--sky 0.3' '--sky 0.3:0.3'
other '--sky 0.3:0.1' '--sky 0.1:0.3'
other '--light 1,2,3 --light 3,1,1' '--light 3,1,1'

# With the camera moves what is told to, with the scene the rest, around a whole turntable
run 0 render ball.ply -o camera.pfm $look --turntable 4 --light camera:1,0,0 --sky 0 --shade lambert
run 0 render ball.ply -o world.pfm $look --turntable 4 --light 0,0,1 --sky 0 --shade lambert --azimuth 0 --elevation 0
run 0 render ball.ply -o sky.pfm $look --turntable 4 --light none --sky 1:0 --elevation 0
for i in 1 2 3 4; do
  read -r left right above below < <(sides camera.000$i.pfm)
  awk "BEGIN { exit !($right > 0.9) }" || fail "frame $i: the camera's light is not on the right: $left $right"
  read -r left right above below < <(sides sky.000$i.pfm)
  awk "BEGIN { exit !($above > 1.5 * $below) }" || fail "frame $i: the sky is not above: $above $below"
done
read -r left right above below < <(sides world.0002.pfm)
awk "BEGIN { exit !($left > 0.9) }" || fail "the scene's light moves with the camera: $left $right"

# A camera of a file may be rolled: the sky stays above the scene, whose up is to its left
cat > camera.json << 'END'
{"width": 64, "height": 48, "fx": 60, "fy": 60, "cx": 32, "cy": 24,
 "world_to_camera": [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]}
END
run 0 render ball.ply -o roll.pfm --camera camera.json --light none --sky 1:0
read -r left right above below < <(sides roll.pfm)
awk "BEGIN { exit !($left > 1.5 * $right) }" || fail "the sky turns with a camera: $left $right"

# What is refused
for light in '' x 1,2 1,2,3,4 0,0,0 camera camera: camera:0,0,0 camera:1,2 head: head:-1 head:1,2 head:nan head:1e9 \
  studio:1 none:1 1,2,3: 1,2,3:1:1 camera:1,2,3:1,2,3,4 heads Head " head" camera:1,2,3,head \
  1,2,3:1:2 1,2,3:1:91deg 1,2,3:1:-1deg 1,2,3:1:deg head:1:2deg lamp lamp: lamp:1,2 lamp:1,2,3: lamp:1,2,3:-1 \
  lamp:1,2,3:1:-1 lamp:1,2,3:1:2x1 lamp:1,2,3:1:0:0,1,0 lamp:1,2,3:1:1x0:0,1,0 lamp:1,2,3:1:1:0,0,0 \
  lamp:1,2,3:1:1:0,1,0:1 lamp:camera:1,2,3; do
  run 2 render ball.ply -o no.pfm --light "$light"
done
for sky in '' x 1,2 1:2:3 : 1: :1 -0.1 1,1,1,1 inf 1e7; do
  run 2 render ball.ply -o no.pfm --sky "$sky"
done
for background in '' x 1,2 1:2:3 : 1: :1 -1 none:1 inf; do
  run 2 render ball.ply -o no.pfm --background "$background"
done
eight=(--light head)
for i in 1 2 3 4 5 6 7; do
  eight+=(--light "1,2,$i")
done
run 0 render ball.ply -o x.pfm --size 16x16 "${eight[@]}"
run 2 render ball.ply -o no.pfm "${eight[@]}" --light none --light head
run 2 verify ball.ply --background 1:0
run 2 verify ball.ply --light lamp:1,2,3
run 2 verify ball.ply --light 1,2,3:1:2deg
[[ ! -e no.pfm ]] || fail "something is drawn after wrong usage"

# The oracle knows them all
run 0 verify ball.ply --size 48x48 --light studio --light 1,-2,1:0.2,0.1,0

# Where nobody said: the studio, but not plainly
lights_of() {
  run_as_typed 0 render ball.ply -o x.pfm --size 16x16 --json run.json "$@"
  tr -d ' \n' < run.json | grep -o '"frame":"[a-z]*"' | cut -d'"' -f4 | tr '\n' ' '
}
[[ $(lights_of) == "camera camera head " ]] || fail "by default: $(lights_of)"
[[ $(lights_of --plain) == "head " ]] || fail "plainly: $(lights_of --plain)"
[[ $(lights_of --light 1,2,3) == "world " ]] || fail "one light: $(lights_of --light 1,2,3)"
[[ $(lights_of --sky 1) == "camera camera head " ]] || fail "a sky: $(lights_of --sky 1)"
[[ $(lights_of --shade none) == "" ]] || fail "unshaded: $(lights_of --shade none)"

# Behind the picture: a gradient is that of its rows' middles, and a colour of equal ends is that colour
draw up --background 0.9,0,0:0.1,0,0 --zoom 0.01 --exposure 1
python3 - << 'END' || fail "the gradient is another one"
import struct
with open('up.pfm', 'rb') as file:
    file.readline(), file.readline(), file.readline()
    values = struct.unpack('<%df' % (64 * 48 * 3), file.read())
for y in range(48):
    assert abs(values[(47 - y) * 64 * 3] - 2 * (0.9 - 0.8 * (y + 0.5) / 48)) < 1e-6, y
END
same '--background 0.2,0.4,0.6:0.2,0.4,0.6' '--background 0.2,0.4,0.6'
same '--background 0.5' '--background 0.5,0.5,0.5'

# Edges that a pixel only partly has
draw soft --samples 4 --shade none --background 0.2,0.3,0.4:0.2,0.3,0.4
draw soft-one --samples 4 --shade none --background 0.2,0.3,0.4
run 0 diff soft.pfm soft-one.pfm --max-abs 1e-6

# Where nobody said: behind PNG alone, and not in the hash
if "$conic" --version | grep -q '^In this build:.*libpng' && "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  run_as_typed 0 render ball.ply -o a.png -o a.exr $look
  with=$(grep -o '"rgba": "[0-9a-f]*"' run.json)
  run_as_typed 0 render ball.ply -o b.png -o b.exr $look --background none
  [[ $with == "$(grep -o '"rgba": "[0-9a-f]*"' run.json)" ]] || fail "the backdrop is in the hash"
  cmp -s a.png b.png && fail "a PNG has no backdrop"
  cmp a.exr b.exr || fail "an EXR has a backdrop"
  run_as_typed 0 render ball.ply -o c.png --plain --light studio --quality good $look
  run_as_typed 0 render ball.ply -o d.png --plain --light studio --quality good --background none $look
  cmp c.png d.png || fail "a plain PNG has a backdrop"
fi

[[ $failures -eq 0 ]]
