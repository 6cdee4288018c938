#!/usr/bin/env bash
# conic chart: a small one has a line for each method and kernel, those of one's own scenes a line a way, with sound
# figures, and fronts.
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
# A picture has a mark for each of its points, and beside them those of the legend; no place is nan or inf
count_marks() { grep -cE '^<(circle|polygon) ' "$1"; }
check_svg() {
  [[ $(head -c 5 "$1") == '<svg ' && $(tail -n 1 "$1") == '</svg>' ]] || fail "$1 is no whole picture"
  grep -qE '[ "=,ML-](nan|inf)' "$1" && fail "$1 has a place that is none"
}
for picture in chart chart-oracle chart-scene; do check_svg "small/$picture.svg"; done
[[ $(count_marks small/chart-scene.svg) -eq $((n_points + 6 + 4)) ]] || fail "not a mark a point: $(count_marks small/chart-scene.svg)"
n_exact=$(awk -F, 'NR > 1 && $12 != ""' small/chart.csv | wc -l)
[[ $n_exact -gt 10 && $(count_marks small/chart-oracle.svg) -eq $((n_exact + 6 + 4)) ]] || fail "not a mark a point with an oracle"
[[ ! -e small/representations.svg ]] || fail "a chart of a mesh that nobody named"

# What a mesh can be drawn as; the old spelling says the new one
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' > 'a "mesh".obj'
run 0 chart -o other --quick --mesh 'a "mesh".obj' --json other.json
grep -q -- '--mesh is now MESH --over as' err || fail "the new spelling is not said: $(cat err)"
[[ $(grep -c '^"a ""mesh"".obj",as,' other/scene.csv) -eq 3 && ! -e other/chart.csv ]] || fail "not that mesh alone"
grep -q '"representation_points": 3,' other.json || fail "$(cat other.json)"

# Scenes of one's own: a line and a mark a value, the default ones all alike, more samples nearer and slower, and an
# octree that is nearer the smaller the error
run 0 make sphere -n 3k -o ball.ply
run 0 octree ball.ply -o ball.cot
run 0 chart ball.ply -o own --quick --over 'method=conic:point,kernel=gauss:hat,prefilter=1:0,samples=1:2,passes=3,isa=scalar' --json own.json
awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
  { rmse[$2 "=" $3] = $at["rmse"]; n++; if (!($at["ms"] > 0 && $at["splats"] == 3000)) { print "line " NR; bad = 1 } }
  END {
    same = rmse["samples=1"]
    if (n != 10 || rmse["kernel=gauss"] != same || rmse["prefilter=1"] != same || rmse["passes=3"] != same || rmse["isa=scalar"] != same) bad = 1
    if (rmse["kernel=hat"] == same || rmse["prefilter=0"] == same || !(rmse["samples=2"] < same) || !(rmse["method=point"] > 2 * same)) bad = 1
    exit bad
  }' own/scene.csv || fail "not what the axes say: $(cat own/scene.csv)"
check_svg own/scene.svg
[[ $(count_marks own/scene.svg) -eq $((3 * 10 + 6)) ]] || fail "not a mark a value"
grep -q '"points": 10,' own.json || fail "points are not counted"
# Of pictures that are equal, the fastest is no better: its time is chance. Where the work differs it is not
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
  $at["front"] && ($2 "=" $3 == "prefilter=1" || $2 "=" $3 == "samples=1") { exit 1 }' own/scene.csv ||
  fail "the same picture is twice the best: $(cat own/scene.csv)"

# An octree is nearer, and draws more, the smaller its error, and states it; values of two options are combined; the
# nearest of those that are fast enough is said as a command, which draws just this
run 0 chart ball.cot -o levels --quick --truth 1 --over error=2:8:32,samples+error=2:4 --time 1000 --json levels.json
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
  $2 == "error" && n++ && !($at["rmse"] > last && $at["splats"] <= count && $at["stated_px"] <= $3) { exit 1 }
  { last = $at["rmse"]; count = $at["splats"]; combined += $2 == "samples+error" && $3 ~ /^[1-4]:[24]$/ }
  END { exit !(n == 3 && combined == 8) }' levels/scene.csv || fail "no levels: $(cat levels/scene.csv)"
line=$(sed -n 's/^in 1000 s: conic //p' out)
[[ $line == "render ball.cot --error 2 --samples 1 --size 96x96" ]] || fail "no command in time: $(cat out)"
grep -qF "\"in_time\": \"conic $line\"," levels.json || fail "$(cat levels.json)"
run 0 $line -o drawn.pfm
run 0 chart ball.cot -o none --quick --over error=2 --time 1e-6
grep -q '^in 1e-06 s: nothing of it$' out || fail "$(cat out)"
run 0 chart ball.ply ball.cot -o both --quick --truth 1 --over samples=1:2
awk -F, 'NR > 1 && $3 == 1 && $11 != 0 { exit 1 } END { exit NR != 5 }' both/scene.csv ||
  fail "a scene is not itself: $(cat both/scene.csv)"

# Another program's picture stands beside: conic's own, said to be another's, is exactly as far from the truth
cat > camera.json << 'END'
{"width": 96, "height": 96, "fx": 100, "fy": 100, "cx": 48, "cy": 48,
 "world_to_camera": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 3], [0, 0, 0, 1]]}
END
run 0 render ball.ply -o ball.pfm --camera camera.json --shade none --samples 1
run 0 chart ball.ply -o beside --quick --over samples=1 --camera camera.json --size 96x96 --shade none --beside other=12.5:ball.pfm
awk -F, 'NR == 2 { own = $11 } NR == 3 { other = $11; n = $2 == "beside" && $3 == "other" && $8 == 12.5 }
  END { exit !(n && own > 0.001 && other == own) }' beside/scene.csv || fail "not beside: $(cat beside/scene.csv)"
run 2 chart ball.ply -o beside --beside other:ball.pfm
run 3 chart ball.ply -o beside --quick --size 90x90 --over samples=1 --beside other=1:ball.pfm
grep -q 'ball.pfm: is no colour picture of 90 x 90 pixels' err || fail "$(cat err)"

run 2 chart
run 2 chart -o small --over samples
run 2 chart -o small --beside other=1:ball.pfm
for over in bogus samples=0 method=conik error=-1 budget=0 as=splats isa=mmx method=conic+ =1; do
  run 2 chart ball.cot -o small --over "$over"
  grep -q "chart: .*${over%%=*}" err || fail "$over: $(cat err)"
done
# What has no effect on a scene is no axis of it
for over in fov=40 only=triangles as=mesh profile=exact; do
  run 2 chart ball.ply -o small --camera camera.json --over "$over"
  grep -q 'has no effect' err || fail "$over: $(cat err)"
done
run 2 chart -o small --shade none
grep -q 'chart: --shade has no effect: it is of a SCENE' err || fail "$(cat err)"
run 3 chart missing.ply other.ply -o small
run 3 chart -o small --quick --mesh missing.obj
run 4 chart -o missing/folder --quick
[[ $failures -eq 0 ]]
