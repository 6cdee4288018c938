#!/usr/bin/env bash
# Frames that are kept belong to what decides them: they are gone on with however the options are spelled, and never
# where anything has changed that was read, also what an input only leads to.
set -uo pipefail

source "$1/tests/support/program.bash"
"$conic" make knot -n 2000 -q -o k.ply

# refuses NAME: with the options at hand, what is kept is not gone on with
refuses() {
  run_as_typed 3 render "${picture[@]}" --resume "$out" -o "$out"
  grep -q 'cannot go on: it was begun with other inputs or options' err || fail "$1: $(cat err)"
}
takes() { # NAME ARGUMENTS …
  run_as_typed 0 render "${@:2}" --resume "$out" -o "$out"
  grep -q 'of . frames were finished' err || fail "$1: nothing of what was finished is taken: $(cat err)"
}

# Spelling
out=tt.png
begun=(k.ply --turntable 3 --size 24x24 --samples 1)
run_as_typed 0 render "${begun[@]}" -o $out --resumable
takes 'the same' "${begun[@]}"
takes 'another order' --samples 1 --size 24x24 k.ply --turntable 3
takes 'equals signs' k.ply --turntable=3 --size=24x24 --samples=1
takes 'a folder' ./k.ply --turntable 3 --size 24x24 --samples 1
takes 'explicit defaults' "${begun[@]}" --azimuth 30 --fov 40 --shade phong --cull none --kernel gauss --light studio --passes 3
takes 'what changes no bit' "${begun[@]}" --device cpu --threads 1 --tile 16 --isa scalar --json t.json
cp k.ply moved.ply
takes 'another name' moved.ply --turntable 3 --size 24x24 --samples 1
for change in '--samples 2' '--size 24x25' '--azimuth 31' '--tone agx' '--no-shot' '--light 1,2,3' '--near 0.2'; do
  picture=(k.ply --turntable 3 --size 24x24 --samples 1)
  # shellcheck disable=SC2206
  picture+=($change)
  refuses "$change"
done
picture=("${begun[@]}")
printf 'x' | dd of=k.ply bs=1 seek=9000 conv=notrunc 2> dd.err
refuses 'another input of the same length'
cp moved.ply k.ply

# is_kept NAME CHANGE …: begun, then changed by a command, then refused; and without the change gone on with
is_kept() {
  local name=$1
  shift
  rm -f ./*.frames
  run_as_typed 0 render "${picture[@]}" -o "$out" --resumable
  takes "$name" "${picture[@]}"
  "$@"
  refuses "$name"
}
replace() { # FROM TO FILE: of the same length
  LC_ALL=C sed -i "s/$1/$2/" "$3"
  touch -d @1 "$3"
}

# Cameras: a folder of COLMAP, as text and as binary, transforms.json, and arrays
mkdir colmap
printf '1 PINHOLE 24 24 24 24 12 12\n' > colmap/cameras.txt
printf '1 1 0 0 0 0 0 5 1 a.jpg\n\n2 1 0 0 0 0 0 6 1 b.jpg\n\n' > colmap/images.txt
printf '' > colmap/points3D.txt
out='view_%s.png'
picture=(k.ply --camera colmap --view all --size 24x24)
is_kept COLMAP replace '0 0 6 1 b' '0 0 7 1 b' colmap/images.txt
cat > transforms.json << END
{"w": 24, "h": 24, "fl_x": 24, "fl_y": 24, "cx": 12, "cy": 12, "frames": [
 {"file_path": "a.png", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,5],[0,0,0,1]]},
 {"file_path": "b.png", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,6],[0,0,0,1]]}]}
END
picture=(k.ply --camera transforms.json --view all --size 24x24)
is_kept transforms.json replace '1,6' '1,7' transforms.json
if command -v python3 > /dev/null; then
  cat > arrays.py << 'END'
import io, struct, sys, zipfile
def array(shape, values, kind):
    head = "{'descr': '<%s', 'fortran_order': False, 'shape': %s, }" % (kind, shape)
    head += " " * (-(len(head) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\0" + struct.pack("<H", len(head)) + head.encode() + struct.pack(
        "<%d%s" % (len(values), "d" if kind == "f8" else "q"), *values)
views = []
for z in (5, float(sys.argv[1])):
    views += [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, z, 0, 0, 0, 1]
with zipfile.ZipFile("cameras.npz", "w") as file:
    file.writestr("viewmats.npy", array((2, 4, 4), views, "f8"))
    file.writestr("Ks.npy", array((2, 3, 3), [24, 0, 12, 0, 24, 12, 0, 0, 1] * 2, "f8"))
    file.writestr("width.npy", array((), [24], "i8"))
    file.writestr("height.npy", array((), [24], "i8"))
END
  python3 arrays.py 6
  out='view_%d.png'
  picture=(k.ply --camera cameras.npz --view all --size 24x24)
  is_kept arrays python3 arrays.py 7
fi

# What a mesh leads to: materials, textures, a glTF's buffer
out=turn.png
"$conic" render k.ply --size 16x16 --background 0.1,0.2,0.3 -q -o red.png --no-shot
"$conic" render k.ply --size 16x16 --background 0.4,0.2,0.3 -q -o blue.png --no-shot
printf 'v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nmtllib m.mtl\nusemtl a\nf 1/1 2/2 3/3 4/4\n' > m.obj
printf 'newmtl a\nKd 0.5 0.6 0.7\nmap_Kd t.png\n' > m.mtl
cp red.png t.png
picture=(m.obj --turntable 2 --size 24x24)
is_kept 'a material' replace 'Kd 0.5' 'Kd 0.4' m.mtl
is_kept 'a texture' cp blue.png t.png
triangle() { # Z: nine floats and three indices of 16 bits
  printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\200'"$1"'\0\0\1\0\2\0\0\0' > g.bin
}
triangle '\77'
cat > g.gltf << END
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
 "buffers": [{"uri": "g.bin", "byteLength": 44}],
 "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 2]},
{"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}]}
END
picture=(g.gltf --turntable 2 --size 24x24)
is_kept 'a buffer' triangle '\100'

# A motion's shape, and a sky
cp k.ply shape.ply
"$conic" make knot -n 2000 --jitter 0.5 -q -o other.ply
printf '[{"input": 0, "frame": 1, "file": "shape.ply"}]' > m.json
picture=(k.ply --turntable 2 --size 16x16 --accumulate 2 --motion m.json --shutter 0:1)
is_kept "a motion's shape" cp other.ply shape.ply
printf 'PF\n2 1\n-1.0\n' > sky.pfm
printf '\0\0\200\77\0\0\200\77\0\0\200\77\0\0\200\77\0\0\200\77\0\0\200\77' >> sky.pfm
brighten() {
  printf '\0\0\0\100' | dd of=sky.pfm bs=1 seek=12 conv=notrunc 2> dd.err
}
picture=(k.ply --turntable 2 --size 16x16 --sky sky.pfm --ao 4)
is_kept 'a sky' brighten

exit $((failures > 0))
