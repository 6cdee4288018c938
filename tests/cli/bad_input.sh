#!/usr/bin/env bash
# The program and inputs that cannot be used, disks that are full, memory that is short: the exit code, one line that
# names the file, nothing half-written, and what stood there before is whole. What the readers make of every cut and
# every wrong byte is in test_spoiled_files.c.
set -uo pipefail

conic=$2
work=$(mktemp -d)
mounted=
cleanup() {
  [[ -z $mounted ]] || umount "$mounted"
  rm -rf "$work"
}
trap cleanup EXIT
cd "$work" || exit 1
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# Runs conic; what it printed is then in `out` and `err`.
run() { # EXIT_CODE, ARGUMENTS …
  local wanted=$1 got
  shift
  [[ $1 != render && $1 != explain && $1 != verify ]] || set -- "$1" --plain "${@:2}"
  "$conic" "$@" > out 2> err < /dev/null
  got=$?
  [[ $got -eq $wanted ]] || fail "conic $*: exit code $got instead of $wanted: $(head -c 300 err)"
}
# The same for a run that must fail: one line on standard error that begins with the file's name, and nothing else.
run_wrong() { # EXIT_CODE, FILE, PATTERN, ARGUMENTS …
  run "$1" "${@:4}"
  [[ ! -s out ]] || fail "conic ${*:4}: something on standard output"
  [[ $(wc -l < err) -eq 1 ]] || fail "conic ${*:4}: not one line of error: $(head -c 300 err)"
  [[ $(head -c $((15 + ${#2})) err) == "conic: error: $2:" ]] || fail "conic ${*:4}: $2 is not named: $(head -c 300 err)"
  grep -qe "$3" err || fail "conic ${*:4}: no \"$3\" in: $(head -c 300 err)"
  [[ -z $(ls -A outputs) ]] || {
    fail "conic ${*:4}: left behind: $(ls -A outputs)"
    rm -rf outputs/* outputs/.[!.]*
  }
}
# Every command that reads models.
wrong_model() { # FILE, PATTERN
  run_wrong 3 "$1" "$2" info "$1"
  wrong_scene "$1" "$2"
}
wrong_scene() { # FILE, PATTERN
  run_wrong 3 "$1" "$2" prepare "$1" -o outputs/a.ply --json outputs/a.json
  run_wrong 3 "$1" "$2" render "$1" -o outputs/a.pfm --size 16x16 --json outputs/a.json
  run_wrong 3 "$1" "$2" render sound.ply "$1" -o outputs/a.pfm --size 16x16
}
wrong_picture() { # FILE, PATTERN
  run_wrong 3 "$1" "$2" diff "$1" sound.pfm --heatmap outputs/a.png --json outputs/a.json
  run_wrong 3 "$1" "$2" diff sound.pfm "$1" --heatmap outputs/a.pfm
}
wrong_camera() { # FILE, PATTERN
  run_wrong 3 "$1" "$2" render sound.ply --camera "$1" -o outputs/a.pfm
}
wrong_everything() { # FILE, PATTERN
  wrong_model "$@"
  wrong_picture "$@"
  wrong_camera "$@"
}

mkdir outputs
run 0 make sphere -n 200 -o sound.ply
run 0 render sound.ply -o sound.pfm --size 16x16

# Files that are none
wrong_everything absent.ply 'No such file'
wrong_everything absent/absent.obj 'No such file'
wrong_everything outputs 'directory'
: > empty
wrong_everything empty 'the file is empty ('
ln -s loop loop
wrong_everything loop 'levels of symbolic links'
if [[ $(id -u) -eq 0 ]]; then
  echo "skipped: root reads everything"
else
  cp sound.ply unreadable
  chmod 000 unreadable
  wrong_everything unreadable 'Permission denied'
fi
head -c 3000 /dev/zero > zeros
wrong_model zeros 'byte 0'
wrong_camera zeros 'line 1'
wrong_picture zeros 'cannot read'
printf '\033[31mred\n' > escape.ply # what a terminal would obey does not get there
printf 'ply\n\033[31mred\n' > escape_word.ply
for name in escape.ply escape_word.ply; do
  wrong_model $name '(line 2)\|(at byte 0)'
  ! grep -q $'\033' err || fail "$name: an escape sequence in the message"
done

line_end=$'two\nlines.xyz' # nor does a name make two lines of one
printf 'nan 0 0\n' > "$line_end"
run_wrong 3 'two?lines.xyz' '' render "$line_end" -o outputs/a.pfm

# Cut files
head -c 1500 sound.ply > cut.ply
run 0 info cut.ply
grep -q '^conic: warning: cut.ply: the file ends within vertex .*what is before is read (at byte ' err || fail "$(cat err)"
head -c 150 sound.ply > cut_header.ply
wrong_model cut_header.ply 'ends within the header (line [0-9]*)'
head -c 1000 sound.pfm > cut.pfm
wrong_picture cut.pfm 'too short.*byte'
"$conic" prepare sound.ply -o - < /dev/null | head -c 3000 > cut_stream
"$conic" info - < cut_stream > out 2> err
[[ $? -eq 0 && $(grep -c '^conic: warning: .*the file ends within vertex' err) -eq 1 ]] || fail "a cut stream is taken for sound"
cat cut_stream | "$conic" info - > out 2> err # whose size is not known
[[ $? -eq 0 && $(wc -l < err) -eq 1 ]] || fail "a cut pipe is taken for sound: $(cat err)"
grep -q '^conic: warning: standard input: .*(at byte ' err || fail "a cut pipe: where? $(cat err)"

# Contents that cannot be
header='ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n'
faces='element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n'
printf "$header${faces}3 0 1 3\n" > index.ply
wrong_model index.ply 'vertex index 3.*(line 13)'
printf "$header${faces}3 0 1 -1\n" > negative.ply
wrong_model negative.ply 'negative.*(line 13)'
printf "$header${faces/uchar/ushort}2000 0 1 2\n" > list.ply
wrong_model list.ply 'list runs past.*(line 13)'
printf "${header/3/-3}end_header\n0 0 0\n" > count.ply
wrong_model count.ply '(line 3)'
printf "${header/3/4000000000}end_header\n" > huge.ply
wrong_model huge.ply '4000000000.*line '
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n' > index.obj
wrong_model index.obj 'index 4.*(line 4)'

# Meshes, as those who draw triangles or make hybrid models read them
wrong_mesh() { # FILE, PATTERN
  run_wrong 3 "$1" "$2" hybrid "$1" -o outputs/a.chy --json outputs/a.json
  run_wrong 3 "$1" "$2" render "$1" --as hybrid -o outputs/a.pfm --size 16x16
}
corners='v 0 0 0\nv 1 0 0\nv 0 1 0\n'
while IFS='|' read -r name text pattern; do
  printf "$corners$text\n" > "$name.obj"
  wrong_mesh "$name.obj" "$pattern"
  run_wrong 3 "$name.obj" "$pattern" render "$name.obj" --as mesh -o outputs/a.pfm --size 16x16
done << 'END'
past|f 1 2 4|: index 4, but there are only 3 vertices (line 4)$
back|f 1 2 -4|: index -4, but there are only 3 vertices so far (line 4)$
zero|f 1 2 0|: a face.s corner is v, v/t, v//n or v/t/n (line 4)$
wide|f 1 2 4294967297|: an index is out of range (line 4)$
END
printf "$corners" > faceless.obj
run_wrong 3 faceless.obj ': there are no faces for the texture to lie on$' hybrid faceless.obj -o outputs/a.chy --texture a.png
printf 'v nan 0 0\n' > pointless.obj
wrong_mesh pointless.obj ': cannot be drawn: no point is finite$'
printf 'v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > nan.obj
printf 'v 0 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\n' > flat.obj
printf 'v 1e300 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > infinite.obj
for name in nan flat infinite; do
  wrong_mesh $name.obj ': no face has three finite corners at three places$'
done
for name in nan flat; do
  run_wrong 3 $name.obj ': no face has three finite corners at three places$' render $name.obj --as mesh -o outputs/a.pfm
done
printf "${corners}v nan 1 1\nf 1 2 3\nf 1 2 4\n" > partly.obj # one face is sound, and the other one counted
run 0 hybrid partly.obj -o partly.chy --json -
grep -q '"nan": 1' out || fail "a face that is not finite is not counted: $(grep nan out)"
run 0 render partly.chy -o partly.pfm --size 16x16
run 0 render partly.obj --as mesh -o partly.pfm --size 16x16 --json -
grep -q '"triangles_skipped": 1' out || fail "a face that is not finite is not counted: $(grep triangles out)"
grep -q '"triangles_drawn": 1' out || fail "the sound face is not drawn: $(grep triangles out)"
printf 'v 1e30 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > distant.obj
run_wrong 3 distant.obj ': a point is farther out than 1e20$' hybrid distant.obj -o outputs/a.chy
run_wrong 3 distant.obj 'farther out than 1e20$' render distant.obj --as hybrid -o outputs/a.pfm
run_wrong 3 distant.obj 'farther out than 1e20$' render distant.obj --as mesh -o outputs/a.pfm
head -c 900 partly.chy > cut.chy # longer than its header
run_wrong 3 cut.chy ": has 900 bytes where its header tells of $(stat -c %s partly.chy) (at byte 900)$" info cut.chy
run_wrong 3 cut.chy ': has 900 bytes' render cut.chy -o outputs/a.pfm
head -c 200 partly.chy > header.chy
run_wrong 3 header.chy ': ends within its header (at byte 200)$' render header.chy -o outputs/a.pfm
{ head -c 600 partly.chy && printf 'damaged' && tail -c +608 partly.chy; } > damaged.chy
run_wrong 3 damaged.chy ': is damaged.*(at byte [0-9]*)$' info damaged.chy --check
run_wrong 3 damaged.chy ': is damaged' render damaged.chy -o outputs/a.pfm
{ head -c -8 partly.chy && printf 'damaged!'; } > damaged.chy # in its last chunk
run_wrong 3 damaged.chy ': has a chunk that is damaged (at byte [0-9]*)$' info damaged.chy --check
run_wrong 3 damaged.chy ': cannot read chunk [0-9]*: a chunk that is damaged (at byte [0-9]*)$' render damaged.chy \
  -o outputs/a.pfm
run_wrong 2 render 'acts on .*clouds\? in levels.*, not on partly.obj$' render partly.obj -o outputs/a.pfm --timeout 9

printf '5000000000\n0 0 0\n' > huge.pts
wrong_model huge.pts 'number of points.*line 1'
printf '{"width": 1e300}' > camera.json
wrong_camera camera.json '(line 1)'
matrix='"world_to_camera": [[1,0,0,0],[0,1,0,0],[0,0,1,3],[0,0,0,1]]'
printf '{"width": 9, "height": 9, "fx": 1e13, "fy": 9, "cx": 4, "cy": 4, %s}' "$matrix" > focal.json
wrong_camera focal.json 'too large (line 1)'
printf '{"width": 9, "height": 9, "fx": 9, "fy": 9, "cx": 4, "cy": 4,\n%s}' "${matrix/3/1e31}" > far.json
wrong_camera far.json 'too large (line 2)'

# Nothing to draw
printf "${header/3/0}end_header\n" > none.ply
printf "${header}end_header\nnan 0 0\n0 inf 0\n0 0 -inf\n" > lost.ply
printf '0\n' > none.pts
printf 'nan 0 0\n' > lost.xyz
for name in none.ply lost.ply none.pts lost.xyz; do
  run 0 info $name --check
  wrong_scene $name ''
  run_wrong 3 $name '' prepare $name -o outputs/a.ply --count 2
done

printf '1e300 0 0\n2e300 0 0\n' > far.xyz
run_wrong 3 far.xyz 'farther out' render far.xyz -o outputs/a.pfm
printf '0 0 0\n1e-300 0 0\n1e-300 1e-300 0\n' > near.xyz # a point, as far as floats go
run 0 render near.xyz -o near.pfm --size 16x16

# What a file claims costs no memory: half a gigabyte of address space is plenty
limited() {
  ulimit -v 524288
  exec "$@"
}
if { (limited "$conic" --version); } > /dev/null 2>&1; then
  plain_conic=$conic
  conic=limited_conic
  limited_conic() {
    (limited "$plain_conic" "$@")
  }
  for name in huge.ply huge.pts count.ply list.ply index.obj; do
    run_wrong 3 $name '' info $name
  done
  printf 'PF\n65535 65535\n-1.0\n0123456789' > huge.pfm
  run_wrong 3 huge.pfm 'too short' diff huge.pfm huge.pfm
  printf "${header/ascii/binary_little_endian}" | sed 's/vertex 3/vertex 4000000000/' > huge_stream.ply
  printf 'end_header\n0123456789' >> huge_stream.ply
  cat huge_stream.ply | limited_conic info - > out 2> err
  [[ $? -eq 3 ]] || fail "a stream that claims much: $(cat err)"
  run_wrong 4 'out of memory' 'bytes' render sound.ply -o outputs/a.pfm --size 65535x65535
  conic=$plain_conic
else
  echo "skipped: this build does not run in little address space"
fi

# Repaired or skipped, and counted
{
  printf "${header/3/105}property float nx\nproperty float ny\nproperty float nz\nend_header\n"
  for ((i = 0; i < 100; i++)); do
    echo "$((i % 10)) $((i / 10)) 0 0 0 1"
  done
  printf 'nan 0 0 0 0 1\n0 inf 0 0 0 1\n3 3 0 0 0 1\n4.5 4.5 0 0 0 0\n5.5 5.5 0 nan 0 1\n'
} > repair.ply
run 0 prepare repair.ply -o repaired.ply --json -
for counted in '"nan": 2' '"zero": 2' '"duplicate": 1' '"points_in": 105'; do
  grep -q "$counted" out || fail "prepare does not count $counted: $(grep -A 6 skipped out)"
done
run 0 render repair.ply -o repair.pfm --size 16x16 --json -
grep -q '"splats_in": 105,' out && grep -q '"splats_skipped": 2,' out || fail "render counts wrongly: $(grep splats_ out)"
run 0 render repaired.ply -o repaired.pfm --size 16x16 --json -
grep -q '"splats_skipped": 2,' out || fail "render counts prepared splats wrongly: $(grep splats_ out)"
run 0 diff repair.pfm repaired.pfm
printf "${header}property float nx\nproperty float ny\nproperty float nz\nproperty float radius\nend_header\n" > radii.ply
printf '0 0 0 0 0 1 0.5\n1 0 0 0 0 1 0\n0 1 0 0 0 1 -nan\n' >> radii.ply
run 0 prepare radii.ply -o radii_repaired.ply --json -
grep -q '"zero": 2' out || fail "radii of zero and NaN are not repaired: $(grep -A 6 skipped out)"

# Disks that are full: the old file is whole, and nothing stands beside it
writers() { # FOLDER: every command that writes a file of some size there, as lines
  echo "make sphere -n 20000 -o $1/a.ply"
  echo "make sphere -n 20000 -o $1/a.ply --ascii"
  echo "prepare large.ply -o $1/a.ply"
  for ending in pfm exr png tif; do
    echo "render large.ply -o $1/a.$ending --size 300x200"
  done
  echo "diff large.pfm other.pfm --heatmap $1/a.png --max-abs 9"
}
run 0 make knot -n 20000 -o large.ply
run 0 render large.ply -o large.pfm --size 300x200
run 0 render large.ply -o other.pfm --size 300x200 --azimuth 50
run 0 --version
grep -q '^In this build:.*OpenEXR' out || echo "skipped: EXR is not in this build"
has_oiio=$(grep -c '^In this build:.*OpenImageIO' out)
has_png=$(grep -c '^In this build:.*\(libpng\|OpenImageIO\)' out)
has_exr=$(grep -c '^In this build:.*\(OpenEXR\|OpenImageIO\)' out)
is_writable() { # COMMAND LINE
  case $1 in
    *.png*) [[ $has_png -gt 0 ]] ;;
    *.tif*) [[ $has_oiio -gt 0 ]] ;;
    *.exr*) [[ $has_exr -gt 0 ]] ;;
  esac
}
run_full() { # FOLDER, COMMAND LINE: it must fail there
  local name
  name=$(grep -o "$1/a\.[a-z]*" <<< "$2")
  echo "the old one" > "$name"
  "${@:3}" "$conic" $2 > out 2> err < /dev/null
  local got=$?
  [[ $got -eq 4 ]] || fail "conic $2 on a full disk: exit code $got: $(head -c 300 err)"
  [[ $(wc -l < err) -eq 1 ]] && grep -q "^conic: error: $name: " err || fail "conic $2 on a full disk: $(head -c 300 err)"
  cmp -s "$name" <(echo "the old one") || fail "conic $2 on a full disk: the old file is gone"
  rm -f "$name"
  [[ -z $(ls -A "$1") ]] || fail "conic $2 on a full disk: left behind: $(ls -A "$1")"
}
small_files() {
  ulimit -f 2
  exec "$@"
}
in_small_files() {
  (small_files "$@")
}
while read -r line; do
  is_writable "$line" || continue
  run_full outputs "$line" in_small_files
done < <(writers outputs)
mkdir small
if mount -t tmpfs -o size=12k none small 2> /dev/null; then
  mounted=$work/small
  while read -r line; do
    is_writable "$line" || continue
    run_full small "$line"
  done < <(writers small)
  umount "$mounted"
  mounted=
else
  echo "skipped: no small file system can be mounted"
fi
if [[ -w /dev/full ]]; then
  for ending in pfm exr png tif; do
    is_writable "a.$ending" || continue
    ln -s /dev/full full.$ending
    run_wrong 4 full.$ending '' render large.ply -o full.$ending --size 300x200
  done
  ln -s /dev/full full.ply
  run_wrong 4 full.ply 'No space' prepare large.ply -o full.ply
  run_wrong 4 /dev/full 'No space' prepare large.ply -o prepared.ply --json /dev/full
fi

[[ $failures -eq 0 ]]
