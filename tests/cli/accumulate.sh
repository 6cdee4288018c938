#!/usr/bin/env bash
# conic render --accumulate: one picture over threads, tiles, instruction sets, previews and resumes; its stops, its lens
# and its shutter; what is refused.
# shellcheck disable=SC2086 # of options, several are one word
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$(dirname "$0")/../support/program.bash"

if ! "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  echo "skipped: planes are compared in EXR files, which this build does not write"
  exit 77
fi
"$conic" make knot -n 3000 -o knot.ply
scene="knot.ply --size 64x48 --zoom 2"
look="$scene --aperture 0.4 --blades 5 --aov rgba,Z,N,id,samples,variance"
draw() { # NAME, OPTIONS …
  run 0 render $look -o "$1.exr" --json "$1.json" "${@:2}"
}
hashes() {
  grep -A12 '"hash"' "$1.json" | grep -o '"[a-zA-Z]*": "[0-9a-f]*"'
}
same() {
  [[ $(hashes $1) == "$(hashes $2)" ]] || fail "$1 and $2 are two pictures"
}
other() {
  [[ $(hashes $1) != "$(hashes $2)" ]] || fail "$1 and $2 are one picture"
}

draw whole --accumulate 21 --threads 2
draw scalar --accumulate 21 --threads 1 --isa scalar --tile 16
same whole scalar
draw preview --accumulate 21 --preview 0.001
same whole preview

# In three runs, one of them by its time, and to the bit as in one.
draw part --accumulate 5 --resumable
draw part --accumulate 4000 --time 0.001 --resume part.exr --resumable
grep -q '"resumed": 5,' part.json || fail "the second run does not say that it goes on after 5"
grep -Eq '"samples": ([6-9]|1[0-9]),' part.json || fail "a run whose time is over at once does not add a sample"
draw resumed --accumulate 21 --resume part.exr
same whole resumed
cmp whole.exr resumed.exr || fail "the files of a whole and a resumed picture differ"
run 3 render $look --accumulate 21 --resume part.exr -o x.exr --aperture 0.41
grep -q 'the first sample is another one' err || fail "it goes on with another lens"
grep -q 'part.exr.sums was begun with other' err || fail "it does not name the file"
run 3 render $scene --accumulate 21 --resume part.exr -o x.exr
grep -q 'part.exr.sums: .* the plane' err || fail "it does not say which plane differs: $(cat err)"
run 3 render $look --size 32x24 --accumulate 21 --resume part.exr -o x.exr
grep -q 'part.exr.sums: .* 64 x 48 pixels, and the picture 32 x 24' err || fail "it does not say which size: $(cat err)"
run 3 render $look --accumulate 21 --resume nothing.exr -o x.exr

# What is stopped is gone on with, too: nothing but the stop itself writes these sums.
set -m # else what runs in the background ignores Ctrl-C
for seconds in 0.3 1 3 9; do # until the machine lets it begin
  "$conic" render --plain $look --accumulate 16777216 --resumable -o stopped.exr > out 2> err &
  sleep $seconds
  kill -INT $!
  wait $!
  got=$?
  n_kept=$(grep -o 'stopped after [0-9]*' err | grep -o '[0-9]*')
  [[ -z $n_kept ]] || break
done
set +m
[[ $got -eq 130 ]] || fail "a run that is stopped: exit code $got"
[[ ! -e stopped.exr ]] || fail "a run that is stopped leaves half a picture"
draw more --accumulate $((n_kept + 3)) --resume stopped.exr
grep -q "\"resumed\": $n_kept," more.json || fail "it does not go on after the $n_kept samples of a run that was stopped"
draw once --accumulate $((n_kept + 3))
same once more

# Stops, lens and shutter change what they should.
draw noise --accumulate 4096 --noise 0.02
grep -Eq '"samples": (16|32|64|128|256|512|1024),' noise.json || fail "--noise does not stop at a power of two"
"$conic" render $look --accumulate 4096 --noise 0.02 -o noise.exr 2>&1 | grep -q 'the mean of [0-9]* samples of 4096' ||
  fail "it does not tell that it stopped before its end"
draw round --accumulate 21 --blades 0
other whole round
draw near --accumulate 21 --focus 1.5
grep -q '"focus": 1.5' near.json || fail "--focus is not the focus"
draw pixel --accumulate 21 --focus 32,24
same whole pixel
other whole near
draw still --accumulate 21 --turntable 12 --frames 1
draw moved --accumulate 21 --turntable 12 --frames 1 --shutter 0:1
same whole still
other whole moved
# Of several frames, those that are finished stay, and one that was stopped goes on with its sums.
turn=($scene --accumulate 40 --turntable 3 -o turn.exr)
run 0 render "${turn[@]}" --resumable
mkdir turn && cp turn.000*.exr turn
[[ ! -e turn.0001.exr.sums ]] || fail "the sums of finished frames stay"
rm turn.0002.exr
run 0 render $scene --accumulate 7 --turntable 3 --frames 2 --resumable -o turn.exr
run 0 render "${turn[@]}" --resume turn.exr --threads 1 --json turn.json
grep -q '"frames_finished": 1,' turn.json || fail "of three frames one is finished, and one is what the report is about"
[[ ! -e turn.0002.exr.sums ]] || fail "the sums of a frame that was gone on with stay"
diff <(cat turn/*) <(cat turn.000*.exr) || fail "frames that were gone on with are others"
run 3 render "${turn[@]}" --resume turn.exr --aperture 0.1
grep -q 'turn.exr.frames: cannot go on: it was begun with other inputs or options' err || fail "it goes on: $(cat err)"
echo nothing > turn.exr.frames
run 3 render "${turn[@]}" --resume turn.exr
rm turn.exr.frames
run 3 render "${turn[@]}" --resume turn.exr
run 0 render "${turn[@]}" --resume turn.exr --resumable
run 2 render "${turn[@]}" --resume x.exr
run 2 render $scene --turntable 3 --resumable -o -
run 2 render $scene --resumable -o x.exr
# One frame of several is gone on with, too.
draw turned --accumulate 10 --turntable 12 --frames 1 --resumable
draw again --accumulate 21 --turntable 12 --frames 1 --resume turned.0001.exr
same still again
draw spaced --accumulate 21 --aperture 1x
other whole spaced
"$conic" render $look --aperture 99 --accumulate 1 -o x.exr 2>&1 | grep -q 'wider than the whole scene' ||
  fail "nothing is said of a lens that is wider than the scene"

# A knot's mean is as bright as what supersampling makes of it.
run 0 render $scene --samples 16 --prefilter 1 -o fine.exr
run 0 render $scene --accumulate 256 --prefilter 0.00390625 -o mean.exr
run 0 diff fine.exr mean.exr --min-psnr 40

run 2 render $scene --aperture 1 -o x.exr
run 2 render $scene --shutter 0:1 -o x.exr
run 2 render $scene --accumulate 4 --shutter 0:1 -o x.exr
run 2 render $scene --accumulate 4 --samples 2 -o x.exr
run 2 render $scene --accumulate 4 --aperture 1 --blades 2 -o x.exr
run 2 render $scene --accumulate 4 --aperture 1 --focus 0 -o x.exr
run 2 render $scene --accumulate 4 --focus 1 -o x.exr
run 2 render $scene --accumulate 4 --blades 5 -o x.exr
run 2 render $scene --ao 1e6 -o x.exr
grep -q 'is not between' err || fail "--ao 1e6 does not say what it takes: $(cat err)"
run 2 render $scene --accumulate 4 --aperture 1 --focus 64,1 -o x.exr
run 2 render $scene --accumulate 4 --aperture 1 --focus 1e30,1 -o x.exr
run 2 render $scene --accumulate 4 --aperture 1 --focus 1,48 -o x.exr
run 2 render $scene --aov variance -o x.exr
run 2 render $scene --accumulate 4 --resumable -o -
run 2 render $look --accumulate 21 --turntable 12 --frames 1:2 --resume part.exr -o x.exr
[[ $failures -eq 0 ]]
