#!/usr/bin/env bash
# Words of other programs, and what people type first: each is done as it is meant, and the command said, or answered by
# what to type instead. The table holds an exit code, what standard error says of it, and the command.
set -uo pipefail

source "$1/tests/support/program.bash"
run 0 make sphere -n 300 -o s.ply
printf '0 0 0 5\n1 0 0 6\n0 1 0 7\n0 0 1 8\n1 1 0 9\n1 0 1 5\n0 1 1 6\n1 1 1 7\n' > points.xyz
cp s.ply taken.ply
: > taken.png
sed 's/^format .*/&\nCreated by Blender 2.49 - www.blender.org/' <<< "$(printf '%s\n' ply 'format ascii 1.0' \
  'element vertex 3' 'property float x' 'property float y' 'property float z' 'element face 1' \
  'property list uchar int vertex_indices' end_header '0 0 0' '1 0 0' '0 1 0' '3 0 1 2')" > old.ply
export LC_ALL=C

n_commands=0
while IFS='|' read -r code said line; do
  [[ -n $line ]] || continue
  n_commands=$((n_commands + 1))
  read -ra words <<< "$line"
  "$conic" "${words[@]}" > out 2> err < /dev/null
  got=$?
  [[ $got -eq $code ]] || fail "conic $line: exit code $got instead of $code: $(head -c 300 err)"
  if [[ -n $said ]]; then
    grep -qF -e "$said" err || fail "conic $line: no \"$said\" in: $(head -c 300 err)"
  elif [[ -s err ]]; then
    fail "conic $line: says $(head -c 300 err)"
  fi
  [[ $code -ne 2 || $(wc -l < err) -eq 1 ]] || fail "conic $line: not one line: $(head -c 300 err)"
done << 'END'
0|in full: conic render s.ply --size 16x16 -o s.png|s.ply --size 16x16
2|s.png is there already; conic render s.ply -o s.png writes over it|s.ply
2|taken.png is there already|view taken.ply
0|in full: conic render s.ply -o t.png --size 16x16|s.ply -o t.png --size 16x16
0|in full: conic render points.xyz --size 16x16 -o points.png|view points.xyz --size 16x16
0|in full: conic render s.ply -o r.png --size 16x16|render s.ply r.png --size 16x16
0|in full: conic render --size 16x16 s.ply -o r2.pfm|render --size 16x16 s.ply r2.pfm
0|in full: conic render s.ply -o u.png|s.ply u.png -s 16x16
0|in full: conic render s.ply --output=named.png|s.ply --output=named.png --size 16x16
2|no output|render s.ply
2|--shadow: it is an option of conic render and conic sheet: shadows are neither|judge s.ply --shadow
2|--repeat: it is an option of conic render|verify s.ply --repeat 3
2|--motion: it is an option of conic render|gradient s.ply --motion m.json
2|no output|render s.ply taken.ply
2|typo.ply: cannot write: no format is known by this ending|render s.ply typo.ply
3|missing.ply: cannot read|missing.ply
3|missing.ply: cannot read|view missing.ply
3|missing.ply: cannot read|render missing.ply v.png
2|conic FILE draws a picture of it|view
2|conic FILE draws a picture of it|open
2|did you mean render?|rendr
0|in full: conic prepare points.xyz -o prepared.ply|prepare points.xyz prepared.ply
0|in full: conic make sphere -o made.ply -n 50|make sphere made.ply -n 50
0|in full: conic cut s.ply -o part.ply --box|cut s.ply part.ply --box -1,-1,0,1,1,1
0|in full: conic mls thin points.xyz -o thin.ply|mls thin points.xyz thin.ply --count 6
0|in full: conic octree s.ply -o s.cot|octree s.ply s.cot
0|in full: conic diff r.png r.png|compare r.png r.png
0|in full: conic diff r.png r.png|difference r.png r.png
0|in full: conic info s.ply|stats s.ply
0|in full: conic info s.ply|inspect s.ply
0|in full: conic info s.ply|describe s.ply
0|in full: conic render s.ply -o d.png|draw s.ply -o d.png --size 16x16
0|in full: conic render s.ply -o d.png|rasterize s.ply -o d.png --size 16x16
0|in full: conic make sphere -o g.ply|generate sphere -o g.ply -n 20
0|in full: conic cut s.ply -o c.ply|crop s.ply -o c.ply --box -1,-1,0,1,1,1
0|in full: conic cut s.ply -o c.ply|clip s.ply -o c.ply --bbox -1,-1,0,1,1,1
2|convert: no input given|export
2|convert: no input given|translate
2|csg: |boolean
2|merge: |combine
0||version
0||--version
2|unknown command compare: conic diff|help compare
2|conic render IN -o OUT.png --turntable 36|turntable s.ply
2|conic render IN -o OUT.png --turntable 36|animate s.ply
2|for ffmpeg|video s.ply
2|conic mls thin and conic prepare --count N|simplify s.ply
2|conic mls thin and conic prepare --count N|decimate s.ply
2|conic prepare IN -o OUT.ply --count N|downsample s.ply
2|conic mls thin IN|thin s.ply
2|conic mls project IN|smooth s.ply
2|conic mls densify IN|upsample s.ply
2|draws points as a surface|mesh s.ply
2|gives points normals|normals s.ply
2|conic octree and conic layer|lod s.ply
2|conic info FILE --check|check s.ply
2|conic info FILE --check|validate s.ply
2|conic verify IN|test
2|trains no Gaussians|train
0|render: --output means -o|render s.ply --output a.png --size 16x16
0|render: --output means -o|render s.ply --output=a.png --size 16x16
0|render: --out means -o|render s.ply --out a.png --size 16x16
0|prepare: --output means -o|prepare points.xyz --output a.ply
0|make: --output means -o|make sphere --output a.ply -n 20
2|--heatmap OUT.png writes where pictures differ|diff r.png r.png --output x.png
2|--heatmap OUT.png writes where pictures differ|diff r.png r.png -o x.png
2|files to read stand without an option|render --input s.ply -o a.png
2|files to read stand without an option|render -i s.ply -o a.png
2|written over without being asked|render s.ply -o a.png --force
2|written over without being asked|prepare points.xyz -o a.ply --overwrite
0|render: -s means --size|render s.ply -o a.png -s 16x16
0|render: -s means --size|render s.ply -o a.png -s16x16
0|render: --resolution means --size|render s.ply -o a.png --resolution 16x16
0|render: --res means --size|render s.ply -o a.png --res=16x16
2|render: --size: "16" is not understood|render s.ply -o a.png --resolution 16
0|make: -s means --seed|make sphere -o a.ply -n 20 --noise 0.1 -s 7
2|as 640x360|render s.ply -o a.png --size 16
2|ending .ply, .lpc or .las|cut points.xyz -o a.laz
2|points are written by conic cut|convert s.ply -o a.las
2|--size WIDTHxHEIGHT is both|render s.ply -o a.png --width 16 --height 16
2|--size WIDTHxHEIGHT is both|render s.ply -o a.png --height=16
2|--size WIDTHxHEIGHT is both|render s.ply -o a.png -w 16
2|did you mean --size?|render s.ply -o a.png -size 16x16
2|pixels alone count|render s.ply -o a.png --dpi 300
2|--zoom Z|render s.ply -o a.png --scale 2
0|render: -j means --threads|render s.ply -o a.png -s 16x16 -j 2
0|render: -j means --threads|render s.ply -o a.png -s 16x16 -j2
0|info: --jobs means --threads|info s.ply --jobs 2
0||render s.ply -o a.png --size 16x16 --silent
2|--verbose says more|render s.ply -o a.png --debug
2|conic --version|render --version
2|graphics processors draw by --device opencl|render s.ply -o a.png --cuda
0|render: --cpu means --device cpu|render s.ply -o a.png -s 16x16 --cpu
2|--cpu=1 stands for a value, and takes none|render s.ply -o a.png --cpu=1
0|render: --bg means --background|render s.ply -o a.png -s 16x16 --bg 1,1,1
0|render: --background-color means --background|render s.ply -o a.png -s 16x16 --background-color 1
0|render: --transparent means --background none|render s.ply -o a.png -s 16x16 --transparent
2|--color-by WHAT says what colours points|render s.ply -o a.png --color red
2|--color-by WHAT says what colours points|render s.ply -o a.png --colour red
0|render: --cmap means --ramp|render points.xyz -o a.png -s 16x16 --color-by height --cmap heat
2|--ramp A,B, or behind a ramp's name|render points.xyz -o a.png --color-by height --clim 0,1
2|--ramp A,B, or behind a ramp's name|render points.xyz -o a.png --color-by height --range 0,1
0|render: --colorbar means --show legend|render points.xyz -o a.png -s 64x64 --color-by height --colorbar
0|render: --ortho means --projection orthographic|render s.ply -o a.png -s 16x16 --ortho
0|render: --parallel means --projection orthographic|render s.ply -o a.png -s 16x16 --parallel
0|render: --yaw means --azimuth|render s.ply -o a.png -s 16x16 --yaw 20
0|render: --pitch means --elevation|render s.ply -o a.png -s 16x16 --pitch -20
0|render: --view-angle means --fov|render s.ply -o a.png -s 16x16 --view-angle 30
0|render: --camera-position means --eye|render s.ply -o a.png -s 16x16 --camera-position 3,3,3
2|--camera FILE looks anywhere|render s.ply -o a.png --look-at 0,0,0
2|--azimuth DEG goes around|render s.ply -o a.png --rotate 90
0|render: --orbit means --turntable|render s.ply -o turn.png -s 16x16 --orbit 2
2|it needs --turntable N, --path FILE, or --view all|render s.ply -o a.png --frames 1
2|--place s.ply: several inputs have this name|render s.ply s.ply -o a.png --place s.ply=1,0,0
2|--catcher s.ply: several inputs have this name|render s.ply s.ply -o a.png --shadow --catcher s.ply
2|--path, or -o OUT.mp4|render s.ply -o a.png --turntable 2 --framerate 25
2|conic cut IN -o OUT --box|render s.ply -o a.png --section 1,0,0
2|conic cut IN -o OUT --box|render s.ply -o a.png --clip 1,0,0
2|conic cut IN -o OUT --box|render s.ply -o a.png --crop 1,0,0
2|points are as large as their neighbours are far|render points.xyz -o a.png --point-size 3
2|--samples N averages|render s.ply -o a.png --spp 16
2|--samples N averages|render s.ply -o a.png --antialiasing
2|--ao 64 darkens|render s.ply -o a.png --ssao
0|render: --shadows means --shadow|render s.ply -o a.png -s 16x16 --shadows --light 1,2,1
0|render: --unlit means --shade none|render s.ply -o a.png -s 16x16 --unlit
0|render: --brightness means --exposure|render s.ply -o a.png -s 16x16 --brightness 1
2|--tone NAME bends|render s.ply -o a.png --gamma 2.2
2|--aov Z is the plane of depths|render s.ply -o a.png --depth
2|--aov N is the plane of normals|render s.ply -o a.png --normals
2|conic draws no lines|render s.ply -o a.png --wireframe
0|render: --max-splats means --budget|render s.ply -o a.png -s 16x16 --max-splats 100
0|mls: --n-points means --count|mls thin points.xyz -o a.ply --n-points 6
1|diff: --tolerance means --max-abs|diff r.png turn.0002.png --tolerance 0.0001
0||render s.ply -o front.pfm --size 32x32 --view front
0||render s.ply -o same.pfm --size 32x32 --azimuth 0 --elevation 0
0||diff front.pfm same.pfm
0||render s.ply -o left.pfm --size 32x32 --view left
0||render s.ply -o same.pfm --size 32x32 --azimuth 270 --elevation 0
0||diff left.pfm same.pfm
0||render s.ply -o same.pfm --size 32x32 --azimuth 9 --view left
0||diff left.pfm same.pfm
0||render s.ply -o iso.png --size 32x32 --view iso
0|framed anew|render --again iso.png --view top -o same.png
0||render s.ply -o top.png --size 32x32 --view top
0||diff top.png same.png
1||diff top.png iso.png
2|front, back, left, right, top, bottom or iso|render s.ply -o a.png --view frnt
2|front, back, left, right, top, bottom or iso|render s.ply -o a.png --view 3
0||render s.ply -o white.pfm --size 32x32 --background white
0||render s.ply -o same.pfm --size 32x32 --background #fff
0||diff white.pfm same.pfm
0||render s.ply -o same.pfm --size 32x32 --background 1,1,1
0||diff white.pfm same.pfm
0||render s.ply -o same.pfm --size 32x32 --background #ffffff:white
0||render s.ply -o lit.pfm --size 32x32 --light 1,1,1:orange --sky skyblue:#204010
0||render s.ply -o same.pfm --size 32x32 --light 1,1,1:#ffa500 --sky #87ceeb:#204010
0||diff lit.pfm same.pfm
2|as codes from 0 to 255 it is #ff8000|render s.ply -o a.png --background 255,128,0
2|as codes from 0 to 255 it is #ff8000|render s.ply -o a.png --light 1,1,1:255,128,0
2|a name as white, or #rrggbb|render s.ply -o a.png --background puce
2|a name as white, or #rrggbb|render s.ply -o a.png --background #12345
0||render points.xyz -o a.png --size 16x16 --color-by height --ramp viridis
0||render points.xyz -o a.png --size 16x16 --color-by height --ramp magma:0,1
0||render points.xyz -o a.png --size 16x16 --color-by height --ramp turbo
2|did you mean 'viridis'?); there are sequential, grey, heat|render points.xyz -o a.png --color-by height --ramp virids
2|there are sequential, grey, heat, diverging, terrain, viridis, magma, turbo, classes|render s.ply -o a.png --ramp list
3|conic prepare survey.laz -o OUT.ply writes points as splats|convert survey.laz -o survey.ply
3|conic prepare survey.xyz -o OUT.ply|convert survey.xyz survey.ply
3|not read over the web; download it first|convert http://localhost/half.ply -o half.spz
3|not read over the web; download it first|render http://localhost/half.ply -o half.png
3|not read over the web; download it first|http://localhost/half.ply
3|not read over the web; download it first|prepare http://localhost/half.las half.ply
0||info s.ply points.xyz --check
3|missing.ply: cannot read|info s.ply missing.ply points.xyz
0|old.ply: 'Created' is no word of a header|render old.ply -o a.png --size 16x16
END
[[ $n_commands -ge 150 ]] || fail "only $n_commands commands were read"

# What words stand for is what is drawn.
run_as_typed 0 render s.ply -o plain.pfm --size 32x32 --projection orthographic --background none
run_as_typed 0 render s.ply words.pfm -s 32x32 --ortho --transparent
cmp -s plain.pfm words.pfm || fail "words draw another picture than options"

# A table of files; what cannot be read is left out.
"$conic" info s.ply missing.ply points.xyz --check > out 2> err
[[ $(awk '{print $1, $3, $NF}' out) == $'kind points file\nply 300 s.ply\nxyz 8 points.xyz' ]] || fail "info: $(cat out)"
"$conic" info s.ply missing.ply points.xyz --json - > out 2> err
python3 -c 'import json, sys; print(*((f["file"], f["kind"], f["points"]) for f in json.load(sys.stdin)["files"]))' \
  < out | grep -qxF "('s.ply', 'ply', 300) ('points.xyz', 'xyz', 8)" || fail "info --json: $(cat out)"

# A command that is stopped says its own name, whatever part of it was at work.
run 0 make sphere -n 100000 -o large.ply
run 0 render large.ply -o large.pfm --size 1200x1200 --quiet
"$conic" judge large.ply --picture large.pfm --size 1200x1200 --plain > out 2> err < /dev/null &
sleep 2
kill $!
wait $! && fail "judge goes on after SIGTERM"
grep -qx 'conic: error: judge: cancelled' err || fail "judge says $(cat err)"

# Nothing is said where it is not wanted.
run_as_typed 0 render s.ply -o a.png -s 16x16 --ortho --quiet
[[ ! -s err ]] || fail "--quiet: $(cat err)"
exit $((failures > 0))
