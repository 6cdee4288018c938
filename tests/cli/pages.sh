#!/usr/bin/env bash
# The commands that pages show are commands: each as it is printed, from README, guide and reference. None is wrong usage
# (2), whatever files there are; and those that make what they draw, and follow each other on a page, do what they say.
set -uo pipefail

source "$1/tests/support/program.bash"

# commands PAGE: of its blocks of code, a line each, without comments; what servers have would be here
commands() {
  perl -0777 -ne 's/\\\n\s*/ /g; while (/^```(?:bash|sh)?\n(.*?)^```/msg) { for (split /\n/, $1) {
    next unless s/^conic //; s/\s+#\s.*//; s{https?://[\w.]+/}{}g; print "$_\n" } }' "$1"
}
n=0
mkdir empty && cd empty || exit 1
for page in "$1"/README.md "$1"/docs/guide/*.md "$1"/docs/reference/*.md; do
  while read -r line; do
    n=$((n + 1))
    [[ $line != make\ * && $line != bench\ * && $line != conformance\ * && $line != devices* ]] || continue
    line=${line%% && *}
    timeout 60 bash -c "shopt -s nullglob; exec \"\$0\" $line" "$conic" > ../out 2> ../err < /dev/null
    code=$?
    [[ $code -ne 2 && $code -lt 5 ]] || fail "$(basename "$page"): conic $line: exit code $code: $(head -c 300 ../err)"
  done < <(commands "$page")
done
[[ $n -ge 60 ]] || fail "only $n commands are found"
cd ..

# Wrong ones are seen.
printf '```\nconic render scan.ply --zoon 2 -o scan.png\n```\n' > page.md
run 2 $(commands page.md)

# From the first to the last, on pages that need nothing else.
mkdir whole && cd whole || exit 1
run_as_typed 0 make knot -n 2k -o scan.ply
while read -r line; do
  bash -c "exec \"\$0\" $line" "$conic" > out 2> err < /dev/null || fail "README: conic $line: $(cat err)"
done < <(commands "$1/README.md" | grep '^render ')
[[ -s scan.png ]] || fail "README's first command draws nothing"
while read -r line; do
  line=${line//1920x1080/48x27} line=${line//256x256/32x32} line=${line//20k/500} line=${line//20000/200}
  [[ $line != *'&&'* ]] || line="${line/ && / --size 32x32 && } --size 32x32"
  bash -c "conic() { '$conic' \"\$@\"; }; conic $line" > out 2> err < /dev/null || fail "oracle.md: conic $line: $(cat err)"
done < <(commands "$1/docs/reference/oracle.md")
