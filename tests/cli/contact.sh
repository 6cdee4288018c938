#!/usr/bin/env bash
# conic contact: what is on the sheet, in which order, and what is said of what cannot be read.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

mkdir scans
run 0 make sphere -n 300 -o scans/b.ply
run 0 make gaussians -n 60 -o scans/c.ply
run 0 render scans/b.ply --size 40x20 --shade none --background 1,0,0 -o scans/a.png
echo nonsense > scans/d.ply
echo words > scans/README.md
count() { # KEY
  sed -nE "s/^ *\"$1\": ([0-9]+),?$/\1/p" sheet.json
}
run 0 contact scans -o sheet.png --size 32 --columns 3 --json sheet.json
[[ $(count files) -eq 4 && $(count unreadable) -eq 1 && ! -s err ]] || fail "a folder: $(cat sheet.json err)"
[[ $(count width) -eq $((14 + 3 * 46)) && $(count height) -eq $((2 * 82)) ]] || fail "its size: $(cat sheet.json)"
# The same by names, on one thread, but not in another order.
run 0 contact scans/a.png scans/b.ply scans/c.ply scans/d.ply -o named.png --size 32 --columns 3 --threads 1
cmp -s sheet.png named.png || fail "names or threads change the sheet"
run 0 contact scans/b.ply scans/a.png scans/c.ply scans/d.ply -o other.png --size 32 --columns 3
cmp -s sheet.png other.png && fail "the order does not change the sheet"
run 0 contact scans/d.ply gone.ply -o none.png --json sheet.json
[[ $(count unreadable) -eq 2 ]] || fail "two that cannot be read: $(cat sheet.json)"

mkdir empty
for options in "" "scans" "scans -o x.jpg" "scans/a.png -o scans/a.png"; do
  # shellcheck disable=SC2086 # several words
  run 2 contact $options
done
run 2 contact scans -o x.jpg
grep -q 'contact: x.jpg: a contact sheet is a .png' err || fail "$(cat err)"
run 3 contact empty -o y.png
[[ ! -e y.png ]] || fail "a sheet that was refused is there"
[[ $failures -eq 0 ]]
