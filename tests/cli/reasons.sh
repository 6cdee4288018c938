#!/usr/bin/env bash
# A value that an option does not take is refused with what is wrong with it: numbers of the wrong kind, too many or too
# few of them, and directions without one.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"
run 0 make torus -n 50 -o torus.ply

while IFS='|' read -r option value reason; do
  run 2 render torus.ply -o x.pfm "$option" "$value"
  grep -qF -- "$option: \"$value\" is not understood: $reason; it takes" err || fail "$option $value: $(head -c 120 err)"
done << 'END'
--kernel|confetti:1,1.5,2.5|N is a whole number, 1 to 16
--kernel|confetti:1,1.5,17|N is a whole number, 1 to 16
--kernel|confetti:0,1.5,2|A and B are above 0
--kernel|confetti:1,2|3 numbers are wanted
--kernel|confetti:1,2,3,4|3 numbers are wanted
--light|lamp:0,1,0:1:0.1:0,0,0|0,0,0 is no direction
--light|lamp:0,1,0:1:2x0.1:0,0,0|0,0,0 is no direction
--light|lamp:0,1,0:1:2x0.1:0,-1,0:0,0,0|0,0,0 is no direction
--light|lamp:0,1,0:1:2x0.1:0,-1,0:0,2,0|H goes along where to the lamp shines
--light|lamp:0,1,0:1:2x0:0,-1,0|W and H are above 0
--light|lamp:0,1,0:1:2x3|a rectangle needs a direction behind WxH
--light|lamp:0,1,0:1:0:0,-1,0|a disc's radius is above 0
--light|lamp:0,1,0:1:-1|a radius is 0 or above
--light|lamp:0,1,0:-1|a colour is within 0 and 1e12
--light|lamp:0,1|3 numbers are wanted
--light|lamp:0,1,0:1:1:0,1,0:0,1,0:7|it has too many parts
--light|0,0,0|0,0,0 is no direction
--light|camera:0,0,0|0,0,0 is no direction
--light|1,2|3 numbers are wanted
--light|1,2,x|3 numbers are wanted
--light|1,2,3:1,2|a colour is 1 or 3 numbers, a name as white, or #rrggbb
--light|1,2,3:1:2|a sun's radius ends with deg
--light|1,2,3:1:91deg|a sun's radius is 0 to 90 degrees
--sky|1,2|a colour is 1 or 3 numbers, a name as white, or #rrggbb
--sky|-1|a colour is within 0 and 1e6
--background|1,2,3,4|a colour is 1 or 3 numbers, a name as white, or #rrggbb
--up|0,0,0|0,0,0 is no direction
--up|1,2|3 numbers are wanted
--eye|1,2,3,4|3 numbers are wanted
--size|10|2 whole numbers are wanted, as 640x360
--size|1.5x2|2 whole numbers are wanted, as 640x360
--ramp|1,1|the second end is above the first
--ramp|1,2,3|2 numbers are wanted
--focus|1,2,3|2 numbers are wanted
--focus|0|a depth is above 0
--shutter|1|2 numbers are wanted
--shutter|2:1|A is not after B
--near|0|it is above 0
--box|1,2,3|4 or 6 numbers are wanted
--box|1,1,0,0|the second corner is above the first
END
exit $((failures > 0))
