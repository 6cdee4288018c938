#!/usr/bin/env bash
# conic chart: a small one has a line for each method and kernel, sound figures, and a front.
set -uo pipefail

source "$(dirname "${BASH_SOURCE[0]}")/program.bash"

run 0 chart -o small --quick --json chart.json
n_points=$(sed -nE 's/^  "points": ([0-9]+),$/\1/p' chart.json)
[[ $(wc -l < small/chart.csv) -eq $((n_points + 1)) && $n_points -ge 24 ]] || fail "not a line a point"
grep -q '^best for their time, against the surface:$' out || fail "no front printed"
awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; columns = NF; next }
  NF != columns { print "line " NR " has " NF " columns"; bad = 1 }
  !($at["ms"] > 0) { print "line " NR " took no time"; bad = 1 }
  { is_rough = $at["method"] == "point" || $at["method"] == "disc" } # they know no tilt and no kernel of the surface
  !($at["scene_rmse"] > 0 && $at["scene_rmse"] < (is_rough ? 0.6 : 0.2)) { print "line " NR ": rmse " $at["scene_rmse"]; bad = 1 }
  !is_rough && !($at["scene_psnr"] > 14 && $at["scene_flip"] > 0 && $at["scene_flip"] < 0.5) { print "line " NR ": psnr, flip"; bad = 1 }
  $at["kernel"] == "gauss" && !is_rough && !($at["oracle_rmse"] > 0 && $at["oracle_rmse"] < 0.02) { print "line " NR ": oracle"; bad = 1 }
  ($at["kernel"] == "box" || is_rough) && $at["oracle_rmse"] != "" { print "line " NR ": an oracle that was not asked"; bad = 1 }
  $at["method"] == "conic" && $at["holes"] > 0 { print "line " NR ": " $at["holes"] " holes"; bad = 1 }
  { scenes[$1]; methods[$at["method"]] = 1; front[$1] += $at["scene_front"]; exact[$1] += $at["oracle_front"] }
  END {
    for (s in scenes) { n++; if (!front[s] || !exact[s]) { print s " has no front"; bad = 1 } }
    if (n != 4 || !("conic" in methods) || !("ray" in methods)) { print "scenes or methods are missing"; bad = 1 }
    exit bad
  }' small/chart.csv || fail "the table is not sound"
# The front's points are beaten by none of their scene
awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
  { n++; s[n] = $1; ms[n] = $at["ms"]; e[n] = $at["scene_rmse"]; f[n] = $at["scene_front"] }
  END {
    for (i = 1; i <= n; i++) {
      beaten = 0
      for (k = 1; k <= n; k++) if (s[k] == s[i] && ms[k] < ms[i] && e[k] < e[i]) beaten = 1
      if (f[i] && beaten) exit 1
    }
  }' small/chart.csv || fail "a point of the front is beaten"
if command -v gnuplot > /dev/null; then
  for picture in chart-oracle.svg chart-oracle.png chart-scene.svg chart-scene.png; do
    [[ $(wc -c < "small/$picture") -gt 10000 ]] || fail "no $picture"
  done
fi
# Without gnuplot there is the table all the same
mkdir empty
PATH=$PWD/empty "$conic" chart -o poor --quick > out 2> err || fail "fails without gnuplot"
/usr/bin/env grep -q '^conic: warning: poor: no picture' err || fail "silent about the missing picture"
[[ -s poor/chart.csv && -s poor/chart.gp && ! -e poor/chart-scene.png ]] || fail "not the table alone"

run 2 chart
run 2 chart more -o small
run 4 chart -o missing/folder --quick
[[ $failures -eq 0 ]]
