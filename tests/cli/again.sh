#!/usr/bin/env bash
# What a picture says of how it was made draws it again to the bit, as does --save-shot: every reference picture, and
# pictures of every kind; options change what they say; what has changed is told of.
set -uo pipefail

source "$1/tests/support/program.bash"
source_folder=$1
if ! "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  echo "skipped: the pictures are EXR files, which this build does not write"
  exit 77
fi
has() {
  "$conic" --version | grep -q "^In this build:.*$1"
}

# is_drawn_again NAME PICTURE SHOT [INPUT …]: from the picture, and from the shot, to the same file and the same key
is_drawn_again() {
  local name=$1 picture=$2 shot=$3 ending=${2##*.}
  shift 3
  rm -f by_picture.* by_shot.*
  run_as_typed 0 render --again "$picture" "$@" -q -o "by_picture.$ending" --json by_picture.json
  run_as_typed 0 render "$shot" "$@" -q -o "by_shot.$ending" --save-shot by_shot.shot.json
  cmp "$picture" "by_picture.$ending" || fail "$name: --again is another picture: $("$conic" diff "$picture" "by_picture.$ending")"
  cmp "$picture" "by_shot.$ending" || fail "$name: the shot is another picture: $("$conic" diff "$picture" "by_shot.$ending")"
  cmp "$shot" by_shot.shot.json || fail "$name: the shot of what a shot draws is another"
  [[ ! -e drawn.json || $(grep shot_key drawn.json) == "$(grep shot_key by_picture.json)" ]] || fail "$name: another key"
}
again() { # NAME ARGUMENTS …: of one picture
  local name=$1
  shift
  rm -f a.exr a.shot.json drawn.json
  run_as_typed 0 render "$@" -q -o a.exr --save-shot a.shot.json --json drawn.json
  is_drawn_again "$name" a.exr a.shot.json
}

# Every reference picture; a sanitizer sees its code at work on the pictures below
data=$1/../shared/data
n_references=0
references=("$1"/refimages/*/cmd)
[[ ! $sanitized ]] || references=("$1"/refimages/confetti-18/cmd)
for command in "${references[@]}"; do
  name=$(basename "$(dirname "$command")")
  mkdir "$name"
  (
    cd "$name" || exit 1
    here=$source_folder/refimages
    source "$here/common.bash"
    draw() {
      local argument inputs=()
      for argument in "$@"; do # which are beside no picture
        [[ $argument != "$data"/* ]] || inputs+=("$argument")
      done
      rm -f drawn.json
      run_as_typed 0 render --plain "$@" --quiet -o a.exr --save-shot a.shot.json --json drawn.json
      is_drawn_again "$name" a.exr a.shot.json "${inputs[@]}"
    }
    if [[ $name == confetti-18 ]]; then # which writes a file of its own, and makes colours of it
      "$conic" make knot -n 20000 --quiet -o knot.ply
      draw knot.ply --size 256x256 --aov count
    else
      source "$command"
    fi
    exit $((failures > 0))
  )
  answer=$?
  [[ $answer -eq 0 || ($answer -eq 77 && ! -d $data) ]] || fail "$name: $answer"
  [[ $answer -ne 0 ]] || n_references=$((n_references + 1))
  rm -rf "$name"
done
[[ $n_references -ge 18 || $n_references -eq ${#references[@]} ]] || fail "only $n_references reference pictures were drawn again"

# Kinds of scenes, cameras and light
"$conic" make knot -n 3000 -q -o k.ply
"$conic" make sphere -n 2000 -q -o s.ply
small=(--size 40x32)
again default k.ply "${small[@]}"
again exposure k.ply "${small[@]}" --light 1,2,3:1,.5,.2 --background 0.1,0.2,0.3:0,0,0 --exposure auto
again spacings k.ply "${small[@]}" --epsilon 2x --near 0.5x --samples 3 --method ray --kernel hat --cull back
again lit k.ply "${small[@]}" --ao 8 --shadow --light lamp:2,3,4:9,9,9:0.2 --light 1,2,3 --aov rgba,ao,shadow
again fisheye k.ply "${small[@]}" --projection fisheye --ao 4
again lens k.ply "${small[@]}" --accumulate 5 --aperture 2x --blades 5 --light 1,2,3:1:2deg
again patches s.ply "${small[@]}" --method patch --h 4x --degree 2
again colors k.ply "${small[@]}" --color-by height --ramp heat --legend --up z
again where k.ply "${small[@]}" --where 'z > 0'
again planes k.ply "${small[@]}" --aov all --exr half --compression pxr24
again mattes k.ply s.ply "${small[@]}" --cryptomatte
"$conic" render k.ply --size 32x16 --projection panorama -q -o sky.exr
again sky k.ply "${small[@]}" --sky sky.exr --ao 8
printf '[{"input": 0, "frame": 1, "file": "s2.ply"}]' > m.json
"$conic" make sphere -n 2000 --jitter 0.3 -q -o s2.ply
again motion s.ply "${small[@]}" --accumulate 4 --motion m.json --shutter 0:1 --aperture 0.1
awk -f "$1/refimages/gaussians.awk" -v n=200 > g.ply
for profile in exact inria-2023 gsplat-1.6-aa 2dgs-2024 khr-2026 surface; do
  again "$profile" g.ply "${small[@]}" --profile $profile
done
again gaussians g.ply "${small[@]}" --samples 2 --prefilter 0.3 --aov rgba,Z,T,id
"$conic" prepare k.ply -q -o kp.ply
"$conic" octree kp.ply -q -o k.cot
again octree k.cot "${small[@]}" --error 2
if has zstd; then
  "$conic" layer kp.ply -q -o k.lpc
  again layers k.lpc "${small[@]}" --budget 500
fi
printf 'v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nmtllib m.mtl\nusemtl a\nf 1/1 2/2 3/3 4/4\n' > m.obj
printf 'newmtl a\nKd 0.5 0.6 0.7\n' > m.mtl
again mesh m.obj "${small[@]}"
again smooth m.obj k.ply "${small[@]}" --as mesh --smooth --transparency
"$conic" hybrid m.obj -q -o m.chy
again hybrid m.chy "${small[@]}" --only surfels --error 1 --aov all
again joined k.ply m.obj "${small[@]}" --error 3
again octree k.ply m.obj "${small[@]}" --error 3 --accumulate 2

# One of several: a frame of a turntable while the shutter is open, an eye, a view of COLMAP
rm -f drawn.json
run_as_typed 0 render k.ply "${small[@]}" --turntable 3 --accumulate 4 --shutter 0:0.5 --aperture 0.1 -q -o turn.exr \
  --save-shot turn.shot.json
is_drawn_again turntable turn.0002.exr turn.0002.shot.json
run_as_typed 0 render k.ply "${small[@]}" --stereo 0.1 -q -o eyes.exr --save-shot eyes.shot.json
is_drawn_again stereo eyes.left.exr eyes.left.shot.json
mkdir colmap
printf '1 PINHOLE 40 32 40 40 20 16\n' > colmap/cameras.txt
printf '1 1 0 0 0 0 0 5 1 a.jpg\n\n2 1 0 0 0 0.5 0 5 1 b.jpg\n\n' > colmap/images.txt
printf '' > colmap/points3D.txt
run_as_typed 0 render k.ply --camera colmap --view all -q -o view_%s.exr --save-shot view_%s.shot.json
rm -r colmap # which is not needed for it
is_drawn_again colmap view_b.exr view_b.shot.json

# Other kinds of files, and maps
for ending in png tif; do
  has "$([[ $ending == png ]] && echo PNG || echo OpenImageIO)" || continue
  run_as_typed 0 render k.ply "${small[@]}" --tone agx -q -o "a.$ending" --save-shot a.shot.json
  is_drawn_again $ending a.$ending a.shot.json
done
for planes in rgba Z; do
  run_as_typed 0 render k.ply --camera top:0.1 --aov $planes -q -o map.tif --save-shot map.shot.json
  is_drawn_again "a map of $planes" map.tif map.shot.json
done
run_as_typed 0 render k.ply "${small[@]}" -q -o a.exr
run_as_typed 0 render k.ply "${small[@]}" --no-shot -q -o bare.exr
[[ $(wc -c < bare.exr) -lt $(wc -c < a.exr) ]] || fail "--no-shot leaves nothing out"
run_as_typed 0 diff a.exr bare.exr
run_as_typed 3 render --again bare.exr -o x.exr
grep -q 'bare.exr: does not say how it was made' err || fail "a picture without a shot: $(cat err)"
grep -q "$PWD" a.exr && fail "a picture tells the folder that it was drawn in"

# Options change what it says, and nothing else.
run_as_typed 0 render k.ply "${small[@]}" --samples 1 --light 1,2,3 --background 0.2,0.1,0 -q -o a.exr
changed() { # OPTIONS …: the same as if they had been given at first
  run_as_typed 0 render --again a.exr "$@" -q -o again.exr
  run_as_typed 0 render k.ply "${small[@]}" --samples 1 --light 1,2,3 --background 0.2,0.1,0 "$@" -q -o fresh.exr
  "$conic" diff again.exr fresh.exr > out || fail "--again with $*: $(cat out)"
}
changed --samples 3
changed --prefilter 0.5 --kernel box
changed --background none
changed --shade lambert --method conic
changed --aov rgba,N,id
changed --accumulate 3
changed --azimuth 80 --size 30x30 --near 0.001
run_as_typed 0 render --again a.exr --size 20x16 -q -o small.exr --save-shot small.shot.json
grep -q '"fx": 21.9[78]' small.shot.json || fail "the camera is not scaled: $(grep fx small.shot.json)"
run_as_typed 1 diff small.exr a.exr --json diff.json
grep -q '^shot: camera.width 20 -> 40$' out || fail "which numbers differ: $(cat out)"
grep -q '"field": "camera.width"' diff.json || fail "the JSON does not say which numbers differ"

# Inputs: missing, elsewhere, changed, and parts of them
run_as_typed 0 render m.obj "${small[@]}" -q -o m.exr
mkdir elsewhere
mv m.obj m.mtl elsewhere
run_as_typed 3 render --again m.exr -o x.exr
grep -q 'error: m.obj: it is not there, and m.exr was drawn from it' err || fail "a missing input: $(cat err)"
run_as_typed 0 render --again m.exr elsewhere/m.obj -q -o x.exr
cmp m.exr x.exr || fail "an input elsewhere makes another picture"
cp m.exr elsewhere
run_as_typed 0 render --again elsewhere/m.exr -q -o x.exr
run_as_typed 2 render --again m.exr k.ply -o x.exr
sed 's/0.5/0.6/' elsewhere/m.mtl > m.mtl
cp elsewhere/m.obj .
run_as_typed 3 render --again m.exr -o x.exr
grep -q 'error: m.mtl: it has changed: m.exr was drawn from [0-9a-f]*…, and this is [0-9a-f]*…' err ||
  fail "a changed part: $(cat err)"
rm m.mtl
run_as_typed 3 render --again m.exr -o x.exr
printf 'v 2 2 2\n' >> m.obj
run_as_typed 3 render --again m.exr -o x.exr
grep -q 'error: m.obj: it has changed' err || fail "a changed input: $(cat err)"

# Another camera is framed as without a shot, but for what maps it to the picture, and that is said
run_as_typed 0 render k.ply --size 30x30 --projection orthographic -q -o flat.exr
run_as_typed 0 render --again flat.exr --zoom 2 -o x.exr
grep -q 'flat.exr: the scene is framed anew' err || fail "framing anew is not said: $(cat err)"
run_as_typed 0 render k.ply --size 30x30 --projection orthographic --zoom 2 -q -o y.exr
run_as_typed 0 diff x.exr y.exr
run_as_typed 0 render --again flat.exr --up x -q -o x.exr
run_as_typed 0 render k.ply --size 30x30 --projection orthographic --up x -q -o y.exr
run_as_typed 0 diff x.exr y.exr

# Another shape shows more or less at the sides, and stretches nothing
run_as_typed 0 render --again a.exr --size 60x16 -q -o x.exr --save-shot wide.shot.json
[[ $(grep -o '"f[xy]": [0-9.]*' wide.shot.json | sort -u -k 2 | wc -l) -eq 1 ]] ||
  fail "another shape stretches: $(grep '"f[xy]"' wide.shot.json)"
grep -q '"cx": 30,$' wide.shot.json || fail "another shape moves the middle: $(grep '"cx"' wide.shot.json)"
run_as_typed 2 render --again sky.exr --size 20x20 -q -o x.exr

# Without a camera the scene is framed; a length that is another is a change
sed '/"camera": {/,/},/d' a.shot.json > bare.shot.json
run_as_typed 0 render bare.shot.json --size 40x32 -q -o x.exr
sed 's/"bytes": [0-9]*/"bytes": 7/' a.shot.json > other.shot.json
run_as_typed 3 render other.shot.json -o x.exr
grep -q 'k.ply: it has changed: other.shot.json was drawn from 7 bytes' err || fail "another length: $(cat err)"

# A map's planes are those that were asked for
run_as_typed 0 render k.ply --camera top --gsd 0.1 --aov rgba,Z -q -o map.tif
run_as_typed 0 render --again map.tif -q -o again.tif
cmp map.tif again.tif || fail "the colours of a map with heights are others"
cmp map.Z.tif again.Z.tif || fail "the heights of a map are not drawn again"

# Only what decides a bit is in the key: no time, no light's direction at the eye
key_of() {
  run_as_typed 0 render "$@" -q -o x.exr --json key.json
  grep -o '"shot_key": "[0-9a-f]*"' key.json
}
if has zstd; then
  usual=$(key_of k.lpc "${small[@]}")
  for option in '--deadline 1000' --tolerate '--timeout 20' '--occlusion off' '--memory 300' '--tile 16' '--isa scalar' \
    '--threads 1' '--device cpu'; do
    read -ra words <<< "$option"
    [[ $(key_of k.lpc "${small[@]}" "${words[@]}") == "$usual" ]] || fail "$option makes another key"
  done
  "$conic" make knot -n 20000 -q -o l.ply
  "$conic" layer l.ply -q -o l.lpc
  run_as_typed 0 render l.lpc "${small[@]}" --progressive levels -q -o x.exr
  for picture in levels/0*.exr; do
    run_as_typed 0 render --again "$picture" l.lpc -q -o again.exr
    "$conic" diff "$picture" again.exr > out || fail "--again of $picture: $(cat out)"
  done
  run_as_typed 1 diff levels/0001.exr x.exr
fi
run_as_typed 0 render k.ply "${small[@]}" --light head --light 1,2,3 -q -o x.exr --save-shot head.shot.json
sed 's/"frame": "head",*/&\n"direction": [1, 2, 3],/; s/\("frame": "head"\)$/\1,/' head.shot.json > stray.shot.json
grep -q 'direction": \[1, 2, 3\],' stray.shot.json || fail "no stray direction: $(cat stray.shot.json)"
[[ $(key_of head.shot.json) == $(key_of stray.shot.json) ]] || fail "a direction at the eye makes another key"

# Numbers that nothing draws: the file is named, and the field
bad() { # FROM TO MESSAGE
  sed -z "s/$1/$2/" head.shot.json > bad.shot.json
  cmp -s head.shot.json bad.shot.json && fail "no $1 in the shot"
  run_as_typed 3 render bad.shot.json -o x.exr
  grep -q "bad.shot.json: $3" err || fail "$1: $(cat err)"
}
bad '"fx": [0-9.]*' '"fx": 0' 'fx is 1e-12 to 1e+12, and not 0 (line'
bad '"width": 40' '"width": 70000' 'width is 1 to 65535'
bad '"near_z": [0-9.e-]*' '"near_z": -1' 'near_z is 0 to'
bad '"splat_length": [0-9.]*' '"splat_length": -1' 'splat_length is 0 to'
bad '"cx": [0-9.]*' '"cx": 1e300' 'cx is -1e+12'
bad '"samples": 2' '"samples": 0' 'samples is 1 to 16'
bad '"samples": 2' '"samples": 2, "only_kind": 7' 'only_kind is -1 to 1'
bad '"samples": 2' '"samples": 2, "error_px": -1' 'error_px is 0 to'
bad '"crease_deg": 30' '"crease_deg": 30, "n_neighbours": 0' 'n_neighbours is 6 to 64'
bad '"crease_deg": 30' '"crease_deg": 30, "cutoff": 99' 'cutoff is 0.25 to 5'
bad '"cam_from_world": \[\[' '"cam_from_world": [[1' "the camera's cam_from_world is no rotation"
bad '"conic_shot": 1' '"conic_shot": 1, "n_samples": 3' 'means of samples draw one sample'
bad '"bytes": [0-9]*' '"bytes": 1e30' 'bytes is 0 to'

# What takes no longer than it should: pixels that are wide or high, and one input again and again
sed 's/"fx": [0-9.]*/"fx": 4e9/' a.shot.json > far.shot.json
run_as_typed 0 render far.shot.json --size 40x32 -q -o x.exr
for ((i = 0; i < 1000; i++)); do printf '{"name": "k.ply"}, '; done > many
printf '{"conic_shot": 1, "inputs": [%s{"name": "k.ply"}]}' "$(cat many)" > bad.shot.json
run_as_typed 3 render bad.shot.json -o x.exr
grep -q "bad.shot.json: the input 'k.ply' stands too many times" err || fail "one input again and again: $(cat err)"

# What is no shot
for text in '{"conic_shot": 1, "inputs": [{"name": "k.ply"}], "view": {"samples": 1, "samples": 2}}' \
  '{"conic_shot": 1, "inputs": [{"name": "k.ply"}], "camera": {"fx": null}}' '{"conic_shot": 2}' '{"conic_shot": 1, "camra": {}}' '{"conic_shot": 1}' '{"conic_shot": 1, "inputs": [{"name": "-"}]}'; do
  echo "$text" > bad.shot.json
  run_as_typed 3 render bad.shot.json -o x.exr
done
run_as_typed 3 render --again k.ply -o x.exr
run_as_typed 2 render a.exr --again a.exr -o a.exr

exit $((failures > 0))
