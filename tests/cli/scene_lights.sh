#!/usr/bin/env bash
# What stands in the scene lights it alike whatever camera looks at it: 12 photographs, all around and rolled, see the
# same radiance at 20 places. Only head and camera: lights move.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"
python=$(command -v python3) || exit 77
tool=$1/tests/cli/scene_lights.py
"$python" "$tool" make . || exit 1

alike() { # NAME MOST-RATIO options …
  local name=$1 most=$2 found
  shift 2
  rm -f [0-9][0-9].pfm
  for view in ${views:-all}; do
    [[ $view == all ]] && out=%s.pfm || out=$view.pfm
    run 0 render floor.ply --camera transforms.json --view "$view" -o $out --shade lambert --quiet "$@"
  done
  found=$("$python" "$tool" compare .)
  echo "$name: $found"
  awk -v found="${found% *}" -v most="$most" 'BEGIN { exit !(found <= most && found >= 1) }' ||
    fail "$name: views differ by a factor of $found"
}

alike lamp 1.03 --sky 0,0,0 --light lamp:0,1,0:1:2x0.1:0,-1,0 --accumulate 24
alike "lamp with its own H" 1.03 --sky 0,0,0 --light lamp:0,1,0:1:2x0.1:0,-1,0:1,0,1 --accumulate 24
alike "slanting lamp" 1.03 --sky 0,0,0 --light lamp:1,1,0:1:2x0.1:-1,-1,0 --accumulate 24
alike hemisphere 1.0001 --sky 1,1,1:0.1,0.1,0.1 --light none
alike "sky and lamp, occluded" 1.03 --sky 1,1,1:0.1,0.1,0.1 --light lamp:0,1,0:1:2x0.1:0,-1,0 --accumulate 4 --ao 4
alike sun 1.0001 --sky 0.1,0.1,0.1 --light 1,2,0
"$python" - << 'END' > sky.pfm
import struct, sys
sys.stdout.buffer.write(b"PF\n16 8\n-1.0\n" + b"".join(struct.pack("<3f", *[0.1 + (y >= 4) * (1 + (x > 9))] * 3)
                                                       for y in range(8) for x in range(16)))
END
views=$(seq -w 0 11) alike "picture of a sky, view by view" 1.02 --sky sky.pfm --ao 16 --light none

# The second vector says where H goes: along the first one there is none, and only a rectangle has it.
for lamp in lamp:0,1,0:1:2x0.1:0,-1,0:0,2,0 lamp:0,1,0:1:2x0.1:0,-1,0:0,0,0 lamp:0,1,0:1:0.1:0,-1,0:1,0,0; do
  run 2 render floor.ply -o x.pfm --light $lamp
done
run 0 render floor.ply -o x.pfm --light lamp:0,1,0:1:2x0.1:0,-1,0:1,0,1 --shade lambert --json turned.json
perl -0ne 'exit !(/"right": \[-?0\.70710678\d*, -?0, -?0\.70710678\d*\]/)' turned.json || fail "W is not along D x U"
exit $((failures > 0))
