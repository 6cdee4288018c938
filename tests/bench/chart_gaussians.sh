#!/usr/bin/env bash
# conic chart of a Gaussian scene: a line a profile, errors that are as they must be of one Gaussian, and fronts.
set -uo pipefail

source "$1/tests/support/program.bash"

# One round Gaussian of opacity ½ and no turn, as .splat has it.
row='\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\200\77\0\0\200\77\377\200\100\200\377\200\200\200'
printf "$row" > one.splat
run 0 chart one.splat -o one --size 31x31 --pixels 130 --quick --json chart.json
grep -q '^profile  .*overlap: max' out || fail "no table printed"
grep -q '"truth_pixels": 100,' chart.json || fail "not every third pixel across and down: $(grep truth chart.json)"
awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; columns = NF; next }
  NF != columns { print "line " NR " has " NF " columns"; bad = 1 }
  {
    p = $1; n++; rmse[p] = $at["overlap_rmse"]; ms[p] = $at["ms"]; front[p] = $at["overlap_front"]
    if (!($at["ms"] > 0 && $at["drawn"] == 1 && $at["pairs"] > 100)) { print p ": time or counts"; bad = 1 }
    if (!($at["volume_rmse"] > rmse["exact"] && $at["volume_max"] >= $at["volume_rmse"])) { print p ": volume"; bad = 1 }
    if (p == "exact" && !($at["overlap_max"] <= 1 / 255 && rmse[p] > 0)) { print "exact is not the overlap of one"; bad = 1 }
    if (p ~ /^(gsplat|inria)/ && !(rmse[p] > 2 * rmse["exact"])) { print p ": no dilation, no affine error"; bad = 1 }
  }
  END {
    if (n != 15 || "2dgs-2024" in rmse) { print n " profiles"; bad = 1 }
    for (p in rmse)
      for (q in rmse)
        if (front[p] && ms[q] < ms[p] && rmse[q] < rmse[p]) { print p " is beaten"; bad = 1 }
    if (!front["exact"] && !front["3dgut-2025"]) { print "no ray is on the front"; bad = 1 } # of one they are the same
    exit bad
  }' one/profiles.csv || fail "the table is not sound: $(cat one/profiles.csv)"
[[ $(grep -cE '^<(circle|polygon) ' one/profiles.svg) -eq 45 && $(tail -n 1 one/profiles.svg) == '</svg>' && ! -e one/chart.csv ]] ||
  fail "not that chart alone, with a mark a profile and truth and each in the legend"

run 3 chart missing.ply -o one
run 2 chart one.splat -o one --only methods
run 2 chart one.splat -o one --mesh some.obj
[[ $failures -eq 0 ]]
