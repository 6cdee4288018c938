#!/usr/bin/env bash
# conic mls: what the command line promises.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

value() { # KEY FILE: the first value of a key in a JSON file
  sed -nE "s/^ *\"$1\": \"?([^\",]*)\"?,?$/\1/p" "$2" | head -n 1
}

holds() { # an awk expression
  awk "BEGIN { exit !($1) }" || fail "not so: $1"
}

run 0 make torus -n 20k --jitter 0.5 --noise 0.2 -o torus.ply

# Project: every point is somewhere, or counted.
for options in "" "--plane fast" "--type apss" "--weight compact --degree 2" "--h 2.5x --neglect 3" "--cluster 0.3"; do
  # shellcheck disable=SC2086 # options are words
  run 0 mls project torus.ply -o clean.ply $options --json clean.json
  n_in=$(value points_in clean.json) n_out=$(value points_out clean.json)
  [[ $n_in == 20000 && $((n_in - n_out)) == "$(value failed clean.json)" ]] || fail "mls project $options: counts"
  [[ $n_out -gt 19000 && $(value "done" clean.json) == "$n_out" ]] || fail "mls project $options: $n_out points"
  run 0 info clean.ply --check
done
run 0 mls project torus.ply -o all.ply
for options in "--threads 1" "--isa scalar" "--isa sse2"; do
  # shellcheck disable=SC2086
  run 0 mls project torus.ply -o again.ply $options
  cmp -s again.ply all.ply || fail "mls project $options: other bytes"
done

# One h for all: cell by cell, with the same bytes whatever memory there is.
run 0 mls project torus.ply -o all-h.ply --h 0.06 --json all.json
for options in "--memory 14" "--memory 100 --threads 1 --isa scalar"; do
  # shellcheck disable=SC2086
  run 0 mls project torus.ply -o again.ply --h 0.06 $options --json again.json
  cmp -s again.ply all-h.ply || fail "mls project $options: other bytes"
  [[ $(value points_out again.json) == "$(value points_out all.json)" ]] || fail "mls project $options: other counts"
done
run 4 mls project torus.ply -o x.ply --h 0.06 --memory 1
# Spheres find the normals that a file lacks, also cell by cell: an unknown side changes nothing.
awk 'BEGIN { srand(5); for (i = 0; i < 4000; i++) { z = 2 * rand() - 1; r = sqrt(1 - z * z); a = 6.2831853 * rand()
  s = 5 + 0.01 * (rand() - 0.5); print s * r * cos(a), s * r * sin(a), s * z } }' > globe.xyz
run 0 mls project globe.xyz -o globe.ply --type apss --h 0.4
for memory in 14 100; do
  run 0 mls project globe.xyz -o globe-$memory.ply --type apss --h 0.4 --memory $memory --json globe.json
  holds "$(value points_out globe.json) > 3900 && $(value rms globe.json) < 0.01"
done
cmp -s globe-14.ply globe-100.ply || fail "memory changes what spheres of points without normals give"

run 2 mls project torus.ply -o x.ply --memory 100
run 2 mls project torus.ply -o x.ply --h 2x --memory 100
run 2 mls project - -o x.ply --h 0.06 --memory 100
run 2 mls thin torus.ply -o x.ply --h 0.06 --memory 100 --count 10
[[ ! -e x.ply && -z $(compgen -G '.conic-spool*') ]] || fail "something was left of what failed"

# Raw points get sides, meshes are sets of vertices, and pipes work.
printf '%s %s %s\n' $(for ((i = 0; i < 400; i++)); do echo $((i % 20)) $((i / 20)) $((i * 37 % 5)).0e-1; done) > raw.xyz
run 0 mls project raw.xyz -o raw.ply --degree 1
head -c 300 raw.ply | grep -aq 'property float nx' || fail "no normals"
"$conic" mls project - -o - < torus.ply > piped.ply || fail "from and to a pipe"
cmp -s piped.ply all.ply || fail "a pipe changes the file"

# What each point matters, as a value; to all of them where none is taken away.
run 0 mls thin all.ply -o values.ply --count 1M --keep contribution
run 0 render values.ply -o values.pfm --color-by contribution --size 64x64
run 2 mls project all.ply -o x.ply --keep contribution

# Thin: to a count, within an error that was measured.
run 0 mls thin all.ply -o thin.ply --count 4k --json thin.json
[[ $(value points_out thin.json) == 4000 ]] || fail "mls thin --count"
holds "$(value hausdorff thin.json) > 0"
run 0 mls thin all.ply -o thin.ply --max-error 0.5x --json thin.json
spacing=0.0222
holds "$(value hausdorff thin.json) <= 0.5 * $spacing * 1.2 && $(value points_out thin.json) < 15000"

# Densify: more of them.
run 0 mls densify thin.ply -o dense.ply --spacing 0.3x --json dense.json
holds "$(value points_out dense.json) > 2 * $(value points_in dense.json)"
run 0 mls thin thin.ply -o tenth.ply --json tenth.json
holds "$(value points_out tenth.json) == int($(value points_in tenth.json) / 10) + 1"
run 0 mls densify tenth.ply -o dense.ply --json dense.json
holds "$(value points_out dense.json) > 2 * $(value points_in dense.json)"

# Sharp: clip lines at a cube's edges, the same bytes everywhere; what has none has none.
run 0 make cube -n 1500 -o cube.ply
run 0 mls project cube.ply -o sharp.ply --sharp
head -c 600 sharp.ply | grep -aq clip || fail "mls project --sharp: no clip lines"
run 0 mls project cube.ply -o again.ply --sharp --threads 1 --isa scalar
cmp -s again.ply sharp.ply || fail "mls project --sharp: other bytes"
run 0 mls thin cube.ply -o sharp.ply --count 600 --sharp
head -c 600 sharp.ply | grep -aq clip || fail "mls thin --sharp: no clip lines"

run 0 mls densify thin.ply -o dense.ply --spacing 0.01 --count 3000 --json dense.json
[[ $(value points_out dense.json) -le 3000 || $(value points_in dense.json) -gt 3000 ]] || fail "mls densify --count"
run 0 render dense.ply -o dense.pfm --size 64x64

# The outlines of a sheet's border reach beyond it, and cover as much when points are added.
printf '%s %s 0 0 0 1\n' $(for ((i = 0; i < 100; i++)); do echo $((i % 10)) $((i / 10)); done) > sheet.txt
run 0 mls densify sheet.txt --columns x,y,z,nx,ny,nz -o sheet-dense.ply --spacing 0.25
head -c 400 sheet-dense.ply | grep -aq tu_x || fail "densified points have no ellipses"
run 0 prepare sheet.txt --columns x,y,z,nx,ny,nz -o sheet.ply --plain
for name in sheet sheet-dense; do
  run 0 render $name.ply -o $name.pfm --aov Z --samples 1 --size 64x64 --up z --elevation 89 --zoom 0.7
  tail -c 16384 $name.pfm | od -An -v -tf4 -w4 | grep -vc -e inf -e ' 0$' > $name.covered
done
holds "$(cat sheet-dense.covered) >= 0.98 * $(cat sheet.covered) && $(cat sheet.covered) < 4000"

# Of a ball, far from the origin, coarse outlines stand out; the dense one ends where the ball does, without a hole.
awk 'BEGIN { for (i = 0; i < 200; i++) { z = (2 * i + 1) / 200 - 1; r = sqrt(1 - z * z); a = 2.399963 * i
  print 10 + r * cos(a), r * sin(a), z, r * cos(a), r * sin(a), z } }' > ball.txt
run 0 mls densify ball.txt --columns x,y,z,nx,ny,nz -o ball-dense.ply --spacing 0.05
run 0 prepare ball.txt --columns x,y,z,nx,ny,nz -o ball.ply --plain
for name in ball ball-dense; do
  run 0 render $name.ply -o $name.pfm --aov Z --samples 1 --size 128x128 --up y --azimuth 0 --elevation 0 --eye 10,0,5 --fov 30
  tail -c 65536 $name.pfm | od -An -v -tf4 -w4 | grep -vc -e inf -e ' 0$' > $name.covered
done
# From a distance of 5 a ball of radius 1 covers (64 / (tan 15° sqrt(24)))² pi = 7,463 pixels, and what filters add.
holds "$(cat ball-dense.covered) > 7463 && $(cat ball-dense.covered) < 0.95 * $(cat ball.covered)"

# Of a wide sheet a tenth covers all of it, and reaches little beyond.
printf '%s %s 0 0 0 1\n' $(for ((i = 0; i < 900; i++)); do echo $((i % 30)) $((i / 30)); done) > wide.txt
run 0 mls thin wide.txt --columns x,y,z,nx,ny,nz -o few.ply --count 90
run 0 prepare wide.txt --columns x,y,z,nx,ny,nz -o wide.ply --plain
for name in wide few; do
  run 0 render $name.ply -o $name.pfm --aov Z --samples 1 --size 64x64 --up y --eye 14.5,14.5,50 --fov 50
  tail -c 16384 $name.pfm | od -An -v -tf4 -w4 | grep -vc -e inf -e ' 0$' > $name.covered
done
holds "$(cat few.covered) >= $(cat wide.covered) && $(cat few.covered) <= 1.3 * $(cat wide.covered)"

# What is asked for in vain.
run 2 mls
run 2 mls smooth torus.ply -o x.ply
run 2 mls project
run 2 mls project torus.ply
run 2 mls project torus.ply all.ply -o x.ply
run 2 mls project torus.ply -o x.ply --sharp --h 0.06 --memory 100
run 2 mls project torus.ply -o x.ply --sharp --cluster 0.3
run 2 mls project torus.ply -o x.ply --count 3
run 2 mls project torus.ply -o x.ply --degree 5
run 2 mls project torus.ply -o - --json -
run 3 mls project missing.ply -o x.ply
run 3 mls project torus.ply -o x.ply --h 1e-9
grep -q 'too few neighbours' err || fail "no reason given"
printf '1 2 3\n%.0s' {1..30} > same.xyz
run 3 mls densify same.xyz -o x.ply --spacing 1x
grep -q '^conic: error: same.xyz: no two points are apart' err || fail "a spacing of points that are not apart: $(cat err)"
run 4 mls project torus.ply -o /nowhere/x.ply
printf 'nan 0 0\n0 inf 0\n' > nan.xyz
printf '0\n' > none.pts
for memory in "" "--memory 100"; do
  # shellcheck disable=SC2086
  run 3 mls project nan.xyz -o x.ply --h 0.1 $memory
  grep -q '^conic: error: nan.xyz: .*no point is finite$' err || fail "points that are not finite: $(cat err)"
  # shellcheck disable=SC2086
  run 3 mls project none.pts -o x.ply --h 0.1 $memory
  grep -q '^conic: error: none.pts: .*it holds no points$' err || fail "no points: $(cat err)"
done
[[ ! -e x.ply ]] || fail "a file of a run that failed"


# One point has no surface, and no sheets that it could lie between.
echo 1 2 3 0 0 1 > one.xyz
run 3 mls project one.xyz -o one.ply
[[ $failures -eq 0 ]]
