#!/usr/bin/env bash
# Inputs of bad shapes, which take no more than what their number asks for: each command is stopped after a minute of
# processor time, of which it needs a second. scripts/linear measures more of them.
set -uo pipefail

# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"
ulimit -t 60

# A PLY of very many elements.
python3 - << 'P'
n = 100000
elements = "".join(f"element e{i} 0\nproperty float x\n" for i in range(n))
with open("elements.ply", "w") as file:
    file.write(f"ply\nformat ascii 1.0\n{elements}element vertex 1\nproperty float x\nproperty float y\n"
               "property float z\nend_header\n0 0 0\n")
with open("fan.obj", "w") as file:  # faces about one vertex
    file.write("v 0 0 0\n" + "".join(f"v {i % 300 + 1} {i // 300} 1\n" for i in range(20001)))
    file.write("".join(f"f 1 {i + 2} {i + 3}\n" for i in range(20000)))
with open("edge.obj", "w") as file:  # faces on one edge
    file.write("v 0 0 0\nv 1 0 0\n" + "".join(f"v 0 {i % 100 + 1} {i // 100}\n" for i in range(2000)))
    file.write("".join(f"f 1 2 {i + 3}\n" for i in range(2000)))
with open("stray.xyz", "w") as file:
    file.write("".join(f"{i % 100} {i // 100} 0\n" for i in range(5000)) + "1e7 0 0\n")
P
run 3 info elements.ply
grep -q 'too many elements' err || fail "nothing is said of elements: $(head -c 300 err)"
run 0 render fan.obj -o fan.pfm --size 64x64 --error 1
run 0 render edge.obj -o edge.pfm --size 64x64 --error 1
run 0 hybrid edge.obj -o edge.chy

# Points far from all others get no surface that joins them.
run 0 mls densify stray.xyz -o dense.ply
n=$(sed -n 's/^element vertex //p' dense.ply | head -n 1)
[[ $n -ge 5001 && $n -lt 100000 ]] || fail "5,001 points became $n"

[[ $failures -eq 0 ]]
