#!/usr/bin/env bash
# At equal budgets of some splats in a hundred, a layered cloud's picture is as near to the whole one as an octree's is,
# to within a decibel, and it takes at least nine tenths of the budget.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"
if ! "$conic" --version | grep '^In this build:' | grep -q zstd; then
  echo "skipped: this build is without zstd" >&2
  exit 77
fi

number() { # KEY FILE
  sed -nE "s/^ *\"$1\": ([0-9.]+),?$/\1/p" "$2" | head -n 1
}

compare() { # SCENE COUNT BUDGET
  "$conic" make "$1" -n "$2" -o "$work/m.ply" -q
  "$conic" octree "$work/m.ply" -o "$work/m.cot" -q
  "$conic" layer "$work/m.ply" -o "$work/m.lpc" -q
  "$conic" render "$work/m.ply" -o "$work/whole.png" --plain --size 600x600 -q
  for kind in cot lpc; do
    "$conic" render "$work/m.$kind" -o "$work/some.png" --plain --size 600x600 --budget "$3" -q --json "$work/$kind.json"
    "$conic" diff "$work/whole.png" "$work/some.png" -q --json "$work/diff-$kind.json" > /dev/null
  done
  splats=$(number splats_in "$work/lpc.json")
  ((splats <= $3 && 10 * splats > 9 * $3)) || fail "$1: $splats splats of $3"
  octree=$(number psnr "$work/diff-cot.json") layers=$(number psnr "$work/diff-lpc.json")
  awk "BEGIN { exit !($layers >= $octree - 1) }" || fail "$1, $3: $layers dB, an octree has $octree"
}

compare sphere 200000 5000
compare knot 100000 5000
compare gyroid 200000 10000
[[ $failures -eq 0 ]]
