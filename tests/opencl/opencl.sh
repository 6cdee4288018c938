#!/usr/bin/env bash
# conic devices and --device opencl: the same files as the CPU's, exit codes, the cache of built programs.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"
data=$1/../shared/data
# PoCL's machine code for the same programs, which takes half a minute, is that of the other tests.
export POCL_CACHE_DIR=${POCL_CACHE_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}/pocl} XDG_CACHE_HOME=$work/cache

run 2 render nothing.ply -o out.pfm --device banana
run 2 render nothing.ply -o out.pfm --device opencl:1
run 2 render nothing.ply -o out.pfm --device opencl:0.0x
run 2 render nothing.ply -o out.pfm --device opencl:0.0:scatter
run 2 render nothing.ply -o out.pfm --device opencl:gather:0.0
run 2 devices everything
run 0 make knot -n 20k -o knot.ply

if "$conic" --version | grep 'Not in this build' | grep -q OpenCL; then
  run 4 devices
  run 4 render knot.ply -o out.pfm --device opencl
  grep -q 'this build has no OpenCL' err || fail "does not say that it has no OpenCL: $(cat err)"
  [[ $failures -eq 0 ]] || exit 1
  echo "skipped: this build has no OpenCL"
  exit 77
fi

# A machine without any platform.
mkdir none
OCL_ICD_VENDORS=$work/none run 0 devices
grep -q 'no OpenCL device' out || fail "devices: does not say that there is none"
OCL_ICD_VENDORS=$work/none run 4 render knot.ply -o out.pfm --device opencl
[[ $(wc -l < err) -eq 1 && ! -e out.pfm ]] || fail "without a platform: $(cat err)"

run 0 devices --json devices.json
if ! grep -q '"opencl:' devices.json; then
  [[ $failures -eq 0 ]] || exit 1
  echo "skipped: no OpenCL device is there"
  exit 77
fi
run 4 render knot.ply -o out.pfm --device opencl:97.0
grep -q 'no such device' err || fail "a device that is not there: $(cat err)"

device=opencl
same() { # WHAT, RENDER'S ARGUMENTS …: the CPU's picture and the device's
  local what=$1
  shift
  run 0 render --aov all "$@" -o cpu.pfm --json cpu.json
  run 0 render --aov all "$@" -o device.pfm --json device.json --device $device
  for file in cpu*.pfm; do
    cmp -s "$file" "${file/cpu/device}" || fail "$what: $file differs"
  done
  for key in splats_culled splats_skipped splats_drawn splats_fallback fragments pixels_covered near epsilon \
    triangles_culled triangles_skipped triangles_drawn triangle_fragments; do
    [[ $(grep "\"$key\"" cpu.json) == "$(grep "\"$key\"" device.json)" ]] || fail "$what: $key differs"
  done
  diff <(sed -n '/"hash"/,/}/p' cpu.json) <(sed -n '/"hash"/,/}/p' device.json) > /dev/null || fail "$what: a hash differs"
  grep -q "\"device\": \"opencl:[0-9]*\.[0-9]*${device#opencl}\"" device.json || fail "$what: no device in the statistics"
}
for method in conic ray affine point disc auto; do
  same "knot, $method" knot.ply --size 200x150 --method $method
done
run 0 make cube -n 3k -o cube.ply
same "cube with clip lines" cube.ply --size 200x150 --background 0.1,0.2,0.3
same "samples" knot.ply --size 80x60 --samples 3
same "one pass" knot.ply --size 200x150 --passes 1 --shade lambert --light 1,2,3
run 0 octree knot.ply -o knot.cot
same "octree" knot.cot --size 200x150 --error 2
run 0 verify knot.ply --size 100x80 --device opencl
if [[ -f $data/lion.ply ]]; then
  same "lion" "$data/lion.ply" --size 300x300 --up z
else
  echo "lion is left out: $data/lion.ply is not there"
fi

# Gaussian scenes, whose program is the only one that they need.
row='\0\0\0\0\0\0\200\77\0\0\0\100\0\0\200\77\0\0\200\77\0\0\0\77\1\2\3\4\200\177\200\200'
printf "$row$row" > two.splat
scene=two.splat
[[ ! -f $data/gaussians/biker.spz ]] || scene=$data/gaussians/biker.spz
mv cache other-cache
for profile in exact gsplat-1.6 2dgs-2024; do
  same "Gaussians, $profile" "$scene" --profile $profile --size 90x70 --samples 2 \
    --aov rgba,Z,N,count,id,T,medianZ,inverseZ,last
done
run 0 verify two.splat --profile gsplat-1.6 --size 40x40 --device opencl
[[ $(cd cache/conic && echo *) =~ ^gaussian_tiles-[0-9a-f]*.bin$ ]] || fail "Gaussians built $(ls cache/conic)"
rm -r cache && mv other-cache cache

# Meshes as triangles, whose program nobody needed before.
[[ -z $(ls cache/conic/triangles-*.bin 2> /dev/null) ]] || fail "the triangles' program was built for splats"
printf 'v %s 0 2\nv 0.9 %s 0\nv -1 1 0.3\nv 0.1 -1 0.2\nf 1 2 3\nf 1 2 4\nf 4 3 1\nf 2 3 4\n' 0.2 0.4 > tetrahedron.obj
same "mesh" tetrahedron.obj --as mesh --size 120x90
same "mesh, samples" tetrahedron.obj --as mesh --size 50x40 --samples 2 --cull back
if [[ -f $data/cow.obj ]]; then
  run 0 hybrid "$data/cow.obj" -o cow.chy
  same "hybrid" cow.chy --size 200x150
fi
[[ ! -f $data/spot.obj ]] || same "spot" "$data/spot.obj" --as mesh --size 200x150
ls cache/conic/triangles-*.bin > /dev/null || fail "the triangles' program was not kept"

# The same as on a GPU, by name.
device=opencl:gather
same "knot by pixels" knot.ply --size 100x75
grep -q '"tile": 16' device.json || fail "gather has the tiles of lanes"
same "Gaussians by pixels" two.splat --profile exact --size 45x35 --aov rgba,Z,N,count,id
ls cache/conic/gaussian_pixels-*.bin > /dev/null || fail "gather drew Gaussians by $(ls cache/conic)"
device=opencl:lanes
same "knot by tiles" knot.ply --size 100x75
grep -q '"tile": 32' device.json || fail "lanes has the tiles of gather"
device=opencl

# What was built is kept, whole; what is not whole is built anew.
ls cache/conic/setup-*.bin cache/conic/raster-*.bin > /dev/null || fail "no program was kept"
[[ -z $(find cache/conic -type f ! -name '*.bin') ]] || fail "the cache has more than programs: $(ls cache/conic)"
for kept in cache/conic/*.bin; do
  head -c 1000 "$kept" > part && mv part "$kept"
done
same "after the cache was spoiled" knot.ply --size 64x48
mkdir other && printf x > other/conic # no folder, and none can be made
XDG_CACHE_HOME=$work/other run 0 render knot.ply -o out.pfm --size 64x48 --device opencl
[[ $failures -eq 0 ]]
