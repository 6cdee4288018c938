#!/usr/bin/env bash
# conic explain and render --deep: exit codes, what is answered, and that another program reads the deep image.
set -uo pipefail

source "$1/tests/support/program.bash"
has() { # PATTERN: in the output
  grep -qe "$1" out || fail "no \"$1\" in: $(head -c 1500 out)"
}
number_of() { # KEY: its first value in the output
  sed -nE "s/^ *\"$1\": ([0-9.e+-]+),?$/\1/p" out | head -n 1
}

run 0 make knot -n 3000 -o knot.ply

# A pixel: its planes, and the splats that make them; ellipses all
run 0 explain knot.ply --method conic --size 80x60 --pixel 40,30
has '^  "pixel": \[40, 30\],$'
has '^  "threshold": [0-9.]*,$'
n_visible=$(grep -c '"verdict": "visible"' out)
n_hidden=$(grep -c '"verdict": "hidden"' out)
n_outside=$(grep -c '"verdict": "outside"' out)
[[ $n_visible -gt 1 && $n_hidden -gt 1 && $n_outside -gt 1 ]] || fail "not all verdicts: $n_visible $n_hidden $n_outside"
[[ $(number_of count) == "$n_visible" ]] || fail "count is not the number of visible splats"
[[ $(number_of visible) == "$n_visible" && $(number_of hidden) == "$n_hidden" ]] || fail "wrong counts"
grep -A 12 '"verdict": "visible"' out | grep "\"splat\": $(number_of id),$" > seen || fail "the id is not visible"
if command -v python3 > /dev/null; then
  python3 - out << 'END' || fail "the JSON does not add up"
import json, sys
pixel = json.load(open(sys.argv[1]))
visible = [c for c in pixel["contributions"] if c["verdict"] == "visible"]
total = sum(c["weight"] for c in visible)
assert abs(total - pixel["planes"]["weight"]) < 1e-6 * total
assert abs(sum(c["share"] for c in visible) - 1) < 1e-6
for channel in range(3):
    mean = sum(c["share"] * c["color"][channel] for c in visible)
    assert abs(mean - pixel["planes"]["albedo"][channel]) < 1e-6
for c in pixel["contributions"]:
    d = [40.5 - c["center"][0], 30.5 - c["center"][1]]
    a, b, cc = c["conic"]
    q = a * d[0] ** 2 + 2 * b * d[0] * d[1] + cc * d[1] ** 2
    assert (q < 1.5 ** 2 + 1e-4) if c["verdict"] in ("visible", "hidden") else (q > 1.5 ** 2 - 1e-4)
    assert "q" not in c or abs(c["q"] - q) < 1e-4
END
fi
run 0 explain knot.ply --size 80x60 --pixel 0,0 --json p.json
[[ ! -s out ]] || fail "the answer is on standard output, though a file was named"
grep -q '"contributions": \[\]' p.json || fail "something in the empty corner"

# A splat, and all of them
run 0 explain knot.ply --method conic --size 80x60 --splat 17
has '^    "splat": 17,$'
has '"variance": \['
run 0 explain knot.ply --size 80x60 --dump-projection p.csv
[[ ! -s out && $(wc -l < p.csv) -eq 3001 ]] || fail "not a line a splat"
[[ $(awk -F, '{print NF}' p.csv | sort -u) == 18 ]] || fail "lines of different lengths"
run 0 explain knot.ply --size 80x60 --near 7 --dump-projection p.csv
grep -q ',culled,' p.csv || fail "nothing culled"
[[ $(awk -F, '{print NF}' p.csv | sort -u) == 18 ]] || fail "lines of different lengths where splats are culled"

# What fails
run 2 explain knot.ply
run 2 explain knot.ply --pixel 3
run 2 explain knot.ply --pixel 3,4,5
run 2 explain knot.ply --pixel -1,4
run 2 explain knot.ply --pixel 80,0 --size 80x60
run 2 explain knot.ply --splat 3000
run 2 explain knot.ply --pixel 1,1 --samples 2
run 2 explain --pixel 1,1
run 2 render knot.ply --deep d.png
run 2 render knot.ply --deep d.exr -o d.exr
run 2 render knot.ply --deep d.exr --samples 2
run 3 explain absent.ply --pixel 1,1
run 4 explain knot.ply --size 80x60 --dump-projection missing/p.csv
[[ $(wc -l < err) -eq 1 ]] || fail "more than one line of error"

# A deep image
if ! "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  run 4 render knot.ply --size 80x60 --deep d.exr
  echo "skipped: deep images, as this build has no OpenEXR"
  [[ $failures -eq 0 ]]
  exit
fi
run 0 render knot.ply --size 80x60 --deep d.exr --aov count -o flat.exr
[[ -s d.exr && -s flat.exr ]] || fail "not both pictures"
run 0 render knot.ply --size 40x30 --deep t.exr --turntable 2
[[ -s t.0001.exr && -s t.0002.exr && ! -e t.exr ]] || fail "not a deep image a frame"
run 4 render knot.ply --size 80x60 --deep missing/d.exr
printf 'v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n' > one.obj # triangles, too, and hybrids
run 0 render one.obj --as mesh --size 40x30 --deep t.exr
run 0 hybrid one.obj -o one.chy
run 0 render one.chy --size 40x30 --deep t.exr
run 0 render one.chy --size 40x30 --error 1 --deep t.exr --turntable 2
run 2 render one.chy --size 40x30 --deep t.exr --samples 2
if command -v oiiotool > /dev/null; then
  oiiotool --info -v --stats d.exr > out 2> err || fail "oiiotool cannot read it: $(cat err)"
  has '80 x   60, 7 channel, deep float/float/float/float/float/uint/float openexr'
  has 'channel list: R (float), G (float), B (float), A (float), Z (float), id (uint), weight (float)'
  if "$conic" --version | grep -q '^In this build:.*zlib'; then
    has 'compression: "zips"'
  fi
  has 'conicMethod: "auto"'
  most=$(sed -nE 's/.*openexr:maxSamplesPerPixel: ([0-9]+).*/\1/p' out)
  has "Max deep samples in any pixel : $most"
  # Flattened, it is the flat picture, which need not be written
  run 0 render knot.ply --size 80x60 -o flat.exr --aov rgba
  oiiotool d.exr --flatten --ch R,G,B,A -o flattened.exr
  run 0 diff flat.exr flattened.exr --max-abs 1e-5
else
  echo "skipped: another program's eyes, as there is no oiiotool"
fi

# Of Gaussians among surfaces: what is laid over each other is the picture, where the order is that of depth
run 0 make gaussians -n 3000 -o scene.ply
printf 'v -9 -9 0\nv 9 -9 0\nv 9 9 0.5\nv -9 9 0.5\nf 1 2 3 4\n' > wall.obj
if command -v oiiotool > /dev/null; then
  for profile in exact gsplat-1.6; do
    run 0 render scene.ply wall.obj --profile $profile --size 90x60 --deep deep.exr -o flat.exr
    oiiotool deep.exr --flatten --ch R,G,B,A -o laid.exr && oiiotool flat.exr --ch R,G,B,A -o shown.exr &&
      oiiotool --fail 2e-6 --warn 2e-6 laid.exr shown.exr --diff > out || fail "$profile: not the picture: $(cat out)"
  done
  run 0 render scene.ply --size 90x60 --deep deep.exr -o flat.exr
  oiiotool --stats deep.exr | grep -q 'Total deep samples' || fail "no deep samples"
fi
run 2 render scene.ply wall.obj --deep deep.exr --ao 4 --accumulate 2
[[ $failures -eq 0 ]]
