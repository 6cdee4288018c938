#!/usr/bin/env bash
# Outputs among other files: no input is written over, under any name; a link is followed, a mode kept, a long name fits.
set -uo pipefail

source "$1/tests/support/program.bash"
# What was read stays as it is, and the run says so: kept FILE ARGUMENTS …
kept() {
  local before
  before=$(cksum < "$1")
  run 2 "${@:2}"
  [[ $(cksum < "$1") == "$before" ]] || fail "conic ${*:2}: writes over $1"
  [[ $(wc -l < err) -eq 1 ]] || fail "conic ${*:2}: not one line: $(head -c 300 err)"
  grep -q 'is an input, and would be written over' err || fail "conic ${*:2}: $(cat err)"
}
has() { # FEATURE of the build
  "$conic" --version | grep -q "^In this build:.*$1"
}
"$conic" make sphere -n 2000 -o s.ply
ln -s s.ply link.ply
ln s.ply twin.ply
mkdir folder
ln -s ../s.ply folder/far.ply

# What killed commands have left is removed by the next that writes the file, unless somebody may still write it
touch -d '5 minutes ago' .a.999999999-0.pfm .a.$$-0.pfm .b.999999999-0.pfm
touch .a.999999998-0.pfm
"$conic" render s.ply -o a.pfm --size 8x8
[[ ! -e .a.999999999-0.pfm ]] || fail "what a killed command left is still there"
for name in .a.$$-0.pfm .a.999999998-0.pfm .b.999999999-0.pfm; do
  [[ -e $name ]] || fail "$name is gone"
done

# Positional inputs
for name in s.ply ./s.ply link.ply twin.ply folder/far.ply; do
  kept s.ply prepare s.ply -o $name
  kept s.ply mls project s.ply -o $name
  kept s.ply prepare $name -o link.ply
done
# What an input names
printf 'mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n' > m.obj
printf 'newmtl a\nmap_Kd t.pfm\n' > m.mtl
{ printf 'PF\n1 1\n-1\n'; head -c 12 /dev/zero; } > t.pfm
mesh="render m.obj --as mesh --size 16x16"
# shellcheck disable=SC2086 # words
{
  kept t.pfm $mesh -o t.pfm
  kept m.mtl $mesh -o a.pfm --json m.mtl
  kept t.pfm $mesh --turntable 2 -o a.pfm --overdraw t.pfm --frames 1 --json t.pfm
  kept m.mtl hybrid m.obj -o a.chy --json m.mtl
  cp t.pfm turn.0002.pfm
  sed -i 's/t.pfm/turn.0002.pfm/' m.mtl
  kept turn.0002.pfm $mesh -o turn.pfm --turntable 2
}
# (three corners in a file of their own, as glTF has them)
printf '{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "buffers": [{"uri": "g.bin", "byteLength": 36}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}], "accessors": [{"bufferView": 0, "componentType": 5126,
  "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}]}' > g.gltf
printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0' > g.bin
kept g.bin render g.gltf --as mesh --size 16x16 -o a.pfm --json g.bin
# (and a picture of its material's; the shot names it)
material='"images": [{"uri": "t.pfm"}], "textures": [{"source": 0}], "materials": [{"pbrMetallicRoughness": {'
material+='"baseColorTexture": {"index": 0}}}], '
sed "s/{\"POSITION\": 0}/&, \"material\": 0/; s/\"scenes\"/$material&/" g.gltf > painted.gltf
kept t.pfm render painted.gltf --as mesh --size 16x16 -o t.pfm
run 0 render painted.gltf --as mesh --size 16x16 -o a.pfm --save-shot a.shot.json
grep -q '"name": "t.pfm"' a.shot.json || fail "the shot does not name the picture of a material"
# (which it may not name outside of its folder)
mkdir inner
sed 's:g.bin:../g.bin:' g.gltf > inner/g.gltf
for command in 'render --as mesh --size 16x16 -o a.pfm' info 'prepare -o b.ply' 'octree -o b.cot' 'hybrid -o b.chy'; do
  # shellcheck disable=SC2086
  run 3 $command inner/g.gltf
  grep -q '../g.bin is not in the file.s folder or below it (--allow-outside' err || fail "$command: $(cat err)"
  # shellcheck disable=SC2086
  run 0 $command inner/g.gltf --allow-outside
done
# (every command that says so knows the option)
for command in $("$conic" help | sed -nE 's/^  ([a-z]+) .*/\1/p'); do
  "$conic" "$command" inner/g.gltf -o c.ply > /dev/null 2> err
  "$conic" "$command" inner/g.gltf >> err 2>&1
  ! grep -q -e '(--allow-outside' err || ! "$conic" "$command" inner/g.gltf --allow-outside 2>&1 | grep 'unknown option' ||
    fail "$command names --allow-outside, but does not know it"
done
printf '{"width": 16, "height": 16, "fx": 16, "fy": 16, "cx": 8, "cy": 8,
  "world_to_camera": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 6], [0, 0, 0, 1]]}' > camera.json
kept camera.json render s.ply --camera camera.json -o a.pfm --json camera.json
if has zstd; then
  run 0 layer s.ply -o s.lpc
  kept s.lpc render s.lpc -o a.pfm --json s.lpc --size 16x16
fi

# Where rewriting is wanted, it is whole or not at all
cp s.ply one.ply
cp s.ply two.ply
run 0 prepare one.ply --in-place --count 500
run 0 prepare s.ply -o half.ply --count 500
cmp one.ply half.ply || fail "--in-place writes something else than -o"
run 0 mls project two.ply --in-place --json two.json
cmp -s two.ply s.ply && fail "mls --in-place writes nothing"
run 2 prepare one.ply --in-place -o two.ply
run 2 prepare - --in-place
run 2 prepare one.ply --in-place --json one.ply
cmp one.ply half.ply || fail "a wrong use of --in-place writes"
cp s.ply short.ply
truncate -s 100 short.ply
cp short.ply before.ply
run 3 prepare short.ply --in-place
cmp short.ply before.ply || fail "--in-place loses an input that it cannot read"

# A link is followed, be there something at its end or not; modes stay
mkdir real
ln -s real/there.ply there.ply
ln -s real/new.ply new.ply
ln -s there.ply again.ply
echo before > real/there.ply
chmod 640 real/there.ply
for name in there new again; do
  run 0 make torus -n 10 -o $name.ply
  [[ -L $name.ply ]] || fail "the link $name.ply is replaced"
done
run 0 info real/new.ply
run 0 info real/there.ply
[[ $(stat -c %a real/there.ply) == 640 ]] || fail "the mode of a replaced file becomes $(stat -c %a real/there.ply)"
ln -s loop.ply loop.ply
run 4 make torus -n 10 -o loop.ply
run 2 render s.ply -o there.ply -o real/there.ply
rm real/new.ply
run 2 render s.ply --size 16x16 -o new.ply -o real/new.ply

# Names as long as names can be
for ending in ply pfm; do
  long=$(printf 'x%.0s' {1..251}).$ending
  if [[ $ending == ply ]]; then
    run 0 make torus -n 10 -o "$long"
  else
    run 0 render s.ply --size 8x8 -o "$long"
  fi
  [[ -s $long ]] || fail "no file of a long name"
done

# Memory that fails in every thread is told once; and JSON is JSON whatever a file is called
"$conic" make sphere -n 200000 -o many.ply
for kib in 80000 100000 120000; do
  [[ ! $sanitized ]] || continue # which takes more memory
  (
    ulimit -v $kib
    exec "$conic" octree many.ply -o many.cot --threads 8 2> err
  )
  [[ $(wc -l < err) -le 1 ]] || fail "one failure, $(wc -l < err) lines: $(head -n 3 err)"
done
bad=$'\xff\xfe-\x01"\\.xyz'
printf '0 1e30 0\n' > "$bad"
run 0 info "$bad" --check --json -
if type -P python3 > /dev/null; then
  python3 -c 'import json, sys; json.loads(open(sys.argv[1], "rb").read().decode("utf-8"))' out || fail "no JSON: $(cat out)"
fi
run 3 render "$bad" -o a.pfm
[[ $(wc -l < err) -eq 1 ]] || fail "a name breaks the line: $(cat err)"
[[ $failures -eq 0 ]]
