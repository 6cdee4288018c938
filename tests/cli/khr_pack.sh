#!/usr/bin/env bash
# conic conformance --khr: conic reads its files back and draws all of them right, and refuses the broken ones; so does a
# renderer that shares nothing with conic, and each fault of it shows where it should.
set -uo pipefail

source "$1/tests/support/program.bash"
examples=$1/examples/conformance

run 0 conformance --khr pack --json -
grep -q '"cases": 62' out || fail "not 62 cases: $(head -c 300 out)"
[[ $(wc -l < pack/cases.tsv) == 62 && $(ls pack/broken/*.gl* | wc -l) == 25 ]] || fail "not 62 files and 25"
run 0 conformance other --khr --level 2 --threads 1
for file in other/*/*.{gltf,glb,bin,npy,exr}; do
  cmp -s "$file" "pack/${file#*/}" || fail "other bytes: $file"
done
run 2 conformance pack --khr --profile khr-2026

CONIC=$conic "$examples/run-conic" pack own || fail "run-conic"
run 0 judge --suite pack --pictures own --junit own.xml
grep -q '^right: 62 of 62 cases$' out || fail "conic's own pictures: $(cat out)"
for file in pack/broken/*.{gltf,glb}; do
  run 3 render "$file" --profile khr-2026 --camera pack/cameras/one.json -o never.png
  [[ $(wc -l < err) -eq 1 && ! -e never.png ]] || fail "$file: $(cat err)"
done

# Codes are encoded where colours are linear.
for name in color-linear degree-1; do
  run 0 render pack/scenes/$name.gltf --camera pack/cameras/$name.json --profile khr-2026 --aov rgba \
    -o own/L1-$name-khr-2026.png
  rm own/L1-$name-khr-2026.pfm
done
run 0 judge --suite pack --pictures own --level 1

# The camera of a file is that of cameras/.
run 0 render pack/scenes/camera-turned.gltf --camera pack/scenes/camera-turned.gltf --profile khr-2026 --aov rgba \
  --size 40x30 -o p.pfm
run 0 diff p.pfm own/L3-camera-turned-khr-2026.pfm --max-abs 1e-5

python=
for candidate in python3 /usr/bin/python3; do
  "$candidate" -c 'import jsonschema; jsonschema.Draft202012Validator' 2> /dev/null && python=$candidate && break
done
if [[ -n $python ]]; then
  "$python" -c 'import json, jsonschema, sys
schema, manifest = (json.load(open(path)) for path in sys.argv[1:])
jsonschema.Draft202012Validator(schema).validate(manifest)' "$1/docs/reference/conformance.schema.json" \
    pack/manifest.json || fail "the manifest"
else
  echo "not held against its schema: python3-jsonschema is not installed"
fi

numpy=
for candidate in python3 /usr/bin/python3; do
  "$candidate" -c 'import numpy' 2> /dev/null && numpy=$candidate && break
done
if [[ -z $numpy ]]; then
  echo "not drawn by the numpy renderer: python3-numpy is not installed"
  [[ $failures -eq 0 ]]
  exit
fi
"$numpy" "$examples/gltf-renderer.py" pack numpy || fail "the numpy renderer ends"
run 0 judge --suite pack --pictures numpy
grep -q '^right: 62 of 62 cases$' out || fail "the numpy renderer: $(cat out)"

# shows CASES FROM TO: with the text changed, these cases are wrong, and no others.
shows() {
  rm -rf fault
  awk -v from="$2" -v to="$3" '{
    i = index($0, from)
    if (i) { n++; $0 = substr($0, 1, i - 1) to substr($0, i + length(from)) }
    print
  } END { exit n == 0 }' "$examples/gltf-renderer.py" > fault.py || fail "no \"$2\" in the renderer"
  "$numpy" fault.py pack fault || fail "$2: the renderer ends"
  run 1 judge --suite pack --pictures fault --json fault.json
  local found
  found=$("$numpy" -c 'import json
print(*[case["name"][3:-9] for case in json.load(open("fault.json"))["cases"] if case["outcome"] == "wrong"])')
  [[ $found == "$1" ]] || fail "$2 -> $3: wrong are $found"
}
shows 'cutoff' 'opacities[i] * np.exp(-0.5 * square)' 'np.minimum(opacities[i] * np.exp(-0.5 * square), 0.99)'
shows 'node-turned-stretched node-matrix node-deep' 'turn = M / np.linalg.norm(M, axis=0)' 'turn = M'
shows 'rotation-byte rotation-short scale-byte-normalized scale-short-normalized opacity-byte opacity-short position-short all-quantized sparse-rotation' \
  'if a.get("normalized")' 'if False'
shows 'node-turned-stretched node-matrix node-deep harmonics-turned-90 harmonics-turned node-twice two-meshes' \
  'keepdims=True) @ turn' 'keepdims=True)'

[[ $failures -eq 0 ]]
