#!/usr/bin/env bash
# conic diff: exit codes, statistics, heat maps; and EXR files as other programs write and read them.
set -uo pipefail

source "$1/tests/support/program.bash"

# run_diff EXIT_CODE ARGUMENTS …
run_diff() {
  run "$1" diff "${@:2}"
}
has() { # PATTERN: in the output
  grep -qe "$1" out || fail "no \"$1\" in: $(head -c 600 out)"
}
# pfm NAME WIDTH HEIGHT FLOAT …: grey pixels, the bottom row first, each given as the four bytes of a big-endian float
pfm() {
  local name=$1 size="$2 $3"
  shift 3
  { printf 'Pf\n%s\n1\n' "$size"; printf '%b' "$(printf '\\x%s' $(echo "$@" | tr -d ' ' | sed 's/../& /g'))"; } > "$name"
}
half=3f000000 one=3f800000 nan=7fc00000
pfm a.pfm 2 1 $half $one
pfm same.pfm 2 1 $half $one
pfm b.pfm 2 1 $half $half
pfm nan.pfm 2 1 $half $nan
pfm tall.pfm 1 2 $half $one
head -c 15 a.pfm > short.pfm

# Without limits
run_diff 0 a.pfm same.pfm
has '^identical$'
run_diff 1 a.pfm b.pfm
has '^differing pixels  1 of 2$'
run_diff 1 a.pfm tall.pfm
has '^different sizes: 2x1 and 1x2$'
run_diff 0 nan.pfm nan.pfm
run_diff 1 a.pfm b.pfm --quiet
has '^differing pixels  1 of 2$'

# With limits: the difference is 0.5, and the PSNR 10 log10(2 / (1 - 0.735358)²) = 14.556 dB
run_diff 0 a.pfm b.pfm --max-abs 0.5
run_diff 1 a.pfm b.pfm --max-abs 0.49
run_diff 0 a.pfm b.pfm --min-psnr 14.55
run_diff 1 a.pfm b.pfm --min-psnr 14.56
run_diff 1 a.pfm b.pfm --max-abs 0.5 --min-psnr 14.56
run_diff 0 a.pfm same.pfm --max-abs 0 --min-psnr 200
run_diff 1 a.pfm tall.pfm --max-abs 100 --min-psnr 0
run_diff 1 a.pfm nan.pfm --max-abs 1e30

# Statistics
run_diff 1 a.pfm b.pfm --json -
for key in identical max_abs rmse p999 psnr ssim flip over_code differing_pixels largest_hole planes; do
  grep -q "^  \"$key\": " out || fail "no $key in the statistics"
done
has '"identical": false'
has '"max_abs": 0.5,'
has '"rmse": 0.35355339059327' # of R, G and B: the root of 3 · 0.25 / 6
has '"color_channels": "RGB"'
has '"flip": 0\.[0-9]'
has '"over_code": 1,'
has '"p999": 0.5,'
has '"differing_pixels": 1,'
has '"largest_hole": 0,'
has '^    "rgba": {'
run_diff 0 a.pfm same.pfm --json a.json
cp a.json out
has '"identical": true'
has '"max_abs": 0,'
has '"psnr": null'
has '"ssim": 1,'
has '"flip": 0,'
run_diff 1 a.pfm nan.pfm --json -
has '"max_abs": null'
run_diff 1 a.pfm tall.pfm --json -
has '"max_abs": null'
has '"planes": {}'
if command -v python3 > /dev/null; then
  python3 -m json.tool < out > /dev/null || fail "the statistics are not JSON"
fi

# Heat maps
run_diff 1 a.pfm b.pfm --heatmap h.pfm
[[ $(head -c 7 h.pfm | tr '\n' ' ') == 'PF 2 1 ' ]] || fail "no heat map"
run_diff 1 a.pfm b.pfm --heatmap f.pfm --heatmap-of flip
cmp -s h.pfm f.pfm && fail "both heat maps are the same"
run_diff 1 a.pfm tall.pfm --heatmap none.pfm
[[ ! -e none.pfm ]] || fail "a heat map of different sizes"
grep -q '^conic: warning: none.pfm: ' err || fail "silent about the missing heat map"

# A file of floats that cannot say what its colours are, beside one that says display values; and beside codes. A picture
# with a background beside one without.
run 0 make gaussians -n 60 -o g.ply
has_exr=$("$conic" --version | grep -c '^In this build:.*OpenEXR')
for out in g.pfm g.png $([[ $has_exr -eq 0 ]] || echo g.exr); do
  run 0 render g.ply --size 40x40 --profile exact --background 0.2,0.3,0.4 -o "$out"
done
if [[ $has_exr -eq 1 ]]; then
  run_diff 0 g.exr g.pfm --min-psnr 90
  grep -q '^conic: warning: g.pfm: .*as display values, which g.exr has; --display a takes' err || fail "which is unsaid"
  run_diff 1 g.exr g.pfm --min-psnr 90 --display a
  [[ ! -s err ]] || fail "of a choice: $(cat err)"
fi
run_diff 1 g.png g.pfm --min-psnr 40
grep -q '^conic: warning: g.pfm: .* far nearer, by [0-9.]* dB: --display b takes them so$' err || fail "no hint: $(cat err)"
run_diff 0 g.png g.pfm --min-psnr 40 --display b
[[ ! -s err ]] || fail "of a choice: $(cat err)"
run 0 render g.ply --size 40x40 --profile exact --background none -o bare.png
run_diff 1 bare.png g.png
grep -q '^conic: warning: g.png has a background, of [0-9]* pixels that bare.png leaves transparent' err ||
  fail "silent about a background: $(cat err)"

# What fails
run_diff 2 a.pfm
run_diff 2 a.pfm b.pfm tall.pfm
run_diff 2 a.pfm b.pfm --max-abs nonsense
run_diff 2 a.pfm b.pfm --max-abs -1
run_diff 2 a.pfm b.pfm --heatmap h.pfm --heatmap-of nonsense
run_diff 2 a.pfm b.pfm --heatmap h.nosuchformat2 --json h.nosuchformat2
run_diff 3 absent.pfm a.pfm
run_diff 3 a.pfm absent.pfm
run_diff 3 short.pfm a.pfm
run_diff 4 a.pfm b.pfm --heatmap missing/h.pfm
run_diff 4 a.pfm b.pfm --json missing/h.json
[[ $(wc -l < err) -eq 1 ]] || fail "more than one line of error"

# Other programs' EXR files
if "$conic" --version | grep -q '^In this build:.*OpenEXR' && command -v oiiotool > /dev/null &&
  "$conic" --version | grep -q '^In this build:.*OpenImageIO'; then
  oiiotool --pattern fill:topleft=0.1,0.5,0.9:topright=0.7,0.2,0.3:bottomleft=0,1,0.25:bottomright=3,0.01,0.6 75x53 3 -d float -o a.exr
  for how in '-d half' '--compression piz' '--compression none' '--compression zips' '--tile 16 16' '--tile 32 8 --compression rle -d half' \
    '--ch R,G,B,A=1' '--ch B,A=1,G,R --scanline'; do
    # shellcheck disable=SC2086
    oiiotool a.exr $how -o b.exr
    run_diff 0 a.exr b.exr --max-abs 0.001 --min-psnr 60
  done
  oiiotool a.exr -d half -o b.exr
  run_diff 1 a.exr b.exr # rounded, so the test would see a difference
  oiiotool a.exr --ch R --chnames Y -o y.exr
  oiiotool a.exr --ch R,R,R --chnames R,G,B -o grey.exr
  run_diff 0 y.exr grey.exr
  oiiotool a.exr --ch R,G,B,R --chnames R,G,B,unknown -o more.exr
  run_diff 0 a.exr more.exr --verbose
  grep -q 'channel unknown is ignored' err || fail "silent about a channel"

  # Ours in their eyes
  run_diff 1 a.exr b.exr --heatmap ours.exr
  oiiotool --info -v ours.exr > out
  has '75 x   53, 4 channel, float openexr'
  has 'channel list: R, G, B, A$'
  has 'compression: "zip"'
  oiiotool ours.exr --compression none -o theirs.exr
  idiff ours.exr theirs.exr > out || fail "idiff: $(cat out)"
  run_diff 0 ours.exr theirs.exr
  run_diff 1 a.exr b.exr --heatmap ours.png
  oiiotool --info -v ours.png > out
  has '75 x   53, 4 channel, uint8 png'
  has 'oiio:ColorSpace: "sRGB"'
  run_diff 0 ours.exr ours.png --max-abs 0.005 --min-psnr 50
else
  echo "skipped: other programs' EXR files, as oiiotool or this build's OpenEXR is missing"
fi
[[ $failures -eq 0 ]]
