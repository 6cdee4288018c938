#!/usr/bin/env bash
# Turntables: which frames are drawn, what their files are called, and how a camera of a file goes around.
set -uo pipefail

source "$1/tests/support/program.bash"
holds() { # NAMES: what is in the folder `out.d`, which is then emptied
  local found
  found=$(cd out.d && echo *)
  [[ $found == "$*" ]] || fail "written: $found, and not $*"
  rm -f out.d/*
}
mkdir out.d
"$conic" make knot -n 500 -o knot.ply
turn() { # EXIT_CODE, ARGUMENTS …
  run "$1" render knot.ply --size 24x16 "${@:2}"
}

# Names
turn 0 --turntable 2 -o out.d/a.pfm -o out.d/b_%d.pfm -o out.d/c%02d-e.pfm -o out.d/%%.50%s%04d.pfm
holds %%.50%s0001.pfm %%.50%s0002.pfm a.0001.pfm a.0002.pfm b_1.pfm b_2.pfm c01-e.pfm c02-e.pfm
turn 0 --turntable 2 -o out.d/100%.pfm -o out.d/%5d.pfm
holds %5d.0001.pfm %5d.0002.pfm 100%.0001.pfm 100%.0002.pfm
turn 0 --turntable 9 --frames 4-8x2 -o out.d/a####.pfm -o out.d/c#.pfm
holds a0004.pfm a0006.pfm a0008.pfm c#.0004.pfm c#.0006.pfm c#.0008.pfm
for words in 4-8x 4- x2 4-8-2 4x8; do turn 2 --turntable 9 --frames $words -o out.d/a.pfm; done
turn 0 -o out.d/%04d.pfm # one picture is no frame
holds %04d.pfm
turn 0 --turntable 2 --overdraw out.d/o%d.pfm
holds o1.pfm o2.pfm
if "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  turn 0 --turntable 2 --deep out.d/d%d.exr
  holds d1.exr d2.exr
fi
printf 'v %s\n' '0 0 0' '1 0 0' '1 0 1' '0 0 1' > square.obj
printf 'f 1 2 3 4\n' >> square.obj
run 0 render square.obj --as hybrid --size 24x16 --turntable 2 --clusters out.d/c%d.pfm
holds c1.pfm c2.pfm
turn 2 --turntable 2 -o out.d/%d-%04d.pfm
grep -q 'one place' err || fail "two places for one number: $(cat err)"
turn 2 --turntable 2 -o out.d/a.pfm -o out.d/a.%04d.pfm
grep -q 'two outputs cannot both go to' err || fail "two outputs with one name: $(cat err)"
turn 2 --turntable 1000 -o out.d/a%d.pfm -o out.d/a%03d.pfm --frames 900:1000
grep -q 'two outputs cannot both go to' err || fail "two outputs with one last name: $(cat err)"
cp knot.ply out.d/knot.0001.pfm
run 2 render out.d/knot.0001.pfm -o out.d/knot.pfm --turntable 2
grep -q 'is an input' err || fail "a frame may be written over an input: $(cat err)"
rm out.d/*

# Which frames
turn 0 --turntable 12 -o all.pfm
turn 0 --turntable 12 -o out.d/some.pfm --frames 2:9:3 --json out.json
for number in 0002 0005 0008; do
  cmp all.$number.pfm out.d/some.$number.pfm || fail "frame $number is another one by itself"
done
grep -q '"frames": 3' out.json || fail "the frames are counted wrongly"
holds some.0002.pfm some.0005.pfm some.0008.pfm
turn 0 --turntable 12 -o out.d/some.pfm --frames 12
holds some.0012.pfm
turn 0 --turntable 12 -o out.d/some.pfm --frames 3:4
holds some.0003.pfm some.0004.pfm
for frames in 0 13 4:3 1:13 1:2:0 1: :2 1:2: 1:2:3:4 1x 1:2x -1 a ''; do
  turn 2 --turntable 12 -o out.d/some.pfm "--frames=$frames"
done
turn 2 -o out.d/some.pfm --frames 1
for frames in 0 10000 2x '' -3; do
  turn 2 -o out.d/some.pfm "--turntable=$frames"
done
holds '*'

# A camera of a file goes the same way as one that is framed: here it stands where azimuth 0 and elevation 0 put it, but
# half as far above the horizon as its distance. Its first frame is its own to the bit.
printf '{"width": 24, "height": 16, "fx": 20, "fy": 20, "cx": 12, "cy": 8,
  "world_to_camera": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 6], [0, 0, 0, 1]]}' > camera.json
printf '%s\n' '-1 -1 -1 255 0 0' '1 1 1 0 255 0' '1 -1 -1 0 0 255' '-1 -1 1 255 255 0' > four.xyz
run 0 render four.xyz --camera camera.json -o own.pfm
run 0 render four.xyz --camera camera.json -o out.d/turned.pfm --turntable 4
cmp own.pfm out.d/turned.0001.pfm || fail "the first frame is not the camera's own"
# A quarter of a turn, counter-clockwise as seen from above: the eye goes from +z to +x
printf '{"width": 24, "height": 16, "fx": 20, "fy": 20, "cx": 12, "cy": 8,
  "world_to_camera": [[0, 0, -1, 0], [0, -1, 0, 0], [-1, 0, 0, 6], [0, 0, 0, 1]]}' > quarter.json
run 0 render four.xyz --camera quarter.json -o quarter.pfm
run 0 diff quarter.pfm out.d/turned.0002.pfm --max-abs 1e-4
# and about the centre of the scene, wherever that is, and what --up says
sed 's/-1 -1 -1 255/-1 -1 -3 255/; s/^-1 -1 1/-1 -1 -1/' four.xyz > moved.xyz # its box is centred at z = -1
printf '{"width": 24, "height": 16, "fx": 20, "fy": 20, "cx": 12, "cy": 8,
  "world_to_camera": [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 6], [0, 0, 0, 1]]}' > half.json
run 0 render moved.xyz --camera half.json -o half.pfm
run 0 render moved.xyz --camera camera.json -o out.d/rolled.pfm --turntable 2 --up z
run 0 diff half.pfm out.d/rolled.0002.pfm --max-abs 1e-4
printf '{"width": 24, "height": 16, "fx": 20, "fy": 20, "cx": 12, "cy": 8,
  "world_to_camera": [[-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 1, 8], [0, 0, 0, 1]]}' > behind.json
run 0 render moved.xyz --camera behind.json -o behind.pfm
run 0 render moved.xyz --camera camera.json -o out.d/turned.pfm --turntable 2
run 0 diff behind.pfm out.d/turned.0002.pfm --max-abs 1e-4

# Paths: frames from 0, whatever else is drawn of them; --frames and --resume take them as others.
rm -f out.d/*
printf '{"keys": [{"time": 0, "place": [0, 0, 6], "target": [0, 0, 0]}, {"time": 2, "place": [6, 0, 0]}]}' > keys.json
turn 0 --path keys.json --fps 2 -o out.d/p.pfm
cp out.d/p.0003.pfm third.pfm
holds p.0000.pfm p.0001.pfm p.0002.pfm p.0003.pfm p.0004.pfm
turn 0 --path keys.json --fps 2 -o out.d/p.pfm --frames 1:4:2 --resumable
cmp third.pfm out.d/p.0003.pfm || fail "--frames changes a frame of a path"
holds p.0001.pfm p.0003.pfm p.pfm.1-4-2.frames
turn 2 --path keys.json --turntable 2 -o out.d/p.pfm
turn 2 --path keys.json --camera camera.json -o out.d/p.pfm
turn 4 --path keys.json -o absent.d/p.pfm
printf '{"keys": [{"time": 0}]}' > short.json
turn 3 --path short.json -o out.d/p.pfm
printf '{"keys": [{"time": 0, "place": [0, 0, 6], "target": [0, 0, 0]}, {"time": 2, "place": [0, 0, -6]}]}' > through.json
turn 3 --path through.json --fps 2 -o out.d/p.pfm

# Films: what ffmpeg is told and given, by one that keeps both; one that ends early; and where there is none.
mkdir bin none
cat > bin/ffmpeg << 'END'
#!/bin/sh
for word; do last=$word; done
echo "$*" > words
cat > "$last"
END
chmod +x bin/ffmpeg
for tool in sh cat; do ln -s "$(command -v $tool)" none; done
whole=$PATH
PATH=$PWD/bin:$whole
turn 0 --path keys.json --fps 2 -o "out.d/it's.mp4" --film 10:20
[[ $(stat -c %s "out.d/it's.mp4") -eq $((5 * 24 * 16 * 6)) ]] || fail "ffmpeg gets $(stat -c %s out.d/*) bytes"
grep -q -- '-video_size 24x16 -framerate 2 .*-crf 20 .*yuv420p10le .*-f mp4' words || fail "ffmpeg is told $(cat words)"
holds "it's.mp4"
turn 0 --turntable 3 -o out.d/f.gif -o out.d/f%d.pfm
holds f.gif f1.pfm f2.pfm f3.pfm
turn 2 -o out.d/f.mp4
turn 2 --turntable 3 -o out.d/f%d.mp4
grep -q 'a film is one file' err || fail "of frames that are films: $(cat err)"
turn 2 --turntable 3 -o out.d/f.gif --film 8
turn 2 --turntable 3 -o out.d/f.mp4 --resumable
printf '#!/bin/sh\nexit 1\n' > bin/ffmpeg
run 4 render knot.ply --size 400x300 --turntable 3 -o out.d/f.mp4
[[ $(wc -l < err) -eq 1 ]] || fail "an end that breaks: $(cat err)"
PATH=$PWD/none
turn 4 --turntable 2 -o out.d/f.webm
PATH=$whole
grep -q "by -o 'out.d/f.png'.*: ffmpeg -framerate 25 -start_number 1 -i 'out.d/f.%04d.png' 'out.d/f.webm'" err || fail "without ffmpeg: $(cat err)"
holds '*'

[[ $failures -eq 0 ]]
