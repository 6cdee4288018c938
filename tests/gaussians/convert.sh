#!/usr/bin/env bash
# conic convert: what it writes is what an independent decoder reads, what it says of losses is so, and what cannot be
# is refused. The scenes are those of ../shared/data/gaussians.
set -uo pipefail

source "$1/tests/support/program.bash"
data=$1/../shared/data/gaussians
decode="python3 $1/tests/gaussians/decode_scenes.py"

# Refusals need no data: two Gaussians, as .splat has them.
row='\0\0\0\0\0\0\200\77\0\0\0\100\0\0\200\77\0\0\200\77\0\0\0\77\1\2\3\4\200\177\200\200'
printf "$row$row" > two.splat
run 2 convert two.splat
run 2 convert two.splat -o two.png
run 2 convert two.splat -o two.splat
run 2 convert two.splat two.splat -o b.ply
run 2 convert two.splat -o b.ply --to obj
run 3 convert absent.ply -o b.ply
run 3 convert "$work" -o b.ply
head -c 40 two.splat > cut.splat
run 3 convert cut.splat -o b.ply
run 2 convert two.splat -o b.ply --frame rdr
[[ -e b.ply ]] && fail "something is written where nothing can be"
printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n' > points.ply
run 3 convert points.ply -o b.ply
grep -q 'no Gaussians' err || fail "of points: $(cat err)"
run 0 convert two.splat -o - --to ply
cp out c.ply
run 0 convert two.splat -o a.ply
"$conic" convert - -o b.ply < a.ply || fail "standard input"
cmp a.ply c.ply || fail "standard output is another scene"
cmp a.ply b.ply || fail "standard input is another scene"
run 0 convert two.splat -o again.splat --json -
grep -q '"lossless": true' out || fail "a .splat is not what it was"
cmp two.splat again.splat || fail "a .splat is not what it was to the byte"
run 0 convert two.splat -o same.splat --measure 2 --json -
grep -A 3 '"pictures": {' out | grep -q '"psnr": null' || fail "a lossless copy has other pictures: $(cat out)"
run 0 convert two.splat -o rough.spz --measure 3 --quiet
grep -Eq 'from 3 sides have a PSNR of [2-9][0-9]\.[0-9] dB' err || fail "rounded colours do not show: $(cat err)"
run 2 convert two.splat -o - --to ply --measure 1
run 0 info two.splat --check
grep -q '^sound  *yes' out || fail "info: $(cat out)"

if [[ ! -e $data/biker.spz ]]; then
  echo "skipped: $data/biker.spz is not there"
  [[ $failures -eq 0 ]] && exit 77
  exit 1
fi

# One scene in two files of other programs, and what others read of what is written.
has_zstd=0
"$conic" --version | grep -q '^In this build:.*zstd' && has_zstd=1
run 0 convert "$data/biker.compressed.ply" -o compressed.ply
if [[ $has_zstd -eq 1 ]]; then
  run 0 convert "$data/biker.spz" -o spz.ply
  run 0 convert "$data/biker.spz" -o again.spz --json -
  grep -q '"lossless": true' out || fail "an .spz is not what it was: $(grep lost out)"
fi
run 0 convert "$data/biker.compressed.ply" -o again.compressed.ply --json -
grep -q '"lossless": true' out || fail "a compressed.ply is not what it was: $(grep lost out)"
if ! python3 -c 'import numpy' 2> /dev/null; then
  echo "skipped: numpy is not installed"
  [[ $failures -eq 0 ]] && exit 77
  exit 1
fi
$decode compare "$data/biker.compressed.ply" compressed.ply 2e-7 5e-7 1e-6 1e-7 2e-7 0 || fail "compressed.ply"
[[ $has_zstd -eq 0 ]] || # scales below e^-10 are e^-10 in .spz
  $decode compare "$data/biker.compressed.ply" spz.ply 1.1e-3 1.3 4e-3 1e-7 1.4e-2 0 || fail "biker.spz"

# Every number of a scene of degree 3, format by format: half a step of each.
$decode write "$data/random200.npz" scene.ply
run 0 convert scene.ply -o same.ply --json -
grep -q '"lossless": true' out || fail "a .ply is not what it was: $(grep lost out)"
$decode compare scene.ply same.ply 0 0 0 0 0 0 || fail "ply"
run 0 convert scene.ply -o scene.splat
grep -q 'degree 3 became 0' err || fail "nothing is said of lost harmonics: $(cat err)"
$decode compare scene.ply scene.splat 0 1e-6 8e-3 1.97e-3 7e-3 - || fail "splat"
run 0 convert scene.ply -o scene.compressed.ply --keep-order
$decode compare scene.ply scene.compressed.ply 1e-3 4e-3 2e-3 1.97e-3 1e-2 0.0157 || fail "compressed.ply written"
run 0 convert scene.ply -o scene.glb
$decode compare scene.ply scene.glb 0 3e-7 1e-6 1e-7 0 0 || fail "glb"
if "$conic" --version | grep -q '^In this build:.*zlib'; then
  run 0 convert scene.ply -o scene.spz --spz-version 3 --json -
  grep -q '"frame_out": "rub"' out || fail "an .spz is not right, up, back: $(grep frame out)"
  $decode compare scene.ply scene.spz 1.3e-4 3.2e-2 2e-3 1.97e-3 1.4e-2 3.91e-3 || fail "spz"
  run 0 convert scene.spz -o back.ply
  $decode compare back.ply scene.spz 0 0 1e-6 1e-7 1e-6 0 || fail "spz read"
fi
if "$conic" --version | grep -q '^In this build:.*libwebp'; then
  run 0 convert scene.ply -o scene.sog --keep-order
  run 0 convert scene.sog -o sog.ply
  $decode compare scene.ply sog.ply 1e-4 3e-2 1e-2 1.97e-3 2e-2 0.1 || fail "sog"
  mkdir folder
  (cd folder && python3 -m zipfile -e ../scene.sog .)
  run 0 convert folder -o folder.ply
  cmp sog.ply folder.ply || fail "a folder is another scene than its archive"
fi

# Options.
run 0 convert scene.ply -o low.ply --sh-degree 1 --json -
grep -q '"sh_degree_out": 1' out || fail "--sh-degree: $(grep degree out)"
run 0 convert scene.ply -o kept.glb --frame keep
run 0 convert kept.glb -o kept.ply --from-frame rdf
$decode compare scene.ply kept.ply 0 1e-6 1e-6 2e-7 0 0 || fail "--frame keep"
run 0 convert scene.ply -o near.compressed.ply --json -
grep -q '"reordered": true' out || fail "a compressed.ply is not ordered: $(grep reordered out)"

# Nothing is made of a scene without Gaussians.
LC_ALL=C sed '/^end_header/q; s/^element vertex .*/element vertex 0/' scene.ply > none.ply
for ending in splat glb ply spz; do
  run 3 convert none.ply -o made.$ending
  grep -q 'none.ply: there are no Gaussians' err || fail "none as .$ending: $(cat err)"
  [[ ! -e made.$ending ]] || fail "none as .$ending is left"
done
# Nor a glTF that its text forbids, of what a .splat may hold: scales of -1, 1 and 1.
printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\xbf\0\0\x80\x3f\0\0\x80\x3f\x80\x80\x80\x80\xff\x80\x80\x80' > mirrored.splat
run 0 convert mirrored.splat -o mirrored.ply
for ending in glb gltf; do
  run 3 convert mirrored.splat -o made.$ending
  grep -q 'negative scales' err && [[ ! -e made.$ending ]] || fail "a negative scale as .$ending: $(cat err)"
done
[[ $failures -eq 0 ]]
