#!/usr/bin/env bash
# What the program makes of files by their kind: `info` names it, and surveys (LAS) have their heights in z.
set -uo pipefail

conic=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

put() { # OFFSET, BYTES as of printf
  printf "$2" | dd of=a.las bs=1 seek="$1" conv=notrunc status=none
}
# LAS 1.2: six points of format 0, 10 units long in z, in hundredths (0x3f847ae147ae147b).
head -c $((227 + 6 * 20)) /dev/zero > a.las
put 0 LASF
put 24 '\x01\x02'
put 94 '\xe3\x00\xe3'  # 227 bytes of header, and then the points
put 105 '\x14\x00\x06' # 20 bytes a point, 6 points
for axis in 0 1 2; do
  put $((131 + 8 * axis)) '\x7b\x14\xae\x47\xe1\x7a\x84\x3f'
done
for i in 0 1 2 3 4 5; do
  put $((227 + 20 * i)) "\\x$((i % 2))0\\x00\\x00\\x00\\x$((i / 2 % 2))0"
  put $((227 + 20 * i + 8)) "\\x$(printf '%02x' $((i * 40)))\\x01"
done
printf '0 0 0\n1 2 3\n-5 4 7\n' > a.txt
printf 'FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA ascii\n0 0 0\n1 2 3\n' > a.pcd
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > a.obj
"$conic" make sphere -n 100 -o a.ply || fail "make"

for name in las:6 pcd:2 txt:3 obj:3 ply:100; do
  file=a.${name%:*}
  kind=${file#a.}
  [[ $kind != txt ]] || kind=xyz
  "$conic" info $file --check --json - > out || fail "info $file"
  grep -q "\"kind\": \"$kind\"" out || fail "$file is not $kind: $(grep kind out)"
  grep -q "\"points\": ${name#*:}," out || fail "$file: $(grep points out)"
  grep -q '"sound": true' out || fail "$file is not sound"
  "$conic" info - < $file | grep -q "^kind  *$kind$" || fail "$file by way of standard input is not $kind"
  cat $file | "$conic" info - | grep -q "^points  *${name#*:}$" || fail "$file by way of a pipe"
done

draw() { # OUTPUT, ARGUMENTS …
  "$conic" render --plain "${@:2}" --size 40x40 -o "$1" || fail "render ${*:2}"
}
same() {
  "$conic" diff "$1" "$2" > out || fail "$1 and $2 differ: $(cat out)"
}
different() {
  "$conic" diff "$1" "$2" > /dev/null && fail "$1 and $2 are the same"
}
draw las.pfm a.las
draw las_z.pfm a.las --up z
draw las_y.pfm a.las --up y
draw two.pfm a.las a.las
draw two_z.pfm a.las a.las --up z
draw mixed.pfm a.las a.ply
draw mixed_y.pfm a.las a.ply --up y
draw text.pfm a.txt
draw text_y.pfm a.txt --up y
same las.pfm las_z.pfm
different las.pfm las_y.pfm
same two.pfm two_z.pfm
same mixed.pfm mixed_y.pfm
same text.pfm text_y.pfm

# Columns in another order than a program would guess: every command that reads points takes their names.
printf 'tree %s\n' '7;-5;4;%' '3;1;2;%' '0;0;0;%' '5;5;1;%' '6;2;2;%' '1;3;8;%' '2;7;4;%' '4;4;4;%' > b.csv
sed 's/^tree \(.*\);\(.*\);\(.*\);%$/\2 \3 \1/' b.csv > b.xyz
sed -i 's/ /;/' b.csv
"$conic" info b.csv 2> err && fail "columns that nobody knows are read"
grep -q -e '--columns' err || fail "nothing is said of --columns: $(cat err)"
draw b_csv.pfm b.csv --columns -,z,x,y
draw b_xyz.pfm b.xyz
same b_csv.pfm b_xyz.pfm
for command in 'prepare:ply' 'octree:cot' 'mls thin --count 4:ply'; do
  for file in 'b.csv --columns -,z,x,y' b.xyz; do
    # shellcheck disable=SC2086
    "$conic" ${command%:*} $file -o "${file:0:5}.${command#*:}" || fail "${command%:*} $file"
  done
  cmp b.csv.${command#*:} b.xyz.${command#*:} || fail "${command%:*} takes columns for others"
done
for wrong in x,y x,y,z,r x,y,z,x; do
  "$conic" prepare b.csv --columns $wrong -o c.ply 2> err
  [[ $? -eq 2 ]] || fail "--columns $wrong is not refused as wrong usage: $(cat err)"
done

[[ $failures -eq 0 ]]
