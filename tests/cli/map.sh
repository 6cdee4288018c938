#!/usr/bin/env bash
# conic render --camera top: where pixels lie, that windows and memory change no bit, and what the files say of the world.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"


printf '0 0 0\n1 0 0\n0 1 0\n1 1 1\n' > sheet.xyz
run 2 render sheet.xyz --gsd 1 -o never.png
for options in '--up y' '--size 9x9' '--azimuth 9' '--turntable 2' '--aov N' '--legend' '--error 2' '--exposure auto' '--budget 9'; do
  # shellcheck disable=SC2086 # words
  run 2 render sheet.xyz --camera top:1 $options -o never.png
done
run 2 render sheet.xyz --camera top:1 -o -
run 2 render sheet.xyz --camera top:1 --aov rgba,Z -o never.png
run 2 render sheet.xyz --camera top:0 -o never.png
run 2 render sheet.xyz --camera top:1e-9 -o never.tif
grep -q 'has 1000000001 pixels in a row; .* --box' err || fail "a picture that is too large: $(cat err)"
run 2 explain sheet.xyz --camera top --pixel 0,0
[[ ! -e never.png && ! -e never.tif ]] || fail "a file was written in spite of an error"
if ! command -v python3 > /dev/null; then
  echo "skipped the rest: there is no python3" >&2
  exit $((failures > 0 ? 1 : 77))
fi
python3 "$1/tests/cli/map.py" "$conic" "$("$conic" --version | grep '^In this build:' | grep -c zstd)" ||
  fail "what is drawn from above"
[[ $failures -eq 0 ]]
