#!/usr/bin/env bash
# The runners of examples/conformance, of C, Python and a browser's page, draw the suite rightly, and a wrong one is
# told; and what the recipes for CI run works.
set -uo pipefail

source "$1/tests/support/program.bash"
export CONIC=$conic
examples=$1/examples/conformance
run 0 conformance suite --profile gsplat-1.6 --level 2
suite_of() { # FOLDER [OPTIONS]
  judged=$("$conic" judge --suite suite --pictures "$1" --profile gsplat-1.6 --level 2 "${@:2}" 2>&1)
}

if command -v cc > /dev/null; then
  cc -O1 -Wall -Werror "$examples/runner.c" -o runner -lm || fail "runner.c"
  mkdir c && ./runner suite c gsplat-1.6 || fail "the runner in C ends"
  suite_of c || fail "the runner in C: $judged"
  sed 's/+ 0\.15 \* size/+ 0.65 * size/g; s/0\.3, 0\.0, 0\.3/0.1, 0.0, 0.1/' "$examples/gsplat_draw.h" > gsplat_draw.h
  cp "$examples/runner.c" . && cc -O1 runner.c -o wrong -lm && mkdir wrong-c && ./wrong suite wrong-c gsplat-1.6
  suite_of wrong-c && fail "a wrong dilation is right"
fi

if command -v node > /dev/null; then
  python3 "$examples/browser/server.py" --port 0 --level 1 --once > served 2>&1 &
  server=$!
  for ((i = 0; i < 600; i++)); do
    [[ -s served ]] && break || sleep 0.1
  done
  cat > page.mjs << END
import { draw } from '$examples/browser/draw.mjs';
import { runSuite } from '$examples/browser/runner.mjs';
const base = '$(cat served)'.replace(/\/\$/, '');
const refused = await fetch(base + '/pictures/..%2Fescaped', { method: 'POST', headers: { 'X-Width': 1, 'X-Height': 1 }, body: new Float32Array(4) });
const page = await (await fetch(base + '/')).text();
const verdict = await runSuite(draw, () => {}, base);
console.log(verdict.text);
process.exit(refused.status === 400 && page.includes('runner.mjs') ? verdict.exitCode : 1);
END
  node page.mjs > told 2>&1 || fail "the page: $(tail -5 told)"
  wait $server || fail "the server ends with $?"
fi

# conic in WebAssembly ends without a word where nobody reads on: here a program that prints zeros without end.
if command -v node > /dev/null; then
  {
    printf '\0asm\1\0\0\0\1\x0c\2\x60\4\x7f\x7f\x7f\x7f\1\x7f\x60\0\0\2\x23\1\x16wasi_snapshot_preview1'
    printf '\x08fd_write\0\0\3\2\1\1\5\3\1\0\1\7\x13\2\6memory\2\0\6_start\0\1\x0a\x14\1\x12\0\3\x40\x41'
    printf '\1\x41\0\x41\1\x41\x08\x10\0\x1a\x0c\0\x0b\x0b\x0b\x0e\1\0\x41\0\x0b\x08\x10\0\0\0\0\x10\0\0'
  } > zeros.wasm
  { timeout 60 node "$1/examples/web/conic.mjs" zeros.wasm 2> told; echo $? > code; } | head -c 1 > one
  [[ $(stat -c %s one) -eq 1 && $(cat code) -eq 141 && ! -s told ]] || fail "a closed pipe: $(cat code) $(head -3 told)"
fi

# The recipes: their lines of conic and of a renderer, as they stand, with conic on the path.
mkdir -p path tests && ln -s "$conic" path/conic
for recipe in github gitlab; do
  sed -n 's/^ *- \(run: \)\{0,1\}\(\(conic\|python3\) .*\)/\2/p' "$1/examples/ci/$recipe.yml" > lines
  [[ $(wc -l < lines) -eq 3 ]] || fail "$recipe: other lines: $(cat lines)"
  rm -rf suite pictures
  cp "$examples/numpy-renderer.py" tests/draw.py
  PATH=$PWD/path:$PATH bash -e lines > told 2>&1 || fail "$recipe: $(tail -5 told)"
  grep -q 'failures="0"' report.xml || fail "$recipe: $(head -3 report.xml)"
  sed -i 's/+ 0\.3 \* np\.eye/+ 0.1 * np.eye/' tests/draw.py
  PATH=$PWD/path:$PATH bash -e lines > told 2>&1 && fail "$recipe: a wrong renderer passes"
done
if python3 -c 'import yaml' 2> /dev/null; then
  python3 -c 'import sys, yaml; [yaml.safe_load(open(path)) for path in sys.argv[1:]]' "$1"/examples/ci/*.yml || fail "YAML"
fi
[[ $failures -eq 0 ]]
