#!/usr/bin/env bash
# What conic render writes: pictures to standard output, planes that go into files of their own, and how an EXR is kept.
set -uo pipefail

source "$1/tests/support/program.bash"
in_build() { # NAME …: one of these libraries
  "$conic" --version | grep -qE "^In this build:.*($1)"
}
run 0 make knot -n 600 -o knot.ply
picture="--plain --size 40x30"

# Standard output is like a file
for format in pfm png exr tif; do
  case $format in
    png) in_build 'libpng|OpenImageIO' || continue ;;
    exr) in_build OpenEXR || continue ;;
    tif) in_build OpenImageIO || continue ;;
  esac
  run 0 render knot.ply $picture -o a.$format
  run 0 render knot.ply $picture -o $format:-
  cmp -s out a.$format || fail "standard output as $format is not the file"
  "$conic" render knot.ply $picture -o $format:- | cat > piped
  cmp -s piped a.$format || fail "a pipe as $format is not the file"
  run 0 render knot.ply $picture -o $format:bare
  cmp -s bare a.$format || fail "a name without an ending, as $format, is not the file"
done
if in_build 'libpng|OpenImageIO'; then
  run 0 render knot.ply $picture -o turn.png --turntable 2
  run 0 render knot.ply $picture -o - --turntable 2
  cmp -s out <(cat turn.0001.png turn.0002.png) || fail "a turntable's frames do not follow one another"
fi
run 2 render knot.ply $picture -o - -o -
run 2 render knot.ply $picture -o - --json -
run 2 render knot.ply $picture -o - --overdraw -
run 2 render knot.ply $picture -o bare
if command -v script > /dev/null; then
  script -qec "$conic render knot.ply $picture -o -" /dev/null > out < /dev/null
  [[ $? -eq 2 ]] && grep -q terminal out || fail "a picture on the terminal"
fi

# A file a plane, where a file holds one
rm -f s.*
run 0 render knot.ply $picture --aov rgba,Z,N,albedo,weight,count,id -o s.pfm
[[ $(echo s.*) == 's.N.pfm s.Z.pfm s.albedo.pfm s.count.pfm s.id.pfm s.pfm s.weight.pfm' ]] || fail "the set is $(echo s.*)"
cmp -s s.pfm a.pfm || fail "rgba of the set is another picture"
for plane in Z N id; do
  run 0 render knot.ply $picture --aov $plane -o alone.pfm
  cmp -s alone.pfm s.$plane.pfm || fail "$plane alone is another file than in the set"
done
[[ ! -e alone.Z.pfm ]] || fail "a set of one plane"
[[ $(head -c 2 s.N.pfm)$(head -c 2 s.id.pfm) == PFPf ]] || fail "not N in colour and id in grey"
run 2 render knot.ply $picture --aov rgba,Z -o pfm:-
run 2 render knot.ply $picture --aov cluster -o s.pfm
rm -f s.*
run 0 render knot.ply $picture -o s.pfm # without being asked, no set
[[ $(echo s.*) == s.pfm ]] || fail "without --aov there is $(echo s.*)"

# What nothing holds is not lost in silence
if in_build 'libpng|OpenImageIO'; then
  rm -f s.*
  run 2 render knot.ply $picture --aov rgba,id -o s.png
  grep -q 'no output holds the plane id' err || fail "$(cat err)"
  run 0 render knot.ply $picture --aov rgba,id -o s.png --json s.json # which has its hash
  [[ $(echo s.*) == 's.json s.png' ]] || fail "$(echo s.*)"
  run 0 render knot.ply $picture --aov rgba,N,albedo,id -o s.png -o s.pfm
  [[ -e s.id.pfm && -e s.N.pfm && ! -e s.N.png ]] || fail "not the set of the better kind alone: $(echo s.*)"
  rm -f s.*
  run 0 render knot.ply $picture --aov N,albedo -o s.png
  [[ $(echo s.*) == 's.N.png s.albedo.png' ]] || fail "$(echo s.*)"
fi
if in_build OpenEXR; then
  rm -f s.*
  run 0 render knot.ply $picture --aov all -o s.exr -o s.pfm
  [[ $(echo s.*) == 's.exr s.pfm' ]] || fail "a set beside an EXR: $(echo s.*)"
fi

# How an EXR is kept
run 2 render knot.ply $picture -o a.exr --compression dwaa
run 2 render knot.ply $picture -o a.exr --exr double
if ! in_build OpenEXR || ! command -v oiiotool > /dev/null; then
  echo "skipped: EXR in another program's eyes, as OpenEXR or oiiotool is missing"
  [[ $failures -eq 0 ]]
  exit
fi
run 0 render knot.ply $picture --aov rgba,Z,N,id -o a.exr
for compression in none rle zip zips piz; do
  run 0 render knot.ply $picture --aov rgba,Z,N,id -o b.exr --compression $compression
  oiiotool --info -v b.exr > info
  grep -q "compression: \"$compression\"" info || fail "not compressed as $compression"
  run 0 diff a.exr b.exr
done
run 0 render knot.ply $picture --aov rgba,Z,N,id -o b.exr --exr half
oiiotool --info -v b.exr > info
grep -q 'R (half), G (half), B (half), A (half), Z (float), id (uint), N.X (half), N.Y (half), N.Z (half)' info ||
  fail "$(grep 'channel list' info)"
grep -q 'chromaticities: 0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329' info || fail "no chromaticities"
grep -q 'worldToCamera: .*, 1$' info || fail "no worldToCamera with its last column"
for compression in dwaa dwab; do # which the library may leave to OpenImageIO
  in_build OpenImageIO || continue
  oiiotool a.exr --ch R,G,B,A,Z,N.X,N.Y,N.Z --compression $compression -o b.exr
  run 0 info b.exr
  grep -q '^planes *rgba, Z, N$' out || fail "of $compression: $(cat out)"
  run 0 render knot.ply $picture --aov rgba,Z,N -o c.exr
  run 0 diff c.exr b.exr --max-abs 0.05
  run 0 render knot.ply $picture --aov id -o c.exr
  oiiotool --native c.exr --compression $compression -o b.exr
  run 0 diff c.exr b.exr
done
[[ $failures -eq 0 ]]
