#!/usr/bin/env bash
# Single samples of final pictures, which verify judges and explain explains: where they are by plain geometry, not by
# the code that places them; that a mean is judged by its samples; what is refused.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"
has() { # PATTERN: in the output
  grep -qe "$1" out || fail "no \"$1\" in: $(head -c 1500 out)"
}

# Three splats that face the camera, at depths 1, 2 and 4; that in the middle is in focus.
splat='0.1 0 0 0 0.1 0'
printf 'ply\nformat ascii 1.0\nelement vertex 3\n' > three.ply
for name in x y z tu_x tu_y tu_z tv_x tv_y tv_z; do printf 'property double %s\n' $name; done >> three.ply
printf 'end_header\n0.1 0.1 1 %s\n-0.2 0 2 %s\n0.4 -0.4 4 %s\n' "$splat" "$splat" "$splat" >> three.ply
camera='"width": 64, "height": 48, "fx": 50, "fy": 50, "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]'
echo "[{\"id\": 0, \"img_name\": \"a\", $camera, \"position\": [0, 0, 0]}," \
  "{\"id\": 1, \"img_name\": \"b\", $camera, \"position\": [0.5, 0, 0]}]" > way.json
look="three.ply --camera way.json --view 0 --method conic"
centers() { # SAMPLE OPTIONS …: "x y" of each splat, on one line
  # shellcheck disable=SC2086 # of options, several are one word
  run 0 explain $look --sample "$1" --dump-projection centers.csv "${@:2}"
  awk -F, 'NR > 1 { printf "%s %s ", $7, $8 } END { print "" }' centers.csv
}

# Through a lens: what is in focus moves by less than a pixel, once to each 16th of it; all else by
# f·l·(1/F - 1/z) more, with one l, of at most half the lens, for all depths.
for ((i = 0; i < 16; i++)); do centers $i --aperture 0.2 --focus 2; done > lens.txt
awk 'function lens(way, depth) { return way / (50 * (1 / 2 - 1 / depth)) }
  function is_far(a, b) { return a - b > 1e-5 || b - a > 1e-5 }
  {
    u = ($1 - 37) - ($3 - 27); v = ($2 - 29) - ($4 - 24)
    lx = lens(u, 1); ly = lens(v, 1)
    if (is_far(lx, lens(($5 - 37) - ($3 - 27), 4)) || is_far(ly, lens(($6 - 19) - ($4 - 24), 4))) print "two lenses", NR
    square = lx * lx + ly * ly; most = square > most ? square : most
    quadrant[(lx > 0) + 2 * (ly > 0)]++
    column[int(16 * (27.5 - $3))]++; row[int(16 * (24.5 - $4))]++
    if ($3 <= 26.5 || $3 > 27.5 || $4 <= 23.5 || $4 > 24.5) print "out of the pixel", NR
  }
  END {
    if (most > 0.01 || most < 0.0064) print "the rim is at", sqrt(most)
    for (i = 0; i < 4; i++) if (quadrant[i] < 2) print "the lens has a dark side"
    for (i = 0; i < 16; i++) if (column[i] != 1 || row[i] != 1) print "a 16th of the pixel has not one sample"
  }' lens.txt > wrong
[[ ! -s wrong ]] || fail "the lens: $(cat wrong)"

# With the shutter open from the first camera to the second, half a unit to its right, once in each 16th of the time.
for ((i = 0; i < 16; i++)); do centers $i --shutter 0:1; done > way.txt
awk '{
    way = -(($1 - 37) - ($5 - 37)) / (50 * 0.5 * (1 - 0.25))
    if (way < 0 || way >= 1) print "out of the shutter:", way
    moment[int(16 * way)]++
  }
  END { for (i = 0; i < 16; i++) if (moment[i] != 1) print "a 16th of the time has not one sample" }' way.txt > wrong
[[ ! -s wrong ]] || fail "the shutter: $(cat wrong)"

# The same samples are judged, and their mean; another one is not taken for it.
run 0 make knot -n 800 -o knot.ply
scene="knot.ply --size 44x32 --zoom 1.5"
lens="--aperture 0.4 --blades 5"
# shellcheck disable=SC2086
{
  run 0 verify $scene --sample 5 $lens --turntable 9 --frames 3 --shutter 0:0.5 --json -
  has '"sample": 5,'
  run 0 verify $scene --accumulate 6 $lens --focus 20,20
  has '^samples   6, 0 pixels of them wrong$'
  run 0 verify $scene --accumulate 3 $lens --pixels 300 --json -
  has '"wrong_pixels": 0'
  run 0 explain $scene --sample 5 $lens --pixel 30,22
  has '"sample": 5,'
}
if "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  # shellcheck disable=SC2086
  {
    run 0 render $scene --accumulate 1 $lens --aov rgba -o first.exr
    run 0 verify $scene --sample 0 $lens --image first.exr
    run 0 render $scene --accumulate 6 $lens --aov rgba,Z,albedo,weight,count,id -o mean.exr
    run 0 verify $scene --accumulate 6 $lens --image mean.exr
    run 1 verify $scene --accumulate 7 $lens --image mean.exr
    run 1 verify $scene --accumulate 6 --aperture 0.4 --image mean.exr
    run 1 verify $scene --accumulate 6 $lens --method affine --image mean.exr
  }
fi

# Of two inputs, one turns; light and shadow are of where it is, whatever the threads.
run 0 make sphere -n 500 -o sphere.ply
echo '[{"input": 1, "frame": 0, "matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]},' \
  '{"input": 1, "frame": 1, "matrix": [[0,0,1,0.5],[0,1,0,0],[-1,0,0,0]]}]' > turn.json
run 0 verify sphere.ply knot.ply --size 44x32 --accumulate 3 --motion turn.json --shutter 0:0.5 --json -
has '"wrong_pixels": 0'
if "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  both="sphere.ply knot.ply --size 44x32 --accumulate 3 --motion turn.json --shadow --ao 4"
  # shellcheck disable=SC2086
  {
    run 0 render $both --shutter 0:1 -o moved.exr --threads 1
    run 0 render $both --shutter 0:1 -o moved2.exr --threads 2 --tile 16
    run 0 render $both --shutter 0:0 -o begin.exr
    run 0 render ${both/--motion turn.json/} -o still.exr
  }
  run 0 diff moved.exr moved2.exr
  run 0 diff begin.exr still.exr
  run 1 diff moved.exr still.exr
fi

run 2 verify knot.ply --aperture 0.1
run 2 render knot.ply -o x.png --motion turn.json
run 3 render knot.ply -o x.png --accumulate 2 --motion turn.json
run 3 render knot.ply -o x.png --accumulate 2 --motion knot.ply
run 2 verify knot.ply --sample 1 --accumulate 2
run 2 verify knot.ply --sample 16777216
run 2 verify knot.ply --sample 1 --samples 2
run 2 verify knot.ply --sample 1 --shutter 0:1
run 2 verify knot.ply --sample 1 --turntable 4 --frames 5
run 2 verify knot.ply --sample 1 --turntable 4 --frames 1:2
run 2 verify knot.ply --accumulate 2 --aov N
run 2 verify knot.ply --accumulate 2 --against exact
run 2 explain knot.ply --pixel 1,1 --blades 5
[[ $failures -eq 0 ]]
