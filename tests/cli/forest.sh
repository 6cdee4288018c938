#!/usr/bin/env bash
# Points on no surface: drawn as dots by default and not --plain, told by --json and --verbose, and kept by prepare.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

value() { # KEY FILE
  sed -nE "s/^ *\"$1\": ([0-9]+),?$/\1/p" "$2" | head -n 1
}

hashes() { # FILE
  sed -n '/"hash": {/,/}/p' "$1"
}

"$1/scripts/forest" 3 > forest.xyz
options=(--size 96x96 --azimuth 20 --up z --samples 1 -o out.pfm)

run_as_typed 0 render forest.xyz "${options[@]}" --json dots.json --verbose
n=$(value dots dots.json)
total=$(value splats_in dots.json)
[[ $n -gt $((total / 3)) && $n -lt $((total * 2 / 3)) ]] || fail "$n of $total points are dots"
grep -q "$n on no surface, drawn as dots" err || fail "--verbose does not tell of dots: $(cat err)"
run_as_typed 0 render forest.xyz "${options[@]}" --plain --json plain.json --verbose
[[ -z $(value dots plain.json) ]] || fail "dots with --plain"
grep -q "drawn as dots" err && fail "--verbose tells of dots with --plain"
[[ $(hashes dots.json) != "$(hashes plain.json)" ]] || fail "dots change nothing"

# Prepared, the picture is the same.
run_as_typed 0 prepare forest.xyz -o forest.ply --json prepared.json
[[ $(value dots prepared.json) -eq $n ]] || fail "prepare found other dots"
run_as_typed 0 render forest.ply "${options[@]}" --json again.json
[[ $(value dots again.json) -eq $n && $(hashes again.json) == "$(hashes dots.json)" ]] || fail "prepare loses dots"
run_as_typed 0 info forest.ply
grep -q "dots" out || fail "info does not tell of dots"
run_as_typed 0 prepare forest.xyz -o plain.ply --plain --json prepared.json
[[ $(value dots prepared.json) -eq 0 ]] || fail "prepare --plain found dots"
run_as_typed 0 render plain.ply "${options[@]}" --plain --json again.json
[[ $(hashes again.json) == "$(hashes plain.json)" ]] || fail "prepare --plain is not what render --plain draws"

# Each frame of a turntable turns them anew; threads change no bit; the arithmetic is right.
run_as_typed 0 render forest.xyz "${options[@]}" --turntable 3 --json turn.json
cp out.0001.pfm first.pfm
run_as_typed 0 render forest.xyz "${options[@]}" --turntable 3 --threads 1
cmp -s first.pfm out.0001.pfm || fail "threads change the picture"
run_as_typed 0 verify forest.xyz --size 96x96 --azimuth 20 --up z --json verify.json
grep -q '"pass": true' verify.json || fail "verify: $(cat verify.json)"

[[ $failures -eq 0 ]]
