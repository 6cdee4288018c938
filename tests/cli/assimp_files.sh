#!/usr/bin/env bash
# Meshes that are read through Assimp, by the program: every command takes them, from a pipe too; Assimp is loaded for
# them alone, and where it is missing the message says so.
set -uo pipefail

. "$1/tests/support/program.bash"

if ! "$conic" --version | grep -q '^In this build:.* Assimp'; then
  echo "skipped: this build is without Assimp"
  exit 77
fi

# A sphere of some faces, as OBJ, OFF and STL.
awk -v n=12 'BEGIN {
  pi = 3.14159265
  for (i = 0; i <= n; i++) for (j = 0; j < 2 * n; j++)
    printf "v %.6f %.6f %.6f\n", sin(pi * i / n) * cos(pi * j / n), cos(pi * i / n), sin(pi * i / n) * sin(pi * j / n)
  for (i = 0; i < n; i++) for (j = 0; j < 2 * n; j++) {
    a = i * 2 * n + j + 1; b = i * 2 * n + (j + 1) % (2 * n) + 1; c = a + 2 * n; d = b + 2 * n
    if (i > 0) print "f", a, b, d
    if (i < n - 1) print "f", a, d, c
  }
}' > a.obj
{
  echo OFF
  echo "$(grep -c ^v a.obj) $(grep -c ^f a.obj) 0"
  sed -n 's/^v //p' a.obj
  awk '/^f/ {print 3, $2 - 1, $3 - 1, $4 - 1}' a.obj
} > a.off
awk 'BEGIN {print "solid sphere"} /^v/ {v[++n] = $2 " " $3 " " $4}
  /^f/ {print "facet normal 0 0 1\nouter loop"; for (k = 2; k < 5; k++) print "vertex", v[$k]; print "endloop\nendfacet"}
  END {print "endsolid sphere"}' a.obj > a.stl

for kind in off stl; do
  run 0 info a.$kind --check --json -
  grep -q "\"kind\": \"$kind\"" out || fail "a.$kind is not $kind: $(grep kind out)"
  grep -q "\"triangles\": $(grep -c ^f a.obj)" out || fail "a.$kind: $(grep triangles out)"
  grep -q '"sound": true' out || fail "a.$kind is not sound"
  "$conic" info - < a.$kind | grep -q "^kind  *$kind$" || fail "a.$kind by way of standard input is not $kind"
  cat a.$kind | "$conic" info - | grep -q "^kind  *$kind$" || fail "a.$kind by way of a pipe is not $kind"
done

# A binary STL from a pipe, whose size is not known.
perl -e 'open $f, "a.obj"; while (<$f>) { push @v, [split] if s/^v //; push @f, [split] if s/^f //; }
  print "\0" x 80, pack "V", scalar @f;
  print pack "f<12v", 0, 0, 0, map({@{$v[$_ - 1]}} @$_), 0 for @f;' > b.stl
cat b.stl | "$conic" info - | grep -q '^kind  *stl$' || fail "a binary STL by way of a pipe is none"
head -c 2000 /dev/urandom > noise
cat noise | "$conic" info - > /dev/null 2>&1 && fail "noise is read"

# The picture of the OBJ, bit for bit, and up where the kind of file has it.
draw() { # FILE OUTPUT OPTIONS …
  run 0 render "$1" -o "$2" --as mesh --size 64x64 "${@:3}"
  [[ ! -s err ]] || fail "render $1: $(cat err)"
}
draw a.obj obj.pfm --up y
draw a.off off.pfm --up y
draw a.stl stl.pfm --up y
draw a.obj z.pfm --up z
draw a.stl stl_z.pfm
run 0 diff obj.pfm off.pfm
run 0 diff obj.pfm stl.pfm
run 0 diff z.pfm stl_z.pfm

# The other commands.
run 0 prepare a.stl -o stl.ply
run 0 octree a.stl -o stl.cot
run 0 hybrid a.stl -o stl.chy
run 0 mls project a.stl -o mls.ply
run 2 prepare a.obj -o b.stl
grep -q 'no .stl' err || fail "a name that promises what is not written: $(cat err)"

# What Assimp cannot read is one line, whatever it says itself.
printf 'OFF\n4 2000000000 0\n0 0 0\n' > huge.off
head -c 100 a.off > cut.off
printf 'glTF\2\0\0\0\100\0\0\0\1\0\0\0JSON{' > cut.glb
for file in cut.off huge.off cut.glb; do
  run 3 info $file
  [[ $(wc -l < err) -eq 1 && ! -s out && $(head -c $((15 + ${#file})) err) == "conic: error: $file:" ]] ||
    fail "$file: $(head -c 300 err)"
done

# Of some texts Assimp reads what there is.
awk '/^facet/ && n++ == 20 {exit} {print}' a.stl > cut.stl
run 0 info cut.stl
grep -q '^conic: warning: cut.stl: the file ends without endsolid' err || fail "cut.stl: $(cat err)"

# Loaded for such files alone.
cat > a.amf << 'END'
<?xml version="1.0"?><amf unit="meter"><object id="0"><mesh><vertices>
<vertex><coordinates><x>0</x><y>0</y><z>0</z></coordinates></vertex>
<vertex><coordinates><x>1</x><y>0</y><z>0</z></coordinates></vertex>
<vertex><coordinates><x>0</x><y>1</y><z>0</z></coordinates></vertex>
</vertices><volume><triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle></volume></mesh></object></amf>
END
loads_assimp() {
  LD_DEBUG=files LD_DEBUG_OUTPUT="$work/libraries" "$conic" info "$1" > /dev/null
  grep -qs libassimp libraries.*
  local found=$?
  rm -f libraries.*
  return $found
}
"$conic" make plane -n 10 -o plane.ply || fail "make"
loads_assimp a.amf || fail "no libassimp is loaded for a.amf, or this test does not see it"
! loads_assimp plane.ply || fail "libassimp is loaded for a PLY"
! loads_assimp a.obj || fail "libassimp is loaded for an OBJ"
! loads_assimp a.stl || fail "libassimp is loaded for an STL"

# A program without the module beside it.
mkdir alone
cp "$conic" alone/conic
alone/conic --version | grep -q '^Not in this build:.* Assimp' || fail "Assimp is said to be there where it is not"
alone/conic info a.amf > out 2> err
[[ $? -eq 4 ]] || fail "without the module: not exit code 4"
grep -q 'a.amf: cannot read amf: .*conic-assimp.so' err || fail "without the module: $(cat err)"

[[ $failures -eq 0 ]]
