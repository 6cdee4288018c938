#!/usr/bin/env bash
# conic render --cryptomatte: names of inputs and clusters, coverages that add up to alpha, and what is refused.
set -uo pipefail

source "$1/tests/support/program.bash"
if ! "$conic" --version | grep -qE '^In this build:.*OpenEXR'; then
  echo "skipped: this build is without OpenEXR"
  exit 77
fi
run 0 make knot -n 3000 -o knot.ply
run 0 make sphere -n 2000 -o 'a"b.c.ply'
mkdir folder
run 0 make cube -n 500 -o folder/knot.ply
cat > mesh.obj << 'END'
v -2 -1 0.1
v 2 -1 0
v 0 2 0
v 0 0 1
f 1 2 3
f 1 2 4
END
inputs=(knot.ply 'a"b.c.ply' folder/knot.ply mesh.obj)
picture="--size 64x48 --as auto"

# Wrong usage
run 2 render knot.ply $picture --cryptomatte -o a.pfm
grep -q 'cryptomatte goes into an .exr' err || fail "$(cat err)"
run 2 render knot.ply $picture --cryptomatte -o a.exr --compression pxr24
run 2 render knot.ply $picture --aov CryptoObject00 -o a.exr
[[ ! -e a.exr && ! -e a.pfm ]] || fail "written in spite of wrong usage"
if "$conic" --version | grep -qE '^In this build:.*zstd'; then
  run 0 layer knot.ply -o knot.lpc
  run 2 render knot.lpc --size 64x48 --cryptomatte -o a.exr
  grep -q 'not a cloud in levels' err || fail "$(cat err)"
fi

# Nothing else of the picture changes; an image beside it has none
run 0 render "${inputs[@]}" $picture --samples 3 -o plain.exr --json plain.json
run 0 render "${inputs[@]}" $picture --samples 3 --cryptomatte -o a.exr -o a.pfm --json a.json
for plane in rgba Z; do
  [[ $(grep -o "\"$plane\": \"[0-9a-f]*\"" a.json) == $(grep -o "\"$plane\": \"[0-9a-f]*\"" plain.json) ]] ||
    fail "$plane is another one"
done
run 0 render "${inputs[@]}" $picture --samples 3 --cryptomatte -o b.exr --threads 1 --tile 8
cmp -s a.exr b.exr || fail "threads or tiles change mattes"
run 0 info a.exr
grep -q '^planes *rgba, Z, CryptoObject00, CryptoObject01, CryptoObject02$' out || fail "$(cat out)"
grep -qaF '{"knot":"cdba143b","a\"b.c":"' a.exr || fail "no manifest with the first names"
grep -qaF ',"folder/knot.ply":"' a.exr || fail "two files of a name have one matte"
grep -qaE ',"mesh":"[0-9a-f]{8}"\}' a.exr || fail "no manifest with the last name"
grep -qa "cryptomatte/3ae39a5/name" a.exr || fail "no name of the layers"

# A hybrid's clusters
run 0 render mesh.obj --as hybrid --size 64x48 --cryptomatte -o h.exr
grep -qaE '\{"mesh/[0-9]+":"[0-9a-f]{8}"' h.exr || fail "no manifest of clusters"
run 0 render knot.ply $picture --method patch --cryptomatte -o p.exr

# Gaussians and surfaces, which share the light; what is held out has no name
run 0 make gaussians -n 300 -o "g.ply"
gaussians=(g.ply knot.ply mesh.obj --holdout mesh.obj --profile gsplat-1.6 --size 48x40 --as auto)
run 0 render "${gaussians[@]}" --cryptomatte --samples 2 -o g.exr
grep -qaE '\{"g":"[0-9a-f]{8}","knot":"cdba143b"\}' g.exr || fail "not the names of Gaussians and surfaces"
# Labels that a .ply of Gaussians has, as training writes them; other inputs keep their names
python3 - g.ply << 'END'
import sys
head, end, body = open(sys.argv[1], "rb").read().partition(b"end_header\n")
row = len(body) // 300
rows = [body[i * row:(i + 1) * row] + bytes([7 * (i % 3)]) for i in range(300)]
open("labels.ply", "wb").write(head + b"property uchar label\n" + end + b"".join(rows))
END
run 0 render labels.ply "${gaussians[@]}" --cryptomatte --matte-by label --samples 2 -o l.exr
grep -qaE '\{"g":"[0-9a-f]{8}","knot":"cdba143b","labels/0":"[0-9a-f]{8}","labels/7":"[0-9a-f]{8}","labels/14":"' l.exr ||
  fail "not the names of labels: $(grep -ao '{"[^}]*}' l.exr)"
run 0 render --again l.exr -o again.exr
cmp -s l.exr again.exr || fail "drawn again it has other mattes"
run 2 render "${gaussians[@]}" --matte-by label -o n.exr
grep -q 'it needs --aov cryptomatte' err || fail "$(cat err)"
run 3 render "${gaussians[@]}" --cryptomatte --matte-by label -o n.exr
grep -q 'no scene has the property' err || fail "$(cat err)"
run 2 render knot.ply $picture --cryptomatte --matte-by label -o n.exr

run 0 render g.ply knot.ply --profile surface --size 48x40 --cryptomatte -o s.exr

# Each frame has its own
run 0 render "${inputs[@]}" $picture --cryptomatte -o t.exr --turntable 2
cmp -s t.0001.exr t.0002.exr && fail "the frames of a turntable are the same"

if ! command -v oiiotool > /dev/null; then
  echo "skipped: sums of coverages, as oiiotool is missing"
  [[ $failures -eq 0 ]]
  exit
fi
# sum_is_alpha FILE: what things cover is what is covered
sum_is_alpha() {
  local coverages
  coverages=$(printf 'CryptoObject0%d.G,CryptoObject0%d.A,' 0 0 1 1 2 2)
  oiiotool "$1" --ch "${coverages%,}" --chsum:weight=1,1,1,1,1,1 "$1" --ch A --absdiff --printstats > stats
  grep -qE 'Stats Max: 0\.000000' stats || fail "coverages of $1 are not alpha: $(grep Max: stats)"
}
sum_is_alpha a.exr
oiiotool a.exr --ch CryptoObject00.A --printstats | grep -qE 'Max: 0\.[1-9]' || fail "no edge between two things"
sum_is_alpha t.0002.exr
sum_is_alpha h.exr
sum_is_alpha p.exr
sum_is_alpha g.exr
sum_is_alpha l.exr
run 0 render "${inputs[@]}" --size 300x256 --zoom 3 --as auto --samples 16 --cryptomatte -o bands.exr # two bands of samples
sum_is_alpha bands.exr
[[ $failures -eq 0 ]]
