#!/usr/bin/env bash
# Gaussian scenes of every format as splats: with --profile surface and in the commands that make something of points,
# the same bits as their numbers in a .ply give.
set -uo pipefail

source "$1/tests/support/program.bash"

# Two Gaussians in .splat, of three sizes, opacities of 4/255 and 200/255.
printf '\0\0\0\0\0\0\200\77\0\0\0\100\0\0\200\77\0\0\0\77\0\0\200\76\300\200\100\310\200\177\200\200' > two.splat
printf '\0\0\200\76\0\0\200\77\0\0\0\100\0\0\0\77\0\0\0\77\0\0\200\76\1\2\303\4\240\100\200\200' >> two.splat
camera='"width": 48, "height": 40, "fx": 40, "fy": 40, "cx": 24, "cy": 20'
echo "{$camera, \"world_to_camera\": [[1, 0, 0, 0], [0, 1, 0, -1], [0, 0, 1, 3], [0, 0, 0, 1]]}" > camera.json

hash_of_surface() { # SCENE
  run_as_typed 0 render "$1" --plain --profile surface --camera camera.json -o a.pfm --json -
  grep -q '"profile"' out && fail "$1: composited"
  grep -o '"rgba": "[0-9a-f]*"' out | head -1
}

n_compared=0
for name in scene.splat scene.compressed.ply scene.gltf scene.glb scene.spz scene.sog; do
  "$conic" convert two.splat -o $name > /dev/null 2>&1 || continue # not in this build
  frame=$("$conic" info $name | sed -n 's/^frame  *\([a-z]*\).*/\1/p')
  run 0 convert $name -o numbers.ply ${frame:+--frame $frame}
  surface=$(hash_of_surface $name)
  [[ -n $surface && $surface == "$(hash_of_surface numbers.ply)" ]] || fail "$name: another surface than its numbers'"
  for command in octree prepare; do
    out=$([[ $command == octree ]] && echo a.cot || echo a.ply)
    run 0 $command $name -o "$out"
    cp "$out" kept
    run 0 $command numbers.ply -o "$out"
    cmp -s kept "$out" || fail "$command $name: other splats than its numbers'"
  done
  n_compared=$((n_compared + 1))
done
[[ $n_compared -ge 3 ]] || fail "$n_compared formats were compared"
# Two files are one scene of splats; what Gaussians do not have is refused.
run_as_typed 0 render two.splat numbers.ply --profile surface --size 40x40 -o a.png
run_as_typed 3 render two.splat --profile surface --color-by intensity --size 40x40 -o a.png
grep -q "no 'intensity'" err || fail "a field that is none: $(cat err)"
head -c 40 two.splat > cut.splat
run 3 octree cut.splat -o b.cot
[[ -e b.cot ]] && fail "a tree of half a Gaussian"
[[ $failures -eq 0 ]]
