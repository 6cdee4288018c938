#!/usr/bin/env bash
# conic diff of folders: which pictures belong together, the measures of each view and their means, limits a view, and
# which colours are display values. Python writes pictures and measures them by the formulas of the papers.
set -uo pipefail

source "$1/tests/support/program.bash"
helper=$1/tests/cli/diff_folders.py

has() { # PATTERN: in the output
  grep -qe "$1" out || fail "no \"$1\" in: $(head -c 900 out)"
}
lacks() {
  grep -qe "$1" out && fail "\"$1\" in: $(head -c 900 out)"
}
# flat NAME FLOAT [WIDTH]: twelve rows of one grey, as the four bytes of a big-endian float
flat() {
  local width=${3:-12} pixel
  mkdir -p "$(dirname "$1")"
  pixel=$(printf '\\x%s' ${2:0:2} ${2:2:2} ${2:4:2} ${2:6:2})
  { printf 'Pf\n%d 12\n1\n' "$width"; printf "$pixel%.0s" $(seq $((12 * width))); } > "$1"
}
half=3f000000 more=3f19999a quarter=3e800000 # 0.5, 0.6, 0.25

# By name, whatever the ending; an offset of 0.1 is 20 dB, and a mean is that of the decibels.
for name in a b.1 c10 c9; do flat "A/$name.pfm" $half; done
flat B/a.pfm $more
flat B/b.1.pfm.pfm $more
flat B/c9.PFM $quarter
flat B/c10.pfm $quarter
printf 'no picture' > B/notes.txt
mkdir B/folder.pfm
flat B/.hidden.pfm $half
run 1 diff A B --display both
has '^view  *psnr  *ssim  *padded  *flip$'
has '^a  *20\.000 '
has '^c9  *12\.041 '
has '^mean  *16\.021 '
[[ $(sed -n 's/ .*//p' out | tr '\n' ' ') == 'view a b.1 c9 c10 mean ' ]] || fail "the views are $(cat out)"
run 1 diff A B
lacks '20\.000' # linear numbers
run 0 diff A A
has '^all identical$'
run 0 diff A B --display both --min-psnr 12 --max-abs 0.26
run 1 diff A B --display both --min-psnr 13
has '^c9 .* \*$'
lacks '^a .* \*$'
has 'past a limit: 2 of 4 views'
run 1 diff A B --display both --min-ssim 0.9
run 0 diff A B --display both --min-ssim 0.7
run 1 diff A B --display both --max-flip 0.01
run 1 diff A B --display both --max-abs 0.2 --quiet
has 'past a limit: 2 of 4 views'

# Each view in JSON and CSV, and heat maps by name
run 1 diff A B --display both --json -
has '"matched_by": "name"'
has '"mean": {'
has '"name": "c10"'
has '"a": "A/c10.pfm"'
has '"pass": false'
has '"views_past_limits": 4'
has '"display_values": true'
run 1 diff A B --display both --csv t.csv --heatmap h.pfm
[[ $(wc -l < t.csv) -eq 5 && $(head -1 t.csv) == a,b,psnr,* ]] || fail "the CSV is $(cat t.csv)"
[[ $(echo h.*) == 'h.a.pfm h.b.1.pfm h.c10.pfm h.c9.pfm' ]] || fail "the heat maps are $(echo h.*)"
run 1 diff 'B/*' A
has '^only in B/\*: notes.txt$' # a pattern says which

# Pictures that have no partner are named, and are past all limits unless B may be a subset.
flat A/d.pfm $half
run 1 diff A B --display both --max-abs 1
has '^only in A: d.pfm$'
run 0 diff A B --display both --max-abs 1 --subset
run 0 diff A B --display both --max-abs 1 --subset --json -
has '"A/d.pfm"'
run 1 diff B A --display both --max-abs 1 --subset
has '^only in A: d.pfm$'

# By number, by order
for i in 1 2 11; do flat "F/new.000$i.pfm" $half; flat "G/old.$i.pfm" $half; done
flat G/old.3.pfm $quarter
run 0 diff G F --subset --max-abs 0
has 'matched by number'
run 1 diff F G --max-abs 0
has '^only in G: old.3.pfm$'
for i in 007 010 100; do flat "P/IMG_$i.pfm" $half; done
run 1 diff P F # a number's place, from 0: there is no twelfth picture
has '^matched by number: P/IMG_010.pfm is F/new.0001.pfm'
has '^only in P: IMG_007.pfm$'
has '^only in F: new.00011.pfm$'
for i in 7 8 9; do flat "Q/view$i.pfm" $half; done
run 0 diff P Q
has '^matched by order: P/IMG_007.pfm is Q/view7.pfm'
run 3 diff P Q --match name
rm Q/view7.pfm
run 3 diff P Q
grep -q '3 pictures, but 2 in Q' err || fail "$(cat err)"
run 0 diff 'F/new*.pfm' 'G/old.[12]*.pfm' --max-abs 0

# Sizes
flat S/a.pfm $half 24
flat T/a.pfm $half 12
run 3 diff S T
grep -q 'T/a.pfm: 12 × 12 pixels, but 24 × 12 in S/a.pfm' err || fail "$(cat err)"
run 3 diff S T --reduce
grep -q 'S/a.pfm: 24 × 12 pixels cannot be reduced to 12 × 12' err || fail "$(cat err)"

# What is asked for in vain
run 3 diff A B/a.pfm
run 3 diff A/a.pfm nowhere
run 3 diff A nowhere
run 2 diff A/a.pfm B/a.pfm --subset
run 3 diff A 'none*.png'
run 3 diff B/folder.pfm A
ln A/a.pfm a.json
run 2 diff A/a.pfm B/a.pfm --json a.json
run 2 diff A B --json a.json
cmp -s A/a.pfm a.json || fail "a picture was written over"
mkdir twice && cp A/a.pfm twice/a.pfm && cp A/a.pfm twice/a.tif
run 3 diff A twice
grep -q 'twice/a.pfm and twice/a.tif have one name\|twice/a.tif and twice/a.pfm have one name' err || fail "$(cat err)"

# Photographs of 8 bits against renders in floats, by the papers' formulas
if python3 -c 'import numpy' 2> /dev/null; then
  python3 "$helper" make || fail "no pictures"
  run 1 diff gt renders --display b --json -
  cp out views.json
  python3 "$helper" check views.json || fail "the measures are not those of the formulas"
  run 1 diff large renders --display b --reduce --json -
  cp out views.json
  python3 "$helper" check views.json || fail "the measures are not those of the formulas, once reduced"
else
  echo "skipped: the papers' formulas, as numpy is not installed"
fi
[[ $failures -eq 0 ]]
