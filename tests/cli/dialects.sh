#!/usr/bin/env bash
# The same small things as the programs of others write them: a square of one colour comes out in that colour, whatever
# the file; columns of text are told by their values; what is cut, not measured or names what there is not is left out,
# and said.
set -uo pipefail

source "$1/tests/support/program.bash"

# color FILE R G B: the middle of the square, as linear values of these codes
color() {
  local file=$1 # and options
  run_as_typed 0 render $file -o a.pfm --size 9x9 --shade none --samples 1 --background 0,0,0 --up y --azimuth 0 \
    --elevation 0 --projection orthographic -q
  perl -e 'local $/; open F, "<", "a.pfm"; my @v = unpack "f<*", substr(<F>, -9 * 9 * 12);
    for (0 .. 2) { my $s = $ARGV[$_] / 255; my $l = $s <= 0.04045 ? $s / 12.92 : (($s + 0.055) / 1.055) ** 2.4;
      exit 1 if abs($v[3 * 40 + $_] - $l) > 0.02 }' "${@:2}" ||
    fail "$file: not of the colour ${*:2}"
}
facts() { # FILE PATTERN …: what conic info says
  run 0 info "$1"
  for pattern in "${@:2}"; do
    grep -qE -- "$pattern" out || fail "$1: no $pattern in $(cat out)"
  done
}
warned() { # PATTERN
  [[ $(grep -c '^conic: warning: ' err) -eq 1 ]] && grep -qE -- "$1" err || fail "no warning of $1: $(cat err)"
}

# Colours of vertices and of faces
places=('0 0 0' '1 0 0' '1 1 0' '0 1 0')
ply_header() { # TYPE OF VERTICES' COLOURS TYPE OF FACES'
  printf 'ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n'
  [[ -z $1 ]] || printf 'property %s red\nproperty %s green\nproperty %s blue\n' "$1" "$1" "$1"
  printf 'element face 1\nproperty list uchar int vertex_indices\n'
  [[ -z $2 ]] || printf 'property %s red\nproperty %s green\nproperty %s blue\n' "$2" "$2" "$2"
  printf 'end_header\n'
}
vertices() { # BEHIND EACH
  for place in "${places[@]}"; do echo "$place $1"; done
}
{ ply_header uchar ''; vertices '100 150 200'; echo 4 0 1 2 3; } > bytes.ply
{ ply_header ushort ''; vertices '100 150 200'; echo 4 0 1 2 3; } > bytes_in_shorts.ply
{ ply_header ushort ''; vertices '25700 38550 51400'; echo 4 0 1 2 3; } > shorts.ply
{ ply_header '' uchar; vertices ''; echo 4 0 1 2 3 100 150 200; } > faces.ply
{ ply_header uchar uchar; vertices '100 150 200'; echo 4 0 1 2 3 9 9 9; } > both.ply
{ echo COFF; echo 4 1 0; vertices '100 150 200 255'; echo 4 0 1 2 3; } > codes.off
{ echo COFF; echo 4 1 0; vertices '0.39216 0.58824 0.78431 1'; echo 4 0 1 2 3; } > fractions.off
{ echo 'OFF 4 1 0 # by hand'; vertices '100 150 200'; echo 4 0 1 2 3; } > unsaid.off
{ echo OFF; echo 4 1 0; vertices ''; echo 4 0 1 2 3 100 150 200; } > faces.off
{ echo OFF; echo 4 1 0; vertices ''; echo 4 0 1 2 3 0.39216 0.58824 0.78431; } > fractions_of_faces.off
shares='0.39216 0.58824 0.78431'
linear='0.12744 0.30499 0.57758'
for type in float double; do
  { ply_header $type ''; vertices "$shares"; echo 4 0 1 2 3; } > $type.ply
  { ply_header $type ''; vertices '100 150 200'; echo 4 0 1 2 3; } > codes_in_$type.ply
  { ply_header '' $type; vertices ''; echo "4 0 1 2 3 $shares"; } > $type.of.faces.ply
  { ply_header $type ''; vertices "$linear"; echo 4 0 1 2 3; } > linear.$type.ply
done
{ ply_header '' ushort; vertices ''; echo 4 0 1 2 3 100 150 200; } > bytes_in_shorts.of.faces.ply
{ ply_header '' ushort; vertices ''; echo 4 0 1 2 3 25700 38550 51400; } > shorts.of.faces.ply
sed 's/^element vertex/comment conic 0.6.0\n&/' linear.float.ply > own.ply
{ for place in "${places[@]}"; do echo "v $place $shares"; done; echo f 1 2 3 4; } > shares.obj
{ for place in "${places[@]}"; do echo "v $place 100 150 200"; done; echo f 1 2 3 4; } > codes.obj
{ for place in "${places[@]}"; do echo "v $place $linear"; done; echo f 1 2 3 4; } > linear.obj
for file in *float.ply *double.ply *.of.faces.ply own.ply shares.obj codes.obj; do
  [[ $file = linear* ]] || color $file 100 150 200
done
for file in linear.float.ply linear.double.ply linear.obj; do
  color "$file --colors linear" 100 150 200
  run 0 prepare $file --colors linear -o own.ply
  color own.ply 100 150 200
done
run 0 prepare linear.float.ply -o own.ply
color own.ply 32 78 147
run 2 render shorts.ply --colors linear -o a.pfm
grep -q 'acts on colours that are fractions of 1' err || fail "--colors on codes: $(cat err)"
for file in bytes_in_shorts bytes; do # what can be read once only
  "$conic" layer - -o $file.lpc < $file.ply 2> err || fail "$(cat err)"
done
cmp -s bytes_in_shorts.lpc bytes.lpc || fail 'shorts are other colours from a pipe'
for file in bytes.ply bytes_in_shorts.ply shorts.ply faces.ply both.ply codes.off fractions.off unsaid.off faces.off \
  fractions_of_faces.off; do
  color $file 100 150 200
  facts $file '^points +4$' '^triangles +2$'
done
run 0 layer bytes_in_shorts.ply -o a.lpc # where points are read some at a time
run 0 layer bytes.ply -o b.lpc
cmp -s a.lpc b.lpc || fail "shorts are other colours in a layered cloud"
run 0 prepare faces.ply -o prepared.ply
facts prepared.ply '^fields .*colors'

# STL: both makers' colours, bytes behind the end, upper case, a file that is cut
stl() { # HEADER BITS [BITS BEHIND]
  perl -e 'my ($head, $bits) = @ARGV; $head =~ s/%/\xff/g; print pack("a80V", $head, 2);
    for ([[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]) {
      print pack "f<12v", 0, 0, 0, map({@$_} @$_), $bits }' "$1" "$2"
}
stl 'COLOR=%%%%,MATERIAL=' $((12 | 18 << 5 | 24 << 10)) > magics.stl
stl 'by VisCAM' $((1 << 15 | 12 << 10 | 18 << 5 | 24)) > viscam.stl
color magics.stl 99 148 197
color viscam.stl 99 148 197
{ stl plain 0; printf 'end'; } > behind.stl
color behind.stl 255 255 255
facts behind.stl '^points +4$' '^triangles +2$'
stl plain 0 | head -c 150 > cut.stl
facts cut.stl '^triangles +1$'
warned 'ends within face 1 of 2'
printf 'SOLID A NAME\n FACET NORMAL 0 0 1\n  OUTER LOOP\n   VERTEX 0 0 0\n   VERTEX 1 0 0\n   VERTEX 0 1 0\n  ENDLOOP\n ENDFACET\nENDSOLID\n' > upper.stl
facts upper.stl '^points +3$' '^triangles +1$'
[[ ! -s err ]] || fail "$(cat err)"

# OFF: points alone, a cut file, a wrong corner
printf 'OFF\n2 0 0\n0 0 0\n1 2 3\n' > points.off
facts points.off '^points +2$' '^bounds +0 0 0 to 1 2 3$'
printf 'OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' > cut.off
facts cut.off '^triangles +1$'
warned 'ends before face 1 of 2'
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n' > corner.off
run 3 info corner.off
grep -q 'vertex index 3, but there are only 3 vertices (line 6)' err || fail "$(cat err)"

# Columns of text, told by their values
rows() { # PERL THAT PRINTS ROW $i, OF 40
  perl -e "for my \$i (0 .. 39) { print join(' ', $1), qq(\n) }"
}
columns() { # FILE NAMES
  facts "$1" "^values +$2\$"
  warned 'the columns are taken for'
}
rows '0.1 * $i, 0.3, 7, $i, 100, 200, 0.001 * $i - 0.5' > scalar.xyz
columns scalar.xyz 'x, y, z, red, green, blue, scalar'
rows '0.1 * $i, 0.3, 7, 60 + $i, 100, 200, $i % 13' > label.xyz
columns label.xyz 'x, y, z, red, green, blue, scalar'
rows '0.1 * $i, 0.3, 7, 1000 + $i, $i, 100, 200' > intensity.xyz
columns intensity.xyz 'x, y, z, intensity, red, green, blue'
rows '$i % 5, int($i / 5), 0.1 * $i, 0.3, 7.5, $i, 100, 200' > grid.xyz
columns grid.xyz 'row, column, x, y, z, red, green, blue'
rows '0.1 * $i, 0.3, 7, $i, 100, 200' > plain.xyz
facts plain.xyz '^values +x, y, z, red, green, blue$'
[[ ! -s err ]] || fail "colours are no guess: $(cat err)"

# OBJ: names with blanks, of Windows, of another machine; corners of what there is not
printf 'newmtl a b\nmap_Kd -s 1 1 1 -o 0 0 a picture.pfm\n' > 'my materials.mtl'
perl -e 'print "PF\n2 2\n-1\n", pack("f<*", (0.12744, 0.30499, 0.57758) x 4)' > 'a picture.pfm'
square='v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 0 0\nvt 0 0\nvt 0 0\n'
printf "mtllib my materials.mtl\n${square}usemtl a b\nf 1/1 2/2 3/3 4/4\n" > blanks.obj
printf 'newmtl a\nmap_Kd C:\\tex\\a picture.pfm\n' > other.mtl
printf "mtllib D:\\\\models\\\\other.mtl\n${square}usemtl a\nf 1/1 2/2 3/3 4/4\n" > windows.obj
for file in blanks.obj windows.obj; do
  color $file 100 150 200
  [[ ! -s err ]] || fail "$file: $(cat err)"
done
printf "${square}f 1/1 2/9 3/3\nf 1//5 2//5 3//5\n" > beyond.obj
facts beyond.obj '^triangles +2$'
[[ $(grep -c 'do without' err) -eq 2 ]] || fail "corners of what there is not: $(cat err)"
printf "${square}f 1 2\nf 1 2 3\n" > corners.obj
facts corners.obj '^triangles +1$'
warned 'fewer than 3 corners are left out: 1'

printf "${square}f 1/0/0 2/-9/-9 3/1\nf -4 -3 -2\n" > wrong.obj
facts wrong.obj '^triangles +2$'
[[ $(grep -c 'so far: corners that name such do without' err) -eq 2 ]] || fail "corners of what there was not: $(cat err)"
printf "${square}f 0 1 2\n" > wrong.obj
run 3 info wrong.obj
grep -q "a face's corner is v, v/t, v//n or v/t/n (line 9)" err || fail "$(cat err)"

# Numbers of Visual C++, headers in any case, text without lines
printf '0 0 0\n1.#QNAN -1.#IND00 1.#INF\n1.#SNAN 1 1\n1 2 3\n' > visual.xyz
facts visual.xyz '^points +4$' '^bounds +0 0 0 to 1 2 3$'
pcd() { # PERL THAT CHANGES THE FILE
  printf '%s\n' '# .PCD v.7' 'VERSION .7' 'FIELDS x y z' 'SIZE 4 4 4' 'TYPE F F F' 'COUNT 1 1 1' 'WIDTH 3' 'HEIGHT 1' \
    'POINTS 3' 'DATA ascii' '0 0 0' 'nan nan nan' '1 2 3' | perl -pe "$1"
}
pcd '' > usual.pcd
pcd 's/FIELDS/COLUMNS/' > columns.pcd
pcd 's/ascii/ASCII/' > upper.pcd
pcd '$_ = lc unless /TYPE/' > lower.pcd
for file in usual columns upper lower; do
  facts $file.pcd '^points +2$' '^left out +1 points that were not measured$' '^bounds +0 0 0 to 1 2 3$'
done
run 0 layer usual.pcd --quantum 0.01 -o a.lpc # where points are read some at a time
tr '\n' '\r' < upper.stl > returns.stl
tr '\n' ' ' < upper.stl > line.stl
printf 'solid vertex 1 2\n%s' "$(sed 1d upper.stl)" > named.stl
for file in returns line named; do
  facts $file.stl '^points +3$' '^triangles +1$' '^bounds +0 0 0 to 1 1 0$'
done
{ echo '# by hand'; echo; cat unsaid.off; } > comment.off
facts comment.off '^points +4$'

# What measuring says is no colour, and what is no model
{ printf 'ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n'
  printf 'property float confidence\nproperty float intensity\nelement face 1\nproperty list uchar int vertex_indices\n'
  printf 'end_header\n'
  for i in 0 1 2 3; do echo "${places[$i]} 0.$i 0.$i"; done
  echo 4 0 1 2 3; } > confidence.ply
color confidence.ply 255 255 255
echo '{"asset": {"version": "1.0"}, "geometricError": 1, "root": {"geometricError": 0}}' > tileset.json
run 3 info tileset.json
grep -q 'this is a tileset of 3D Tiles' err || fail "$(cat err)"

# 3MF in several models, streamed as lib3mf writes them: two tetrahedra of one number, one placed by components, one by
# the build, with a slash or not before the path
if command -v python3 > /dev/null && "$conic" --version | grep -q 'In this build.* Assimp'; then
  python3 - << 'END' || fail 'cannot write parts.3mf'
import io, sys, zipfile
class Pipe(io.RawIOBase):
    def __init__(self): self.file = open('parts.3mf', 'wb')
    def writable(self): return True
    def write(self, bytes): return self.file.write(bytes)
core = 'http://schemas.microsoft.com/3dmanufacturing/'
head = '<?xml version="1.0"?><model unit="millimeter" xmlns="%score/2015/02" xmlns:p="%sproduction/2015/06">' % (core, core)
def part(size):
    places = ''.join('<vertex x="%g" y="%g" z="%g"/>' % tuple(size * (k == i) for i in range(3)) for k in range(-1, 3))
    faces = ''.join('<triangle v1="%d" v2="%d" v3="%d"/>' % face for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)))
    return head + ('<resources><object id="1" type="model"><mesh><vertices>%s</vertices><triangles>%s</triangles></mesh>'
                   '</object></resources><build/></model>') % (places, faces)
kinds = 'http://schemas.openxmlformats.org/package/2006/'
with zipfile.ZipFile(Pipe(), 'w', zipfile.ZIP_DEFLATED) as package:
    for name, text in {
            '[Content_Types].xml': '<Types xmlns="%scontent-types"><Default Extension="model" ContentType="application/'
                                   'vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>' % kinds,
            '_rels/.rels': '<Relationships xmlns="%srelationships"><Relationship Target="/3D/3dmodel.model" Id="a" '
                           'Type="%s2013/01/3dmodel"/></Relationships>' % (kinds, core),
            '3D/Objects/a.model': part(1), '3D/3dmodel.model': head +
            '<resources><object id="1" type="model"><components><component p:path="/3D/Objects/a.model" objectid="1" '
            'transform="1 0 0 0 1 0 0 0 1 20 0 0"/></components></object></resources><build><item objectid="1"/>'
            '<item objectid="1" p:path="/3D/Objects/b.model"/></build></model>',
            '3D/Objects/b.model': part(5)}.items():
        package.writestr(name, text)
END
  facts parts.3mf '^points +8$' '^triangles +8$' '^bounds +0 0 0 to 21 5 5$' '^up +z'
fi

# The coordinate system goes along
las() { # WELL-KNOWN TEXT
  perl -e 'my $text = shift() . "\0"; my $at = 375 + 54 + length $text;
    my $head = pack "a4vva8x8CCa32a32vvvVVCvVV5d12Q<Q<VQ<Q<15", "LASF", 0, 16, "", 1, 4, "", "", 1, 2026, 375, $at, 1, 6, 30,
      (0) x 6, (1) x 3, (0) x 9, 0, 0, 0, 100, (0) x 15;
    print $head, pack("va16vva32", 0, "LASF_Projection", 2112, length $text, ""), $text;
    print pack "V3x18", $_ % 10, int $_ / 10, 0 for 0 .. 99' "$1"
}
datum='DATUM["WGS_1984",SPHEROID["WGS84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["Degree",0.0174]'
utm='PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",15],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]'
las "PROJCS[\"any\",GEOGCS[\"any\",$datum,AUTHORITY[\"EPSG\",\"4326\"]],$utm,AUTHORITY[\"EPSG\",\"32633\"]]" > plain.las
las "COMPD_CS[\"any\",PROJCS[\"any\",GEOGCS[\"any\",$datum],$utm,AUTHORITY[\"EPSG\",\"32633\"]],VERT_CS[\"h\",VERT_DATUM[\"h\",2005],UNIT[\"m\",1],AUTHORITY[\"EPSG\",\"5703\"]]]" > compound.las
las "PROJCS [\"WGS_1984_UTM_Zone_33N\", GEOGCS [\"any\",$datum],$utm]" > esri.las
las "PROJCS[\"any\",GEOGCS[\"any\",$datum],${utm/0.9996/0.9999}]" > other.las
for file in plain compound esri; do
  facts $file.las '^system +EPSG:32633$'
  run 0 prepare $file.las -o a.ply
  run 0 layer a.ply -o a.lpc
  run 0 layer plain.las a.ply -o two.lpc
  run 0 cut a.lpc -o b.ply
  run 0 cut b.ply -o a.las
  run 0 cut a.las -o b.lpc
  for made in a.ply a.lpc two.lpc b.ply a.las b.lpc; do
    facts $made '^system +EPSG:32633$'
  done
  run 0 render b.lpc --camera top:0.1 -o map.tif
  perl -0777 -ne 'exit(index($_, pack "v4", 3072, 0, 1, 32633) < 0)' map.tif || fail "$file: no system in a map of its cloud"
done
facts other.las '^system +one without an EPSG code$'
for words in 'prepare other.las -o a.ply' 'layer other.las -o a.lpc' 'octree plain.las -o a.cot'; do
  run 0 $words
  warned 'coordinate system.* is left out'
done
run 0 layer plain.las other.las -o a.lpc
grep -q 'not all of one coordinate system' err || fail "$(cat err)"

# Cut PLY and PTX
head -c -8 bytes.ply > cut.ply # within the face
facts cut.ply '^points +4$' '^fields +positions, colors$'
warned 'ends within face 0 of 1'
for words in 'info --check cut.ply' 'layer cut.ply -o c.lpc'; do # which read it several times
  run 0 $words
  [[ $(grep -c 'ends within face 0 of 1' err) -eq 1 ]] || fail "$words: not one warning: $(cat err)"
done
{ printf '2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n'; printf '%s 1 2 0.5\n' 1 2 3; } > cut.ptx
facts cut.ptx '^points +3$'
warned 'ends before the last 1 places'

[[ $failures -eq 0 ]]
