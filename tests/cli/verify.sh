#!/usr/bin/env bash
# conic verify: exit codes, statistics, and that it sees what is wrong.
set -uo pipefail

source "$1/tests/support/program.bash"
has() { # PATTERN: in the output
  grep -qe "$1" out || fail "no \"$1\" in: $(head -c 1500 out)"
}

run 0 make knot -n 3000 -o knot.ply
run 0 make sphere -n 2000 -o sphere.ply

# The renderer keeps its bounds, with whatever options
for method in conic ray affine point disc auto; do
  run 0 verify knot.ply --size 160x120 --method $method
  has '^pass$'
  has '^Z  *max .* bound 1e-05'
  has '^unstable  '
done
run 0 verify knot.ply --size 100x80 --azimuth 70 --elevation -20 --fov 60 --zoom 2 --up z --cull back --shade lambert \
  --light 1,2,3 --background 0.1,0.2,0.3 --exposure 1 --cutoff 2 --epsilon 0.02 --prefilter 0.5
run 0 verify knot.ply sphere.ply --size 200x160 --near 2.5 --passes 1 --quiet
has '^pass$'
cat > camera.json << 'END'
{"width": 90, "height": 70, "fx": 80, "fy": 75, "cx": 44, "cy": 36,
 "world_to_camera": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 3], [0, 0, 0, 1]]}
END
run 0 verify knot.ply --camera camera.json
run 0 verify knot.ply --camera camera.json --shade lambert+edl:6
run 0 verify knot.ply --size 60x40 --samples 3 --json -
has '"samples": 3,'
has '"covered_samples": '
has '"pass": true'

# Statistics
run 0 verify knot.ply --size 160x120 --json -
for key in against method planes bound compared_pixels unstable_pixels covered_pixels unstable_by_reason pass; do
  grep -q "^  \"$key\": " out || fail "no $key in the statistics"
done
for plane in rgba Z N albedo weight count id; do
  grep -A 2 "^    \"$plane\": {" out | grep '"max_abs": ' > seen || fail "no max_abs of $plane"
  grep -A 2 "^    \"$plane\": {" out | grep '"p999": ' > seen || fail "no p999 of $plane"
  grep -qE "^    \"$plane\": [0-9.e-]+,?$" out || fail "no bound of $plane"
done
has '"pass": true'
if command -v python3 > /dev/null; then
  python3 -m json.tool < out > /dev/null || fail "the statistics are not JSON"
fi
run 0 verify knot.ply --size 64x48 --aov Z,N --json v.json
grep -q '"N": {' v.json || fail "no N in the file"
grep -q '"rgba": {' v.json && fail "rgba, unasked"

# Some of the pixels: always the same, of all kinds of pictures
run 0 verify knot.ply --size 160x120 --pixels 500
has '^judged    500 of 19200 pixels, 0 wrong$'
cp out first
run 0 verify knot.ply --size 160x120 --pixels 500 --threads 1
cmp -s out first || fail "other pixels the second time"
run 0 verify knot.ply --size 40x30 --pixels 50k --samples 2
has '^judged    1200 of 1200 pixels, 0 wrong$'
run 0 verify knot.ply --size 48x36 --against exact --pixels 60
has '^judged    60 of 1728 pixels, 0 wrong$'
run 2 verify knot.ply --pixels 0

# Dots, whose axes are each picture's, measured as they are kept
awk 'BEGIN { seed = 3
  for (i = 0; i < 1500; i++) {
    for (k = 0; k < 4; k++) { seed = seed * 16807 % 2147483647; value[k] = seed / 2147483647 }
    size = value[3] ^ 4
    print size * value[0], size * value[1], size * value[2]
  } }' > foliage.xyz
run_as_typed 0 verify foliage.xyz --size 96x96

# A long run is stopped
"$conic" verify knot.ply --plain --size 4000x4000 --against exact > out 2> err &
stopped=$!
sleep 1
kill -TERM $stopped
wait $stopped
[[ $? -eq 143 ]] || fail "an interrupted run goes on, or ends otherwise"

# The exact question: no bounds, but errors
run 0 verify knot.ply --size 48x36 --against exact --json -
has '"against": "exact"'
has '"weight_error": {'
has '"rgba": null'
run 0 verify knot.ply --size 48x36 --against exact --method ray
has '^weights  *max '

# A picture drawn elsewhere: right, and with weights a thousandth off, the light elsewhere, another size
if "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  run 0 render knot.ply --size 160x120 --aov all -o right.exr
  run 0 verify knot.ply --size 160x120 --image right.exr
  run 0 render knot.ply --size 160x120 --aov all --prefilter 1.002 -o wrong.exr
  run 1 verify knot.ply --size 160x120 --image wrong.exr
  has '^weight .*FAILED$'
  has '^worst     pixel [0-9]*,[0-9]*: .* is .*; it may be '
  has '^FAILED$'
  run 1 verify knot.ply --size 160x120 --image wrong.exr --json -
  has '"pass": false'
  run 1 verify knot.ply --size 160x120 --image right.exr --light 0,1,0
  run 1 verify knot.ply --size 160x120 --image right.exr --samples 2
  run 3 verify knot.ply --size 160x121 --image right.exr
  grep -q '^conic: error: right.exr: ' err || fail "no word on the size"
else
  echo "skipped: pictures drawn elsewhere, as this build has no OpenEXR"
fi

# What fails
run 2 verify
run 2 verify knot.ply --against nothing
run 2 verify knot.ply -o out.exr
run 2 verify knot.ply --camera camera.json --zoom 2
run 3 verify absent.ply
run 3 verify knot.ply --image absent.exr --size 20x20
run 4 verify knot.ply --size 20x20 --json missing/v.json
[[ $(wc -l < err) -eq 1 ]] || fail "more than one line of error"

[[ $failures -eq 0 ]]
