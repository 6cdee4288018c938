#!/usr/bin/env bash
# The suite's runner in Python, by conic and by a function that is wrong; and the program, as a module.
set -uo pipefail
source "$(dirname "$0")/../support/python.bash"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
runner=$1/examples/conformance/runner.py
failures=0
fail() {
  echo "FAILED: $*: $(tail -n 5 told)"
  failures=$((failures + 1))
}

with_conic "$python" -m conic --version > told 2>&1 || fail "python -m conic"
diff <("$2" --version) told || fail "another version"
with_conic "$python" -m conic render nothing.ply > told 2>&1
[[ $? -eq $("$2" render nothing.ply > /dev/null 2>&1; echo $?) ]] || fail "another exit code"
with_conic "$python" "$runner" --level 1 --junit report.xml > told 2>&1 || fail "the runner"
grep -q 'tests="14" failures="0"' report.xml || fail "$(head -c 300 report.xml)"
cat > mine.py << 'END'
import conic
def draw(scene, camera, background):
    return conic.render(scene, camera, profile="gsplat-1.6")["rgba"][..., [2, 1, 0, 3]]
END
with_conic "$python" "$runner" mine:draw --level 1 > told 2>&1
[[ $? -eq 1 ]] && grep -q '^WRONG' told || fail "what is wrong is right"
[[ $failures -eq 0 ]]
