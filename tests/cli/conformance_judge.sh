#!/usr/bin/env bash
# conic judge --suite: whose pictures are right, which planted faults are wrong at which levels, and what becomes of
# pictures and suites that cannot be used.
set -uo pipefail

source "$1/tests/support/program.bash"
examples=$1/examples/conformance

run 0 conformance suite --profile gsplat-1.6 --level 6
# judged EXIT_CODE PICTURES ARGUMENTS …
judged() {
  run "$1" judge --suite suite --pictures "${@:2}"
}

CONIC=$conic "$examples/run-conic" suite own || fail "run-conic"
judged 0 own --json own.json --junit own.xml
grep -q '^right: 44 of 44 cases$' out || fail "conic's own pictures: $(cat out)"
[[ $(wc -w < err) -eq 0 ]] || fail "notes: $(cat err)"
grep -q '"verdict": "right"' own.json || fail "the JSON of what is right"

# A renderer that shares nothing with conic, and the levels at which each fault of it shows.
numpy=
for candidate in python3 /usr/bin/python3; do
  "$candidate" -c 'import numpy' 2> /dev/null && numpy=$candidate && break
done
# shows LEVELS FROM TO: with the text changed, cases of these levels are wrong, and no others.
shows() {
  rm -rf fault
  awk -v from="$2" -v to="$3" '{
    i = index($0, from)
    if (i) { n++; $0 = substr($0, 1, i - 1) to substr($0, i + length(from)) }
    print
  } END { exit n == 0 }' "$examples/numpy-renderer.py" > fault.py || fail "no \"$2\" in the renderer"
  "$numpy" fault.py suite fault || fail "$2: the renderer ends"
  run 1 judge --suite suite --pictures fault --level 2 --json fault.json
  local found
  found=$("$numpy" -c 'import json
print(*[case["name"][:-11] for case in json.load(open("fault.json"))["cases"] if case["outcome"] == "wrong"])')
  [[ $found == "$1" ]] || fail "$2 -> $3: wrong are $found"
}
if [[ -n $numpy ]]; then
  "$numpy" "$examples/numpy-renderer.py" suite numpy 5 || fail "the numpy renderer ends"
  judged 0 numpy
  grep -q '^right: 44 of 44 cases$' out || fail "the numpy renderer: $(cat out)"
  shows 'L1-solid' 'F(0.99)' 'F(0.999)'
  shows 'L1-solid L1-band-1 L2-rolled L2-upside-down' 'np.maximum(np.stack(channels, 1), 0.0)' 'np.stack(channels, 1)'
  shows 'L1-harmonics L2-off-center L2-background L1-band-1 L1-band-2 L1-band-3 L2-rolled L2-upside-down' '{c * n_rest + k}' '{3 * k + c}'
  shows 'L2-overlap L2-faint L2-off-center L2-background L1-point L2-most L2-bright L2-rolled L2-upside-down L2-one-pixel L2-column L2-two-tiles L2-zoomed L2-wide L2-cropped' \
    'np.argsort(z.astype(F), kind="stable")' 'range(len(z))'
  shows 'L2-overlap L2-most L2-column L2-two-tiles L2-wide L2-cropped' 'np.argsort(z' 'np.argsort((p * p).sum(1)'
  shows 'L2-off-center' '-fy * slope_y' '-fx * slope_y'
  shows 'L2-background L1-empty' 'T[..., None] * np' '0 * T[..., None] * np'
  shows 'L2-faint' 'F(1e-4)' 'F(-1)'
else
  echo "not drawn by the numpy renderer: python3-numpy is not installed"
fi

# Pictures of other kinds, missing ones, ones that are too many, of another size, cut, and with NaN.
mkdir some
ball=some/L1-ball-gsplat-1.6
run 0 render suite/scenes/ball.ply --camera suite/cameras/ball.json --profile gsplat-1.6 --aov rgba -o $ball.png
touch some/L9-nothing.png
judged 1 some --json some.json
grep -q 'no case has the name of L9-nothing.png' err || fail "no note on what is no case's: $(cat err)"
grep -A2 '"total"' some.json | grep -q '"cases": 44' || fail "not all cases are counted"
grep -q '"missing": 43' some.json || fail "not 43 are missing: $(head -c 400 some.json)"
judged 1 some --level 1
grep -q '^ *1 *14 *1 *0 *13 ' out || fail "of level 1 not one is right: $(cat out)"
rm $ball.png
# wrong MESSAGE: the ball is wrong, for that reason.
wrong() {
  judged 1 some --level 1 --junit some.xml
  grep -q "^wrong    L1-ball-gsplat-1.6: $1" out || fail "no \"$1\" in: $(cat out err)"
  grep -q '<failure type="wrong"' some.xml || fail "JUnit's XML knows nothing of it"
  if [[ -n $numpy ]]; then
    "$numpy" -c 'import xml.etree.ElementTree as xml
found = xml.parse("some.xml").getroot()
assert found.get("tests") == found.get("failures") == "14", found.attrib
assert len(found.findall("testsuite/testcase/failure")) == 14' || fail "JUnit's XML is not as it should be"
  fi
}
run 0 render suite/scenes/ball.ply --camera suite/cameras/ball.json --profile gsplat-1.6 --size 37x20 -o $ball.pfm
wrong 'the picture has 37 x 20 pixels, and not 36 x 20'
head -c 100 own/L1-ball-gsplat-1.6.pfm > $ball.pfm
wrong 'its picture cannot be read'
printf 'PF\n36 20\n-1\n' > $ball.pfm
for _ in {1..2160}; do printf '\0\0\300\177'; done >> $ball.pfm
wrong 'projection: 720 of 720 pixels are wrong; at 0,0 R is nan'
judged 0 own --level 1 --max-wrong 1
cp own/L2-overlap-gsplat-1.6.pfm own/L2-faint-gsplat-1.6.pfm
judged 1 own --level 2
grep -q 'to see why: conic judge suite/scenes/faint.ply --camera suite/cameras/faint.json' out || fail "no way on"
eval "run 1 $(sed -n 's/^to see why: conic //p' out)"
judged 0 own --level 2 --max-wrong 720

# Suites that are not what their manifest says, and manifests that are none.
judged 3 own --profile khr-2026
judged 3 nowhere
run 2 judge --suite suite
run 2 judge --pictures own
run 2 judge --suite suite --pictures own scene.ply
run 2 judge --suite suite --pictures own --profile gsplat
run 3 judge --suite own --pictures own
cp suite/manifest.json sound.json
# spoils SED: with the manifest changed, the suite is refused with one line.
spoils() {
  sed "$1" sound.json > suite/manifest.json
  cmp -s sound.json suite/manifest.json && fail "$1 changes nothing"
  judged 3 own
  [[ $(grep -c '^conic: error: suite/' err) -eq 1 && $(wc -l < err) -eq 1 ]] || fail "$1: $(cat err)"
}
spoils 's/conic-conformance/conic/'
spoils 's/"version": 1,/"version": 2,/'
spoils 's/"width": 36/"width": 0/'
spoils 's/"width": 36/"width": 35/'
spoils 's|"expected/L1|"expected/../expected/L1|'
spoils 's|"expected/L1|"/expected/L1|'
spoils 's|"name": "L1-ball-gsplat-1.6"|"name": "../own/x"|'
spoils 's/"scene": "ball"/"scene": "bal"/'
spoils 's/"sha256": "[0-9a-f]*"/"sha256": "'"$(printf '0%.0s' {1..64})"'"/'
spoils 's/"cases": \[/"case": [/'
spoils '100,$d'
cp sound.json suite/manifest.json
printf x >> suite/expected/L2-faint-gsplat-1.6.npy
judged 3 own
grep -q 'L2-faint-gsplat-1.6.npy: it is not the file that the suite.s manifest lists' err || fail "hash: $(cat err)"

[[ $failures -eq 0 ]]
