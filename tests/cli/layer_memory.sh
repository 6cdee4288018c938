#!/usr/bin/env bash
# conic layer and conic render in little memory, conic layer --append and conic merge: what the command line promises.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

if ! "$conic" --version | grep '^In this build:' | grep -q zstd; then
  echo "skipped: this build has no zstd"
  exit 77
fi

value() { # KEY FILE: the first value of a key in a JSON file
  sed -nE "s/^ *\"$1\": \"?([^\",]*)\"?,?$/\1/p" "$2" | head -n 1
}

is_sound() { # FILE
  run 0 info "$1" --check --json info.json
  [[ $(value sound info.json) == true ]] || fail "$1 is not sound"
}

# Memory is held, and changes no byte.
run 0 make gyroid -n 300k -o gyroid.ply
run 0 layer gyroid.ply -o gyroid.lpc
for mib in 16 32; do
  run 0 layer gyroid.ply -o small.lpc --memory $mib --threads 2 --json small.json
  cmp -s gyroid.lpc small.lpc || fail "memory changes the file"
  if [[ ! $sanitized ]]; then
    awk -v peak="$(value peak_rss_bytes small.json)" -v mib=$mib 'BEGIN { exit !(peak <= 1.1 * mib * 1048576) }' ||
      fail "over $mib MiB: $(value peak_rss_bytes small.json) bytes"
  fi
done

# So it is by drawing, which reads every cloud once.
for samples in 1 2; do
  run 0 render gyroid.lpc --size 200x200 --samples $samples --occlusion off --threads 2 -o large.png
  run 0 render gyroid.lpc --size 200x200 --samples $samples --occlusion off --threads 2 --memory 28 -o small.png \
    --json small.json
  cmp -s large.png small.png || fail "memory changes the picture of $samples samples"
  n_read=$(value clouds_read small.json)
  [[ $(value bands small.json) -gt 1 && $n_read -le $(value clouds small.json) ]] || fail "clouds are read twice: $n_read"
  if [[ ! $sanitized ]]; then
    awk -v peak="$(value peak_rss_bytes small.json)" 'BEGIN { exit !(peak <= 1.1 * 28 * 1048576) }' ||
      fail "over 28 MiB: $(value peak_rss_bytes small.json) bytes"
  fi
done

TMPDIR=$PWD/missing run 4 render gyroid.lpc --memory 20 -o never.png

# Added to a file, or of two files, on the first one's grid.
run 0 make sphere -n 3k -o sphere.ply
run 0 make torus -n 2k --far 3,0,0 -o torus.ply
run 0 layer sphere.ply -o all.lpc --cloud-size 100 --json first.json
cp all.lpc sphere.lpc
run 0 layer torus.ply -o torus.lpc
run 0 layer torus.ply --append -o all.lpc --json all.json
[[ $(value points_out all.json) == 5000 && $(value quantum all.json) == "$(value quantum first.json)" ]] || fail "append"
is_sound all.lpc
run 0 merge sphere.lpc torus.lpc -o both.lpc --json both.json
[[ $(value points_out both.json) == 5000 && $(value quantum both.json) == "$(value quantum first.json)" ]] || fail "merge"
is_sound both.lpc
run 0 merge sphere.lpc torus.lpc -o again.lpc --memory 16 --threads 1
cmp -s both.lpc again.lpc || fail "merge: memory or threads change the file"

run 3 layer torus.ply --append -o missing.lpc
run 2 layer torus.ply --append -o all.lpc --quantum 1
run 3 layer missing.ply --append -o all.lpc
run 2 layer all.lpc --append -o all.lpc
run 2 merge sphere.lpc -o never.lpc
run 2 merge sphere.lpc torus.lpc
run 3 merge sphere.lpc torus.ply -o never.lpc
run 2 merge sphere.lpc torus.lpc -o torus.lpc
is_sound all.lpc
[[ $(value points info.json) == 5000 && ! -e never.lpc && ! -e missing.lpc ]] || fail "a failed run left its traces"
[[ $failures -eq 0 ]]
