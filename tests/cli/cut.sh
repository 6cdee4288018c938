#!/usr/bin/env bash
# conic cut: boxes, polygons and conditions against what awk makes of the same points; layered clouds against files of
# points.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

points_in() { # FILE
  run 0 info "$1" --json info.json
  sed -nE 's/^ *"points": ([0-9]+),?$/\1/p' info.json
}

same() { # WHAT GOT WANTED
  [[ $2 == "$3" && $3 -gt 0 ]] || fail "$1: $2 points, not $3"
}

# A sheet of 40 × 40 points with a class each, far out as maps are.
awk 'BEGIN { print "x,y,z,class"; for (i = 0; i < 1600; i++) printf "%.2f,%.2f,%d,%d\n", 600000.25 + i % 40, 800000.25 + int(i / 40), i % 7, i % 3 }' > sheet.csv
printf '600005 800005\n600030 800005\n600015 800035\n\n# a hole\n600014,800010\n600018,800010\n600016,800016\n' > triangle.txt

printf '0 0 0\n1e9 0 0\n' > far.xyz
run 0 cut sheet.csv --box 600010,800010,600020.25,800030 -o box.ply
same box "$(points_in box.ply)" "$(awk -F, 'NR > 1 && $1 >= 600010 && $1 <= 600020.25 && $2 >= 800010 && $2 <= 800030' sheet.csv | wc -l)"
run 0 cut sheet.csv --box 600010,800010,2,600020,800030,4 -o heights.ply
same heights "$(points_in heights.ply)" "$(awk -F, 'NR > 1 && $1 >= 600010 && $1 <= 600020 && $2 >= 800010 && $2 <= 800030 && $3 >= 2 && $3 <= 4' sheet.csv | wc -l)"
run 0 cut sheet.csv --polygon triangle.txt --where 'class = 1' -o triangle.ply
same polygon "$(points_in triangle.ply)" "$(awk -F, '
  function is_in(x, y, a, b, c, d, e, f) { # on one side of all three sides
    return (c - a) * (y - b) - (d - b) * (x - a) > 0 && (e - c) * (y - d) - (f - d) * (x - c) > 0 && (a - e) * (y - f) - (b - f) * (x - e) > 0 }
  NR > 1 && $4 == 1 && is_in($1, $2, 600005, 800005, 600030, 800005, 600015, 800035) &&
    !is_in($1, $2, 600014, 800010, 600018, 800010, 600016, 800016)' sheet.csv | wc -l)"

# Values by name go along, or those that are asked for.
values_in() { # FILE
  "$conic" info "$1" | sed -nE 's/^values +//p' | sed 's/:.*//'
}
wanted=$(awk -F, 'NR > 1 && $1 <= 600010 && $4 == 2' sheet.csv | wc -l)
run 0 cut sheet.csv --box 600000,800000,600010,800040 -o kept.ply
run 0 cut kept.ply --where 'class = 2' -o again.ply
same "a class in a PLY" "$(points_in again.ply)" "$wanted"
run 0 cut sheet.csv --box 600000,800000,600010,800040 --keep none -o bare.ply
[[ $(values_in bare.ply) == 'x, y, z' ]] || fail "--keep none keeps $(values_in bare.ply)"
run 0 cut kept.ply -o kept.las
run 0 cut kept.las --where 'class = 2' -o again.ply
same "a class in a LAS" "$(points_in again.ply)" "$wanted"
run 0 cut kept.las -o twice.las
cmp -s kept.las twice.las || fail "a LAS that is cut as a whole is another"

# Numbers are compared as the file has them, not as floats beside an origin hold them.
awk 'BEGIN { print "x,y,z,Intensity,scalar_reflect"; for (i = 0; i < 500; i++) printf "%.3f,%.3f,%.3f,%d,0.%03d\n", 5000 + i % 100 / 10, 3000 + i / 100, 120 + i / 1000, 40000 + i, i }' > tenths.csv
for condition in 'x = 5003.7|$1 == "5003.700"' 'z > 120.1|$3 > "120.100"' 'z = 120.3|$3 == "120.300"' 'x <= 5000.2|$1 <= "5000.200"'; do
  run 0 cut tenths.csv --where "${condition%|*}" -o some.ply
  same "$condition" "$(points_in some.ply)" "$(awk -F, "NR > 1 && ${condition#*|}" tenths.csv | wc -l)"
done
run 0 cut tenths.csv --box 5000,3000,120,5009.9,3004.99,120.499 -o some.ply
same "a box to the points at its sides" "$(points_in some.ply)" 500

# Values whose names mean a field of LAS are put there; what that would spoil is also kept as it is.
run 0 cut tenths.csv --keep all -o tenths.las
run 0 cut tenths.las --where 'intensity = 40123' -o some.ply
same "an intensity by another name" "$(points_in some.ply)" 1
sed 's/,Intensity,scalar_reflect/,whole,intensity/' tenths.csv > floats.csv
run 0 cut floats.csv --keep all -o floats.las
run 0 cut floats.las --where 'exact_intensity = 0.123' -o some.ply
same "an intensity of fractions" "$(points_in some.ply)" 1
run 0 cut floats.las --where 'intensity = 8061' -o some.ply # 0.123 * 65535
same "an intensity of fractions, of 65,535" "$(points_in some.ply)" 1

run 3 cut sheet.csv --keep klass -o never.ply
run 4 cut far.xyz -o never.las

run 2 cut sheet.csv
run 2 cut sheet.csv --box 1,2,3 -o never.ply
run 2 cut sheet.csv --box 2,2,1,1 -o never.ply
run 2 cut sheet.csv --error 2 -o never.ply
run 2 cut - -o never.ply
run 3 cut sheet.csv --box 0,0,1,1 -o never.ply
printf '1 2\n3 4\n' > line.txt
run 3 cut sheet.csv --polygon line.txt -o never.ply
[[ ! -e never.ply ]] || fail "a file was written in spite of an error"

"$conic" --version | grep '^In this build:' | grep -q zstd || exit $((failures > 0))

# Of a layered cloud no more is read than meets the box, and what is cut stays where it was.
run 0 make knot -n 60k -o knot.ply
run 0 layer knot.ply -o knot.lpc
run 0 cut knot.lpc --box 0,-9,-9,9,9,9 -o half.lpc --json half.json
run 0 cut knot.lpc --box 0,-9,-9,9,9,9 -o half.ply
run 0 info half.lpc --check
same "a layered half" "$(points_in half.lpc)" "$(points_in half.ply)"
n_read=$(sed -nE 's/^ *"points_in": ([0-9]+),?$/\1/p' half.json)
[[ $n_read -lt 60000 && $n_read -ge $(points_in half.ply) ]] || fail "all of it was read: $n_read"
run 0 cut knot.lpc --error 0.2 -o coarse.ply
[[ $(points_in coarse.ply) -lt 40000 ]] || fail "--error reads all"

# What reads from a web server ends by --deadline, and writes nothing that is not whole; --timeout gives a server up.
if command -v python3 > /dev/null; then
  python3 "$1/tests/cli/slow_server.py" "$PWD" 60000 > slow.port &
  trap 'kill '$! EXIT
  for _ in {1..100}; do [[ -s slow.port ]] || sleep 0.05; done
  url=http://127.0.0.1:$(cat slow.port)/knot.lpc
  begun=$(date +%s)
  for command in cut layer merge prepare csg; do
    inputs=("$url")
    case $command in merge) inputs+=(knot.lpc) ;; csg) inputs+=(knot.ply --union) ;; esac
    ending=ply
    case $command in layer | merge) ending=lpc ;; esac
    run 4 "$command" "${inputs[@]}" --deadline 0.2 -o never.$ending
    [[ ! -e never.$ending ]] || fail "$command: a part of it was written"
  done
  run 4 cut "$url" --deadline 2.5 -o never.ply # it comes in six seconds
  [[ $(($(date +%s) - begun)) -le 10 && ! -e never.ply ]] || fail "a deadline was not kept"
  kill $!
  trap - EXIT
  run 0 cut knot.lpc --box 0,-9,-9,9,9,9 --deadline 1 --timeout 1 -o again.ply
  [[ $(grep -c 'has no effect: it acts on URLs' err) -eq 2 ]] || fail "of a file: $(cat err)"
  cmp -s half.ply again.ply || fail "a deadline changed a file"
fi

# Of a layered cloud values go along, too; merge and --append want the same of all.
run 0 layer sheet.csv -o sheet.lpc --keep class
run 0 cut sheet.lpc --where 'x < 600020' -o west.lpc
run 0 cut sheet.lpc --where 'x >= 600020' -o east.lpc
run 0 merge west.lpc east.lpc -o both.lpc
run 0 layer kept.ply --append -o east.lpc
run 0 cut both.lpc --where 'class = 2' -o again.ply
same "a class of what was merged" "$(points_in again.ply)" "$(awk -F, 'NR > 1 && $4 == 2' sheet.csv | wc -l)"
run 0 cut east.lpc --where 'class = 2' --keep class -o again.ply
same "a class of what was added" "$(points_in again.ply)" \
  $((wanted + $(awk -F, 'NR > 1 && $1 >= 600020 && $4 == 2' sheet.csv | wc -l)))
run 0 cut sheet.lpc --keep none -o bare.lpc
run 3 merge west.lpc bare.lpc -o never.lpc
grep -q "^conic: error: bare.lpc: .*west.lpc: 'class' (double) is in one alone$" err || fail "merge: $(cat err)"
run 3 merge bare.lpc west.lpc -o never.lpc
run 3 layer bare.ply --append -o east.lpc
run 3 cut sheet.lpc --keep klass -o never.ply
[[ ! -e never.lpc && ! -e never.ply && ! -e never.las ]] || fail "a file was written in spite of an error"
[[ $failures -eq 0 ]]
