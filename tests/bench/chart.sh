#!/usr/bin/env bash
# conic chart: a small one has a line for each method and kernel and for each representation of a mesh, sound figures,
# and fronts.
set -uo pipefail

source "$1/tests/support/program.bash"

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
  for picture in chart-oracle.svg chart-oracle.png chart-scene.svg chart-scene.png representations.svg representations.png; do
    [[ $(wc -c < "small/$picture") -gt 10000 ]] || fail "no $picture"
  done
fi
# Of every representation of a mesh there is a line a size; the mesh's own triangles are the nearest to it, surfels
# leave no hole, points do, and fewer are drawn where less is seen
n_points=$(sed -nE 's/^  "representation_points": ([0-9]+),$/\1/p' chart.json)
[[ $(wc -l < small/representations.csv) -eq $((n_points + 1)) && $n_points -eq 15 ]] || fail "not a line a representation"
grep -q '^best for their time, of a mesh of 2048 triangles:$' out || fail "no front of representations printed"
awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; columns = NF; next }
  NF != columns { print "line " NR " has " NF " columns"; bad = 1 }
  {
    k = $at["representation"]; i = sprintf("%.1f", $at["pixels_per_triangle"])
    sizes[i] = 1; ms[k, i] = $at["ms"]; rmse[k, i] = $at["rmse"]; holes[k, i] = $at["holes"]; front[k, i] = $at["front"]
    count[k, i] = $at["primitives"]; models[k] = 1
    if (!($at["ms"] > 0 && $at["lod_ms"] >= 0 && $at["lod_ms"] <= $at["ms"])) { print "line " NR ": time"; bad = 1 }
    if (!($at["rmse"] > 0 && $at["rmse"] <= $at["max"] && $at["max"] < 1)) { print "line " NR ": error"; bad = 1 }
  }
  END {
    if (!("10.0" in sizes && "1.0" in sizes && "0.1" in sizes)) { print "sizes are missing"; bad = 1 }
    for (i in sizes) {
      for (k in models) {
        n++
        if (k != "triangles" && rmse[k, i] <= rmse["triangles", i]) { print k " nearer than triangles at " i; bad = 1 }
        for (other in models)
          if (front[k, i] && ms[other, i] < ms[k, i] && rmse[other, i] < rmse[k, i]) { print k " is beaten at " i; bad = 1 }
      }
      if (rmse["triangles", i] > 0.05 || !front["triangles", i]) { print "triangles at " i; bad = 1 }
      if (holes["triangles", i] || holes["surfels", i]) { print "holes at " i; bad = 1 }
      if (rmse["surfels", i] > 0.2 || rmse["hybrid", i] > rmse["surfels", i]) { print "surfels at " i; bad = 1 }
    }
    if (n != 15) { print "representations are missing"; bad = 1 }
    if (!(holes["points", "10.0"] > 1000)) { print "points without holes"; bad = 1 }
    if (!(count["hybrid", "0.1"] < 0.5 * count["hybrid", "10.0"])) { print "the hybrid never gets simpler"; bad = 1 }
    if (!(count["octree", "0.1"] < 0.8 * count["octree", "1.0"])) { print "the octree never gets simpler"; bad = 1 }
    exit bad
  }' small/representations.csv || fail "the table of representations is not sound"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' > 'a "mesh".obj'
run 0 chart -o other --quick --only representations --mesh 'a "mesh".obj'
[[ $(grep -c '^"a ""mesh"".obj",4,' other/representations.csv) -eq 15 && ! -e other/chart.csv ]] || fail "not that mesh alone"

# Without gnuplot there is the table all the same
mkdir empty
PATH=$PWD/empty "$conic" chart -o poor --quick --only methods > out 2> err || fail "fails without gnuplot"
/usr/bin/env grep -q '^conic: warning: poor: no picture' err || fail "silent about the missing picture"
[[ -s poor/chart.csv && -s poor/chart.gp && ! -e poor/chart-scene.png ]] || fail "not the table alone"
[[ ! -e poor/representations.csv ]] || fail "not the methods alone"

run 2 chart
run 2 chart more other -o small
run 3 chart -o small --quick --mesh missing.obj
run 4 chart -o missing/folder --quick
[[ $failures -eq 0 ]]
