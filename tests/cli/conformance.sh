#!/usr/bin/env bash
# conic conformance: the same bytes whatever the threads, a manifest that names what is there, and folders that stay.
set -uo pipefail

source "$1/tests/support/program.bash"

run 0 conformance one --profile gsplat-1.6,2dgs-gsplat --level 6 --threads 1 --json -
grep -q '"cases": 83' out || fail "not 83 cases: $(head -c 300 out)"
run 0 conformance several/ --profile 2dgs-gsplat,gsplat-1.6 --level 6 --threads 3
diff -r one several > out || fail "other bytes with other threads: $(head -3 out)"

# Whatever the manifest lists is there, with that size and hash; and nothing else is.
sed -n 's/^ *"path": "\(.*\)",$/\1/p' one/manifest.json > paths
sed -n 's/^ *"sha256": "\(.*\)"$/\1/p' one/manifest.json | paste -d ' ' - paths | sed 's/ /  /' > sums
(cd one && sha256sum --quiet --strict -c ../sums) || fail "hashes"
(cd one && find . -type f ! -name manifest.json | sed 's/^\.\///' | sort) | diff - <(sort paths) > out ||
  fail "the list of files: $(head -3 out)"
[[ $(wc -l < one/cases.tsv) == 83 ]] || fail "the list of cases"

# The manifest is as its schema says; and a manifest that is not would be seen.
python=
for candidate in python3 /usr/bin/python3; do
  "$candidate" -c 'import jsonschema; jsonschema.Draft202012Validator' 2> /dev/null && python=$candidate && break
done
if [[ -n $python ]]; then
  "$python" - "$1/docs/reference/conformance.schema.json" one/manifest.json << 'END' || fail "the manifest"
import copy, json, sys
import jsonschema
schema, manifest = (json.load(open(path)) for path in sys.argv[1:])
jsonschema.Draft202012Validator.check_schema(schema)
check = jsonschema.Draft202012Validator(schema)
check.validate(manifest)
def places(value):
    if isinstance(value, dict):
        yield value
    for item in value.values() if isinstance(value, dict) else value[:1] if isinstance(value, list) else ():
        yield from places(item)
optional = {"spz", "glb", "exr", "step", "colors"}
for i, place in enumerate(places(manifest)):
    for key in place:
        if key in optional:
            continue
        spoiled = copy.deepcopy(manifest)
        del list(places(spoiled))[i][key]
        assert not check.is_valid(spoiled), key
    spoiled = copy.deepcopy(manifest)
    list(places(spoiled))[i]["other"] = 1
    assert not check.is_valid(spoiled), place
END
else
  echo "not held against its schema: python3-jsonschema is not installed"
fi

# The same scene and camera in every format.
run 0 info one/scenes/ellipse.spz
run 0 convert one/scenes/ellipse.spz --from-frame rdf --frame rdf -o back.ply --json -
run 0 info one/cameras/ellipse
for name in off-center harmonics; do
  for camera in one/cameras/$name one/cameras/$name.transforms.json; do
    for which in one/cameras/$name.json "$camera"; do
      run 0 render one/scenes/$name.ply --profile gsplat-1.6 --camera "$which" --aov rgba -o p.pfm
      mv p.pfm "$(basename "$which").pfm"
    done
    run 0 diff $name.json.pfm "$(basename "$camera").pfm" --max-abs 1e-6
  done
done
run 0 render one/scenes/ellipse.ply --profile gsplat-1.6 --camera one/cameras/ellipse.json --aov rgba -o ply.pfm
for format in spz glb; do
  run 0 render one/scenes/ellipse.$format --profile gsplat-1.6 --camera one/cameras/ellipse.json --aov rgba -o b.pfm
  run 0 diff ply.pfm b.pfm --max-abs 1e-6
done
if "$conic" --version | grep -q '^In this build:.*OpenEXR'; then
  run 0 info one/expected/L1-ball-gsplat-1.6.exr
  grep -q 'rgba, Z' out || fail "an EXR of other planes: $(cat out)"
fi

# What a folder holds that is no suite stays; an earlier suite is replaced.
mkdir mine && touch mine/precious
run 2 conformance mine --profile khr-2026
[[ $(ls mine) == precious ]] || fail "a folder of somebody else was written to"
run 0 conformance one --profile 2dgs-gsplat --level 1
[[ $(wc -l < one/cases.tsv) == 15 ]] || fail "the earlier suite was not replaced"
run 2 conformance
run 2 conformance a b
run 2 conformance other --profile gsplat-1.7
grep -q 'did you mean gsplat-1.5' err || fail "no hint: $(cat err)"
run 4 conformance nowhere/at/all

[[ $failures -eq 0 ]]
