#!/usr/bin/env bash
# Every command's JSON is as docs/reference/json.schema.json says, and has the keys that scripts rely on; no fault in it
# would go unseen. The checks themselves stand in json_schema.py.
set -euo pipefail

source_folder=$1
program=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir out
failures=0

python=
for candidate in python3 /usr/bin/python3; do
  "$candidate" -c 'import jsonschema; jsonschema.Draft202012Validator' 2> /dev/null && python=$candidate && break
done
if [[ -z $python ]]; then
  echo "skipped: python3-jsonschema is not installed"
  exit 77
fi
if ! "$program" --version | grep -q '^In this build:.*OpenEXR'; then
  echo "skipped: the runs draw EXR files, which this build does not write"
  exit 77
fi
has_zstd=0
if "$program" --version | grep -q '^In this build:.*zstd'; then
  has_zstd=1
fi

# run NAME DEFINITION ARGUMENTS …: NAME is one of `wanted` or the run's own.
run() {
  local name=$1 definition=$2 status=0
  shift 2
  "$program" "$@" --json - > "out/$name.json" 2> err < /dev/null || status=$?
  if [[ $status -ne 0 && ! ($status -eq 1 && $definition == diff) ]]; then
    echo "FAILED: $name: $(cat err)"
    failures=$((failures + 1))
  else
    echo "$definition" > "out/$name.definition"
  fi
}

# The keys that scripts rely on.
builder="points_in points_out seconds.read seconds.work seconds.write seconds.total points_per_s peak_rss_bytes
  skipped.nan skipped.zero skipped.duplicate skipped.isolated skipped.failed"
render="splats_in splats_culled splats_skipped splats_drawn splats_fallback fragments pixels_covered overdraw method
  device isa threads tile epsilon_mode epsilon near primitives.splats clouds_culled hash.rgba hash.Z
  ms.read ms.estimate ms.lod ms.setup ms.bin ms.visibility ms.accumulate ms.resolve ms.write ms.frame ms.total
  ms_first msplats_per_s drawn_msplats_per_s mfragments_per_s peak_rss_bytes"
declare -A wanted=(
  [make]=$builder
  [prepare]=$builder
  [octree]="$builder bytes_per_point inner_nodes levels"
  [hybrid]="triangles surfels clusters seconds.read seconds.work seconds.write seconds.total peak_rss_bytes skipped.nan"
  [layer]="$builder clouds levels bytes bits_per_sample spacing quantum"
  [mls-project]="$builder type plane weight h outcomes.done outcomes.too_few moved.rms moved.max"
  [mls-thin]="$builder error hausdorff to_thinned.max from_thinned.max"
  [mls-densify]=$builder
  [render]="$render methods.conic"
  [render-octree]="$render methods.conic primitives.inner_nodes primitives.leaves error_px"
  [render-mesh]="$render primitives.triangles triangles_in triangles_culled triangles_skipped triangles_drawn
    triangle_fragments mtriangles_per_s"
  [render-patches]="$render methods.conic primitives.patches primitives.samples"
  [render-hybrid]="$render methods.conic triangles_drawn? primitives.triangles? primitives.surfel_patches error_px"
  [render-layers]="$render methods.conic error_px layers.clouds layers.places_coarser layers.clouds_missing"
  [diff]="identical max_abs rmse p999 psnr ssim flip over_code differing_pixels largest_hole planes.rgba.max_abs
    planes.rgba.rmse"
  [verify]="against method planes.rgba.max_abs planes.rgba.p999 planes.id.max_abs bound.rgba bound.Z compared_pixels
    unstable_pixels covered_pixels undecided_ids unstable_limit unstable_by_reason.cutoff unstable_by_reason.visibility
    ms.render ms.oracle pass"
  [explain]="method pixel? planes.rgba planes.weight planes.id threshold counts.visible counts.hidden contributions"
  [explain-hybrid]="method pixel? planes.rgba planes.cluster threshold contributions blended? triangles?"
  [chart]="scenes methods points seconds"
  [bench]="lines wrong_pictures peak_rss_bytes machine?"
  [info]="kind points bytes? bytes_per_point? bounds.min bounds.max sound?"
  [info-octree]="kind points nodes inner_nodes levels bytes bytes_per_point bounds.min bounds.max sound?"
  [info-hybrid]="kind triangles surfels nodes levels bytes bounds.min bounds.max sound?"
  [info-layers]="kind points clouds levels bytes bytes_per_point bits_per_sample bits.position bits.normal bits.colour
    bits.index bounds.min bounds.max sound?"
)

printf 'v %s\n' '0 0 0' '1 0 0' '1 0 1' '0 0 1' '.5 .5 .5' '4 0 0' '4 0 1' > tent.obj
printf 'f %s\n' '1 5 2' '2 5 3' '3 5 4' '4 5 1' '2 3 7 6' >> tent.obj
printf 'v -1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > triangle.obj
printf '%s\n' '0 0 0' '1e30 0 0' '0 1e30 0' > far.xyz

run make make make knot -n 50k -o knot.ply
run prepare prepare prepare knot.ply -o thin.ply --count 20000 --seed 1
run octree octree octree knot.ply -o knot.cot
run hybrid hybrid hybrid tent.obj -o tent.chy --largest 1 --phase1 -0.1 --phase2 0.1 --most-error 0
run mls-project mls_project mls project knot.ply -o clean.ply
run mls-spheres mls_project mls project thin.ply -o clean.ply --type apss
run mls-thin mls_thin mls thin thin.ply -o thinner.ply --count 10k
run mls-densify mls_densify mls densify thinner.ply -o dense.ply --spacing 0.7x
run render render render knot.ply -o knot.exr --aov all
run render-octree render_octree render knot.cot -o lod.exr --error 2
run render-mesh render_mesh render triangle.obj --as mesh --size 256x256 -o triangle.exr
run render-patches render_patches render thin.ply -o patches.exr --method patch --zoom 4 --size 256x256
run render-hybrid render_hybrid render tent.chy -o tent.exr
run render-cluster render_hybrid render tent.chy -o tent.exr --aov cluster --only surfels
run render-auto render render knot.ply -o auto.exr --method auto --zoom 20
run render-other render render thin.ply -o other.exr --method disc --samples 2 --epsilon 2x
run diff diff diff knot.exr lod.exr
run diff-sizes diff diff knot.exr triangle.exr
run verify verify verify thinner.ply --size 160x120
run verify-samples verify verify thinner.ply --size 40x30 --samples 2
run make-one make make plane -n 1 -o one.ply
run verify-exact verify verify one.ply --size 12x9 --against exact
run explain explain explain one.ply --size 64x48 --pixel 30,20
run explain-splat explain explain one.ply --size 64x48 --splat 0
run explain-octree explain explain knot.cot --size 64x48 --error 1 --splat 9 --pixel 32,24
run explain-leaf explain explain knot.cot --size 2048x2048 --error 0.5 --splat 9
run explain-hybrid explain explain tent.chy --size 64x48 --pixel 30,25 --only triangles
run explain-mixed explain explain tent.chy --size 64x48 --pixel 14,24 --splat 9
run chart chart chart -o chart --quick
run bench-old bench bench --scenes sphere-20k --size 256x256 --isa scalar --threads 1 --repeat 5
cp out/bench-old.json old.json
run bench bench bench --scenes sphere-20k --size 256x256 --isa scalar --threads 1 --repeat 5 --floor --compare old.json
run info info_model info knot.ply --check
run info-mesh info_model info triangle.obj
run info-far info_model info far.xyz --check
run info-image info_image info knot.exr --check
run info-octree info_octree info knot.cot --check
run info-hybrid info_hybrid info tent.chy --check
run devices devices devices
# What no run above writes, or not on every machine.
unseen="device.name device.platform device.version device.driver device.is_cpu device.has_double
  device.rounds_correctly device.compute_units device.memory_bytes"
if [[ $has_zstd -eq 1 ]]; then
  run layer layer layer knot.ply -o knot.lpc
  run render-layers render_layers render knot.lpc -o layers.exr --error 4
  run render-progressive render_layers render knot.lpc -o layers.exr --error 4 --size 64x64 --progressive pictures
  run info-layers info_layers info knot.lpc --check
else
  unset "wanted[layer]" "wanted[render-layers]" "wanted[info-layers]"
  unseen+=" $("$python" -c 'import json, sys
def keys(part, path):
  for key, inner in part.get("properties", {}).items():
    yield path + "." + key
    yield from keys(inner, path + "." + key)
definitions = json.load(open(sys.argv[1]))["$defs"]
print(*(key for name in ("layer", "layers_drawn", "info_layers") for key in keys(definitions[name], name)))' \
    "$source_folder/docs/reference/json.schema.json") render.layers"
fi

for name in "${!wanted[@]}"; do
  # shellcheck disable=SC2086 # the keys are words
  echo "$name" ${wanted[$name]}
done > out/wanted
echo "$unseen" > out/unseen
"$python" "$source_folder/tests/json_schema.py" "$source_folder/docs/reference/json.schema.json" out || failures=$((failures + 1))
[[ $failures -eq 0 ]]
