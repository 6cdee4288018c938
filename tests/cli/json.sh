#!/usr/bin/env bash
# Every command's JSON is as docs/reference/json.schema.json says, and has the keys that scripts rely on; no fault in it
# would go unseen. The checks themselves stand in json_schema.py.
set -uo pipefail

source "$1/tests/support/program.bash"
schema=$1/docs/reference/json.schema.json
check=$1/tests/cli/json_schema.py
mkdir runs

python=
for candidate in python3 /usr/bin/python3; do
  "$candidate" -c 'import jsonschema; jsonschema.Draft202012Validator' 2> /dev/null && python=$candidate && break
done
if [[ -z $python ]]; then
  echo "skipped: python3-jsonschema is not installed"
  exit 77
fi
if ! "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  echo "skipped: the runs draw EXR files, which this build does not write"
  exit 77
fi
has_zstd=0
if "$conic" --version | grep -q '^In this build:.*zstd'; then
  has_zstd=1
fi

# write NAME DEFINITION ARGUMENTS …: what a run writes goes to runs/NAME.json.
write() {
  local name=$1 definition=$2 exit_code=0
  shift 2
  if [[ $name == diff* || $name == *-wrong ]]; then
    exit_code=1
  fi
  run $exit_code "$@" --json -
  cp out "runs/$name.json"
  echo "$definition" > "runs/$name.definition"
}

# The keys that scripts rely on.
builder="points_in points_out seconds.read seconds.work seconds.write seconds.total points_per_s peak_rss_bytes
  skipped.nan skipped.zero skipped.duplicate skipped.isolated skipped.failed"
render="splats_in splats_culled splats_skipped splats_drawn splats_fallback fragments pixels_covered overdraw method
  device isa threads tile epsilon_mode epsilon near primitives.splats clouds_culled hash.rgba hash.Z
  ms.read ms.estimate ms.lod ms.setup ms.bin ms.visibility ms.accumulate ms.resolve ms.write ms.frame ms.total
  ms_first msplats_per_s drawn_msplats_per_s mfragments_per_s peak_rss_bytes shot_key?"
declare -A wanted=(
  [make]=$builder
  [prepare]=$builder
  [octree]="$builder bytes_per_point inner_nodes levels"
  [hybrid]="triangles surfels clusters seconds.read seconds.work seconds.write seconds.total peak_rss_bytes skipped.nan"
  [hybrid-points]="points_in? splats_kept?"
  [layer]="$builder clouds levels bytes bits_per_sample spacing quantum"
  [cut]=$builder
  [merge]="$builder clouds levels bytes bits_per_sample spacing quantum"
  [mls-project]="$builder type plane weight h outcomes.done outcomes.too_few moved.rms moved.max merged"
  [mls-thin]="$builder error hausdorff to_thinned.max from_thinned.max"
  [mls-densify]="$builder flat"
  [csg]="operation points_in points_out of_first of_second clipped unclipped seconds.work"
  [render]="$render methods.conic"
  [render-octree]="$render methods.conic primitives.inner_nodes primitives.leaves error_px error_px_asked?"
  [render-team]="$render team.shares team.processes"
  [render-accumulated]="$render accumulated.samples accumulated.resumed accumulated.noise? accumulated.focus?"
  [render-kept]="$render frames_finished?"
  [render-odd]="$render skipped.nan? skipped.zero? skipped.duplicate? skipped.isolated? skipped.failed?"
  [render-lit]="$render ao? shadow? lamps? ms.light hash.ao hash.shadow"
  [render-steep]="$render methods.conic methods.laplace"
  [render-mesh]="$render primitives.triangles triangles_in triangles_culled triangles_skipped triangles_drawn
    triangle_fragments mtriangles_per_s"
  [render-patches]="$render methods.conic primitives.patches primitives.samples"
  [render-hybrid]="$render methods triangles_drawn? primitives.triangles? primitives.surfel_patches error_px
    color_error chunks.drawn chunks.bytes_read"
  [render-layers]="$render methods.conic error_px layers.clouds layers.places_coarser layers.clouds_missing"
  [diff]="identical max_abs rmse p999 psnr ssim flip over_code differing_pixels largest_hole planes.rgba.max_abs
    planes.rgba.rmse"
  [diff-folders]="identical matched_by views_past_limits mean.psnr mean.ssim mean.flip views only_in_a only_in_b"
  [verify]="against method planes.rgba.max_abs planes.rgba.p999 planes.id.max_abs bound.rgba bound.Z judged_pixels
    compared_pixels unstable_pixels covered_pixels undecided_ids unbounded_pixels unbounded_limit wrong_pixels
    unstable_by_reason.cutoff unstable_by_reason.visibility ms.render ms.oracle pass"
  [explain]="method pixel? planes.rgba planes.weight planes.id threshold counts.visible counts.hidden contributions"
  [explain-hybrid]="method pixel? planes.rgba planes.cluster threshold contributions blended? triangles?"
  [verify-gaussians]="against profile planes.rgba.max_abs planes.rgba.widest planes.last.max_abs judged_pixels
    covered_pixels classes.equal classes.rounded classes.explained classes.wrong doubtful_pixels
    doubtful_by_reason.order explained_by_reason.order wide_pixels wrong_pixels ms.render ms.oracle pass"
  [judge-wrong]="verdict pixels.equal pixels.rounding pixels.explained pixels.wrong diagnosis explained_by worst
    profile? judged_pixels planes.rgba.max_abs? seconds.judge"
  [judge-splats-wrong]="verdict pixels.wrong method? explained_by.cutoff? worst"
  [explain-among]="profile pixel surface.depth surface.weight counts.behind contributions"
  [explain-gaussians]="profile pixel planes.rgba planes.last bounds.rgb.low bounds.T.high end doubts doubt
    counts.composited contributions"
  [help]="version commands"
  [gradient]="profile parameters width height gaussians shown loss camera.world_to_camera camera.fx greatest.mean
    doubtful? doubtful_by_reason.least? ms.gradient"
  [judge-gradients]="verdict profile parameters gaussians.equal gaussians.rounding gaussians.explained gaussians.wrong
    kinds.mean.wrong? kinds.sh.max_abs? worst ms.judge"
  [project]="profile floats gaussians shown tile_width tile_height isects ms.project"
  [judge-intermediates]="verdict profile floats arrays ms.judge"
  [judge-intermediates-wrong]="verdict stage? arrays"
  [chart]="scenes methods points seconds"
  [bench]="host lines wrong_pictures peak_rss_bytes machine?"
  [info]="kind points bytes? bytes_per_point? bounds.min bounds.max sound?"
  [info-octree]="kind points nodes inner_nodes levels bytes bytes_per_point bounds.min bounds.max sound?"
  [info-gaussians]="kind gaussians sh_degree 2d antialiased bytes? bounds.min bounds.max sound?"
  [info-cameras]="kind format views"
  [convert]="kind_in kind_out gaussians sh_degree_in sh_degree_out reordered lossless? lost? differences.position
    differences.scale differences.rotation_deg differences.opacity differences.color differences.harmonics pictures.views?
    pictures.psnr? pictures.greatest? bytes?"
  [conformance]="floats cases files bytes levels seconds.scenes seconds.bounds seconds.write seconds.total"
  [suite-wrong]="verdict total.cases total.right total.wrong total.missing levels cases extra_pictures"
  [info-hybrid]="kind triangles surfels nodes levels bytes bounds.min bounds.max sound?"
  [info-kept]="kind values?"
  [info-layers]="kind points clouds levels bytes bytes_per_point bits_per_sample bits.position bits.normal bits.colour
    bits.index bounds.min bounds.max sound?"
)

printf 'v %s\n' '0 0 0' '1 0 0' '1 0 1' '0 0 1' '.5 .5 .5' '4 0 0' '4 0 1' > tent.obj
printf 'f %s\n' '1 5 2' '2 5 3' '3 5 4' '4 5 1' '2 3 7 6' >> tent.obj
printf 'v -1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > triangle.obj
printf '%s\n' '0 0 0' '1e30 0 0' '0 1e30 0' > far.xyz
printf '%s\n' 2 1 '0 0 0' '1 0 0' '0 1 0' '0 0 1' '1 0 0 0' '0 1 0 0' '0 0 1 0' '0 0 0 1' '1 2 3 0.5' '0 0 0 0' > scan.ptx
printf '%s\n' ply 'format ascii 1.0' 'comment crs EPSG:32633' 'element vertex 3' 'property float x' 'property float y' \
  'property float z' end_header '1 2 3' '1 3 3' '2 3 3' > placed.ply
for i in {1..60}; do echo "$i 0 0"; done > wire.xyz
printf '%s\n' '0 0 0' '1 0 0' '0 1 0' '1 1 0' '1 1 0' 'nan 0 0' > odd.xyz

write make make make knot -n 12k -o knot.ply
write prepare prepare prepare knot.ply -o thin.ply --count 8000 --seed 1
write prepare-dots prepare prepare wire.xyz -o wire.ply
write octree octree octree knot.ply -o knot.cot
write hybrid hybrid hybrid tent.obj -o tent.chy --largest 1 --phase1 -0.1 --phase2 0.1 --most-error 0
write mls-project mls_project mls project knot.ply -o clean.ply
write mls-spheres mls_project mls project thin.ply -o clean.ply --type apss
write mls-thin mls_thin mls thin thin.ply -o thinner.ply --count 2k
write mls-densify mls_densify mls densify thinner.ply -o dense.ply --spacing 0.7x
write csg csg csg knot.ply clean.ply -o solid.ply --union
write sheet sheet sheet knot.ply --plan --section 0,0:1,0 --dpi 20 -o sheet.png
sed '0,/^end_header/s//comment crs EPSG:32632\nend_header/' knot.ply > placed.ply
write sheet-placed sheet sheet placed.ply --dpi 20 -o sheet.png
write contact contact contact knot.ply sheet.png -o contact.png --size 32
write render render render knot.ply -o knot.exr --aov all --size 256x256
write render-accumulated render render knot.ply -o accumulated.exr --accumulate 4 --aperture 0.1 --size 64x64
write render-kept render render knot.ply --turntable 2 -o turn.exr --resumable --resume turn.exr --size 32x32
if [[ -x $3/bin/conic-mpi ]] && command -v mpirun > /dev/null; then
  OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --oversubscribe -n 2 "$3/bin/conic-mpi" render knot.ply \
    --plain -o team.exr --aov all --size 64x64 --json runs/render-team.json < /dev/null || fail "two ranks cannot draw"
  echo render > runs/render-team.definition
fi
write render-octree render_octree render knot.cot -o lod.exr --error 2 --size 256x256
write render-lean render render knot.ply -o lean.exr --error 2 --size 64x48
write render-mesh render_mesh render triangle.obj --as mesh --size 256x256 -o triangle.exr
write render-patches render_patches render thin.ply -o patches.exr --method patch --zoom 4 --size 256x256
write render-hybrid render_hybrid render tent.chy -o tent.exr
write render-cluster render_hybrid render tent.chy -o tent.exr --aov cluster --only surfels
write render-auto render render knot.ply -o auto.exr --method auto --zoom 20 --size 256x256
run 0 make plane -n 3000 -o sheet.ply
write render-steep render render sheet.ply -o steep.exr --method auto --azimuth 87 --elevation 0
write render-other render render thin.ply -o other.exr --size 256x256 --method disc --samples 2 --epsilon 2x
write render-dots render render wire.ply -o wire.exr --size 64x64
write render-odd render render odd.xyz -o odd.exr --size 64x64
grep -q '"nan": 1,' runs/render-odd.json || fail "render does not count what it leaves out"
grep -q '"duplicate": 1,' runs/render-odd.json || fail "render does not count what lies where others are"
write render-odd-patches render_patches render odd.xyz -o odd.exr --size 64x64 --method patch
grep -q '"nan": 1,' runs/render-odd-patches.json || fail "render does not count what it lays no patches about"
write render-top render render knot.ply --camera top:0.1:26910 --shade phong -o top.tif
write render-lit render render knot.ply -o lit.exr --aov rgba,ao,shadow --ao 4 --shadow --size 64x64 \
  --light 1,2,3:1:2deg --light lamp:1,2,3:4:0.1 --light lamp:0,3,0:5:0.4x0.2:0,-1,0
write render-sky render render knot.ply -o sky.exr --sky knot.exr --ao 2 --size 32x32
write render-colored render render knot.ply -o height.exr --color-by height --size 64x64
write prepare-baked prepare prepare knot.ply -o baked.ply --bake color --directions 4
write prepare-colored prepare prepare knot.ply -o colored.ply --color-by x
write octree-colored octree octree colored.ply -o colored.cot --color-by height
write hybrid-colored hybrid hybrid tent.obj -o colored.chy --color-by height
write hybrid-points hybrid hybrid thinner.ply -o knot.chy
write diff diff diff knot.exr lod.exr
write diff-sizes diff diff knot.exr triangle.exr
mkdir first second
cp knot.exr first/a.exr
cp lod.exr second/a.exr
cp knot.exr first/b.exr
write diff-folders diff_folders diff first second
write verify verify verify thinner.ply --size 160x120
write verify-samples verify verify thinner.ply --size 40x30 --samples 2
write render-prefiltered render render thinner.ply --size 160x120 --prefilter 1.01 -o prefiltered.exr
write verify-wrong verify verify thinner.ply --size 160x120 --pixels 500 --image prefiltered.exr
write make-one make make plane -n 1 -o one.ply
write verify-sample verify verify thinner.ply --size 40x30 --sample 3 --aperture 0.1
write verify-accumulated verify verify thinner.ply --size 40x30 --accumulate 2
write verify-exact verify verify one.ply --size 12x9 --against exact
write explain explain explain one.ply --size 64x48 --pixel 30,20
printf '\0\0\0\0\0\0\200\77\0\0\0\100\0\0\200\77\0\0\200\77\0\0\0\77\1\2\3\4\200\177\200\200' > two.splat
write verify-gaussians verify_gaussians verify two.splat --profile exact --size 40x40
write verify-gaussians-sample verify_gaussians verify two.splat --profile exact --size 20x20 --sample 3
write verify-gaussians-mean verify_gaussians verify two.splat --profile exact --size 20x20 --accumulate 2
write verify-gaussians-samples verify_gaussians verify two.splat --profile inria-2023 --size 20x20 --samples 2
run 0 render two.splat --profile gsplat-1.6 --size 40x40 -o two.exr
write verify-gaussians-wrong verify_gaussians verify two.splat --profile khr-2026 --size 40x40 --image two.exr
write judge-wrong judge judge two.splat --profile khr-2026 --size 40x40 --picture two.exr
camera='"width": 40, "height": 40, "fx": 40, "fy": 40, "world_to_camera": [[1,0,0,0],[0,-1,0,0],[0,0,-1,4],[0,0,0,1]]'
echo "{$camera, \"cx\": 20, \"cy\": 20}" > middle.json
echo "{$camera, \"cx\": 20.5, \"cy\": 20.5}" > off.json
run 0 make gaussians -n 30 -o many.ply
run 0 render many.ply --camera off.json --profile gsplat-1.6 --background 1,1,1 -o off.exr
write judge-two-wrong judge judge many.ply --camera middle.json --profile gsplat-1.6 --picture off.exr
run 0 render many.ply --camera off.json --profile gsplat-1.6 --background 1,1,1 -o tile.pfm
python3 - << 'P' # no red anywhere; and the tile at 1, 1 is black; rows come from below
data = open("tile.pfm", "rb").read()
head, rows = data[:-40 * 40 * 12], bytearray(data[-40 * 40 * 12:])
red = bytearray(rows)
for i in range(0, len(red), 12):
    red[i:i + 4] = bytes(4)
open("red.pfm", "wb").write(head + red)
for y in range(8, 24):
    rows[(y * 40 + 16) * 12:(y * 40 + 32) * 12] = bytes(16 * 12)
open("tile.pfm", "wb").write(head + rows)
P
write judge-tile-wrong judge judge many.ply --camera off.json --profile gsplat-1.6 --background 1,1,1 --picture tile.pfm
write judge-red-wrong judge judge many.ply --camera off.json --profile gsplat-1.6 --background 1,1,1 --picture red.pfm
write judge-splats-wrong judge judge thinner.ply --size 160x120 --picture prefiltered.exr
write judge-mesh-wrong judge judge triangle.obj --as mesh --size 256x256 --picture triangle.exr --shade none
cat two.splat two.splat > copies.splat
write judge-copies-wrong judge judge copies.splat --profile gsplat-1.6 --size 40x40 --picture two.exr
write explain-sample explain explain one.ply --size 64x48 --pixel 30,20 --sample 3
write explain-gaussians explain_gaussians explain two.splat --profile exact --size 40x40 --pixel 20,20
printf 'v -9 -9 3\nv 9 -9 3\nv 0 12 3\nf 1 3 2\n' > wall.obj
write explain-among explain_gaussians explain two.splat wall.obj --profile exact --size 40x40 --pixel 20,20
write gradient gradient gradient two.splat --profile gsplat-1.6 --size 40x40 --weights two.exr
run 0 gradient two.splat --profile gsplat-1.6 --size 40x40 --weights two.exr -o two-g.ply --quiet
write judge-gradients judge_gradients judge two.splat --profile gsplat-1.6 --size 40x40 --weights two.exr \
  --gradients two-g.ply
write judge-gradients-wrong judge_gradients judge two.splat --profile gsplat-1.6 --size 40x40 --weights two.exr --raw \
  --gradients two-g.ply
write project-exact project project two.splat --profile exact --size 40x40
grep -q '"shown": 1,' runs/project-exact.json || fail "project --profile exact: not 1 shown"
run 2 project two.splat --profile exact --projection fisheye --size 40x40 -o two.npz
grep -q '^conic: error: project: the camera is fisheye' err || fail "project names another command: $(head -c 200 err)"
write project project project two.splat --profile gsplat-1.6 --size 40x40 -o two.npz
write judge-intermediates judge_intermediates judge two.splat --profile gsplat-1.6 --size 40x40 --intermediates two.npz
write judge-intermediates-wrong judge_intermediates judge two.splat --profile gsplat-1.6 --size 40x70 \
  --intermediates two.npz
write explain-splat explain explain one.ply --size 64x48 --splat 0
write explain-octree explain explain knot.cot --size 64x48 --error 1 --splat 9 --pixel 32,24
write explain-leaf explain explain knot.cot --size 2048x2048 --error 0.5 --splat 9
write explain-hybrid explain explain tent.chy --size 64x48 --pixel 30,25 --only triangles
write explain-mixed explain explain tent.chy --size 64x48 --pixel 14,24 --splat 9
write chart chart chart knot.cot -o chart --quick --over samples=1:2 --time 9
write bench-old bench bench --scenes sphere-2k --size 128x128 --isa scalar --threads 1 --repeat 2
cp runs/bench-old.json old.json
write bench bench bench --scenes sphere-2k --size 128x128 --isa scalar --threads 1 --repeat 2 --floor --compare old.json
write bench-simulated bench bench --scenes sphere-2k --size 128x128 --threads 1 --repeat 3 --simulate-threads 2,40
write bench-command bench bench --command "render knot.cot -o b.pfm --size 64x48" --repeat 2 --simulate-threads 4
write bench-chosen bench bench knot.cot --error 2 --size 64x48 --threads 1 --repeat 1
write info info_model info knot.ply --check
write info-mesh info_model info triangle.obj
write info-far info_model info far.xyz --check
write info-scan info_model info scan.ptx
write info-placed info_model info placed.ply
write info-image info_image info knot.exr --check
write info-octree info_octree info knot.cot --check
write info-hybrid info_hybrid info tent.chy --check
# Two Gaussians, as .splat has them.
row='\0\0\0\0\0\0\200\77\0\0\0\100\0\0\200\77\0\0\200\77\0\0\0\77\1\2\3\4\200\177\200\200'
printf "$row$row" > two.splat
mkdir model
printf '1 RADIAL_FISHEYE 9 8 7 4 4 .1 .2\n' > model/cameras.txt
printf '1 1 0 0 0 0 0 0 1 one.png\n\n' > model/images.txt
printf '[{"img_name": "one", "width": 9, "height": 8, "position": [0, 0, 0], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  "fx": 7, "fy": 7}]' > cameras.json
write info-cameras info_cameras info model
write info-camera info_cameras info cameras.json --check
write render-view render render knot.ply --camera cameras.json -o knot.exr --frames 0 --view all
write convert convert convert two.splat -o two.compressed.ply --measure 2
write info-gaussians info_gaussians info two.compressed.ply --check
write chart-gaussians chart chart two.compressed.ply -o chart --quick --pixels 100
write render-gaussians render render two.compressed.ply --profile gsplat-1.6 --size 64x64 -o two.exr --aov all
write devices devices devices
echo '{"traceEvents": [{"cat": "unit", "name": "frame 0", "ph": "X", "ts": 0, "dur": 9, "pid": 0, "args": {"sent_bytes": 8}}]}' > trace.json
"$python" "$1/scripts/simulate" trace.json --ranks 1,8 --quiet --json runs/simulate.json || fail "a trace is not modelled"
echo simulate > runs/simulate.definition
write conformance conformance conformance suite --profile 2dgs-gsplat
mkdir drawn
run 0 render suite/scenes/disc.ply --profile 2dgs-gsplat --size 36x20 -o drawn/L1-disc-2dgs-gsplat.pfm
write suite-wrong judge_suite judge --suite suite --pictures drawn
run 0 help --format json
cp out runs/help.json
echo help > runs/help.definition
"$python" "$1/tests/cli/hierarchies_make.py" octrees 500
sed -i 's/^{/{"srs": {"authority": "EPSG", "horizontal": "32633"}, /' octrees/ept/ept.json
write info-hierarchy info_hierarchy info octrees/ept/ept.json --check
# What no run above writes, or not on every machine.
unseen="device.name device.platform device.version device.driver device.is_cpu device.has_double
  device.rounds_correctly device.compute_units device.memory_bytes
  layer.team mls.team octree.team prepare.team"
if [[ $has_zstd -eq 1 ]]; then
  write layer layer layer knot.ply -o knot.lpc
  write cut cut cut knot.lpc --box -9,-9,9,9 -o cut.lpc
  write layer-colored layer layer knot.ply -o colored.lpc --color-by x
  write merge layer merge knot.lpc colored.lpc -o merged.lpc
  write layer-kept layer layer knot.ply -o kept.lpc --keep x --up z --resumable
  write info-kept info_layers info kept.lpc
  run 0 make gaussians -n 3000 --degree 1 -o balls.spz
  write layer-gaussians layer_gaussians layer balls.spz -o balls.lpc
  write info-gaussian-levels info_gaussian_levels info balls.lpc --check
  write render-gaussian-levels render render balls.lpc --profile exact -o balls.exr --error 2 --aov rgba,bound --size 64x64
  run 0 layer placed.ply -o placed.lpc
  write info-placed-layers info_layers info placed.lpc
  write render-layers render_layers render knot.lpc -o layers.exr --error 4 --size 256x256
  write render-progressive render_layers render knot.lpc -o layers.exr --error 4 --size 64x64 --progressive pictures
  write info-layers info_layers info knot.lpc --check
else
  unset "wanted[layer]" "wanted[cut]" "wanted[merge]" "wanted[render-layers]" "wanted[info-layers]" "wanted[info-kept]"
  unseen+=" layer.* layers_drawn.* info_layers.* render.layers"
fi

if [[ ! -e runs/render-team.json ]]; then
  unset "wanted[render-team]"
  unseen+=" render.team team.*"
fi

for name in "${!wanted[@]}"; do
  # shellcheck disable=SC2086 # the keys are words
  echo "$name" ${wanted[$name]}
done > runs/wanted
echo "$unseen" > runs/unseen
[[ $failures -eq 0 ]] || exit 1
"$python" "$check" "$schema" runs
