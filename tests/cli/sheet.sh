#!/usr/bin/env bash
# conic sheet: a length is as long on paper as the scale says, in all corners of a sheet, and far from the origin; what is
# written does not depend on memory or threads; what cannot be drawn is refused.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"
python=$(command -v python3) || {
  echo "skipped: python3 is not installed"
  exit 77
}
check=$1/tests/cli/sheet.py

# 10 m at 1:100 and 300 dpi are 1181.1 pixels. Coordinates are those of a zone of UTM.
"$python" "$check" make corners.obj 30 28 10 500000 5000000
run 0 sheet corners.obj --up z --scale 1:100 --shade none --samples 1 -o corners.tif --json corners.json
"$python" "$check" edges corners.tif corners.json 1181.1 > right || fail "10 m at 1:100"
[[ $(cat right) == 500030.00* || $(cat right) == 500029.99* ]] || fail "the right edge is at $(cat right)"
# Across 65,000 pixels; 1 m is 118.11.
"$python" "$check" make wide.obj 547 4 1 500000 5000000
run 0 sheet wide.obj --up z --scale 1:100 --shade none --samples 1 -o wide.tif --json wide.json
"$python" "$check" edges wide.tif wide.json 118.11 > right || fail "1 m across 65,000 pixels"
[[ $(cat right) == 500547.0[01]* || $(cat right) == 500546.99* ]] || fail "the right edge is at $(cat right)"

# Feet, by the unit; a pixel's width; bands of rows, and threads.
run 0 sheet corners.obj --up z --unit ft --scale 1:1000 -o feet.png --json feet.json
grep -q '"gsd": 0.277' feet.json || fail "a foot: $(grep gsd feet.json)"
run 0 sheet corners.obj --up z --gsd 0.1 --dpi 254 -o gsd.png --json gsd.json
grep -q '"scale": 1000,' gsd.json || fail "$(grep scale gsd.json)"
run 0 sheet corners.obj --up z --section 500001,5000010:500029,5000007:1 --scale 1:1000 -o slant.png
run 0 make terrain -n 4000 -o land.ply
sheet=(sheet land.ply --plan --facade 30 --section 0.1,0.2:0.8,0.7:0.02 --beyond 0.3 --scale 1:5 --dpi 90)
run 0 "${sheet[@]}" -o one.png
run 0 "${sheet[@]}" -o two.png --threads 1 --memory 1
cmp -s one.png two.png || fail "memory or threads change the sheet"
run 0 "${sheet[@]}" -o one.pdf
run 0 "${sheet[@]}" -o two.pdf --threads 1 --memory 1
cmp -s one.pdf two.pdf || fail "memory or threads change the page"
[[ $(head -c 8 one.pdf) == %PDF-1.4 && $(tail -c 6 one.pdf) == %%EOF ]] || fail "no PDF"
at=$(tail -n 2 one.pdf | head -n 1)
[[ $(tail -c +$((at + 1)) one.pdf | head -c 4) == xref ]] || fail "the table of the PDF is not at $at"

# A section cuts triangles in a strong line, and with --beyond 0 shows nothing of what is behind: not its edges, either.
for top in 5 6; do
  printf 'v %s\n' '2 -1 0' '2 1 0' '2 1 3' '2 -1 3' '1 9 0' '9 9 0' "$top.3 9 3" > behind.obj
  printf 'f %s\n' '1 2 3' '1 3 4' '5 6 7' >> behind.obj
  run 0 sheet behind.obj --up z --section 0,0:10,0 --beyond 0 --scale 1:200 -o behind$top.png
  run 0 sheet behind.obj --up z --section 0,0:10,0 --beyond 0 --scale 1:200 -o behind.pdf
  run 0 sheet behind.obj --up z --facade 0 --scale 1:200 -o front.pdf
done
cmp behind5.png behind6.png || fail "--beyond 0 shows what is behind"
grep -aq '^4\.134 w 1 J 0\.000 G$' behind.pdf || fail "no line where triangles are cut"
! grep -aq '^4\.134 w 1 J 0\.000 G$' front.pdf || fail "a facade is cut"

# Colours of values are explained, and the panels keep their places.
run 0 "${sheet[@]}" --color-by height -o high.pdf --json high.json
[[ $(grep -ac '/Subtype */Image' high.pdf) -eq $(($(grep -ac '/Subtype */Image' one.pdf) + 1)) ]] || fail "no legend"
[[ $(grep -c '"kind"' high.json) -eq 3 ]] || fail "the legend is a drawing: $(cat high.json)"

for options in "" "-o x.exr" "-o x.png --scale 0:1" "-o x.png --scale 1:10 --gsd 1" "-o x.png --facade 1,2" "-o x.png --section 1,1:1,1" \
  "-o x.png --beyond 1" "-o x.png --paper A9" "-o x.png --paper A5 --scale 2:1" "-o x.png --size 20x20" "-o x.png --north 9 --section 0,0:1,1" \
  "-o land.ply" "-o x.png --scale 1000:1"; do
  # shellcheck disable=SC2086 # several words
  run 2 sheet land.ply $options
done
run 3 sheet gone.ply -o x.png
[[ ! -e x.png ]] || fail "a sheet that was refused is there"
[[ $failures -eq 0 ]]
