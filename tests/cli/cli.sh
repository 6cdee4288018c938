#!/usr/bin/env bash
# The program as its users and their scripts rely on it: help, exit codes, messages, and nothing half-written.
set -uo pipefail

source "$1/tests/support/program.bash"
# The same for a run that must fail: one line on standard error, in the one form; nothing on standard output.
run_wrong() { # EXIT_CODE, PATTERN, ARGUMENTS …
  local pattern=$2
  run "$1" "${@:3}"
  [[ ! -s out ]] || fail "conic ${*:3}: something on standard output"
  [[ $(wc -l < err) -eq 1 ]] || fail "conic ${*:3}: not one line of error: $(head -c 300 err)"
  grep -q '^conic: error: ' err || fail "conic ${*:3}: not an error line: $(head -c 300 err)"
  grep -qe "$pattern" err || fail "conic ${*:3}: no \"$pattern\" in: $(head -c 300 err)"
}
no_files_but() { # NAMES: what may be in the folder `outputs`
  local found
  found=$(cd outputs && find . -mindepth 1 -printf '%P ')
  [[ $found == "$*" ]] || fail "left in the folder: $found"
}
mkdir outputs

# Help and version
run 2
[[ ! -s out && -s err ]] || fail "without arguments the short help belongs on standard error"
grep -q '^usage: conic ' err || fail "no usage without arguments"
run 0 help
[[ -s out && ! -s err ]] || fail "help belongs on standard output"
cp out help
for ask in --help -h; do
  run 0 $ask
  cmp -s out help || fail "conic $ask is not conic help"
done
for command in make prepare render diff verify info explain chart bench; do
  grep -q "^  $command " help || fail "conic help does not list $command"
  run 0 help $command
  [[ -s out && ! -s err ]] || fail "conic help $command belongs on standard output"
  grep -q "^usage: conic $command" out || fail "conic help $command shows no usage"
  grep -qe "^  --quiet, -q " out || fail "conic help $command shows no common options"
  cp out help_command
  run 0 $command --help
  cmp -s out help_command || fail "conic $command --help is not conic help $command"
done
run 0 -V
cp out version
run 0 --version
cmp -s out version || fail "conic -V is not conic --version"
grep -qE '^conic [0-9]+\.[0-9]+\.[0-9]+$' out || fail "no version"
grep -q 'BSD-3-Clause' out || fail "no license"
grep -q '^In this build:' out || fail "no features"
grep -q 'CURL' out || fail "it is not said whether libcurl is in"

# Wrong usage
run_wrong 2 'did you mean render?' rendr
run_wrong 2 'did you mean prepare?' help prepar
run_wrong 2 'did you mean --version?' --versoin
run_wrong 2 'unknown option -o; see conic help' explain -o a.png # and not: did you mean --fov?
: > ./-a.ply
run_wrong 2 'is ./-a.ply' info -a.ply
run_wrong 2 'standard input' diff - -
run_wrong 2 'web server' info http://localhost/a.lpc
run_wrong 2 'unknown command xyzzy' xyzzy
for command in make prepare render diff verify info explain chart bench; do
  run_wrong 2 'did you mean --quiet?' $command --quite
  run_wrong 2 'threads' $command --threads many
  run_wrong 2 'needs a value' $command --json
done
run_wrong 2 '' make
run_wrong 2 '' make nothing-known -n 10 -o outputs/a.ply
run_wrong 2 '' make sphere -n 10
run_wrong 2 '' render
run_wrong 2 '' diff one.pfm
run_wrong 2 'standard output' make sphere -n 10 -o - --json -
for arguments in "render|-o|outputs/a.pfm|" "info|" "prepare|a.ply|-o|" "render|a.ply|-o|outputs/a.pfm|--json|"; do
  IFS='|' read -ra words <<< "$arguments" # as from a variable that was never set
  run_wrong 2 "an argument is empty\|\"\" is not understood" "${words[@]}" ""
done
# What cannot be written is said before anything is read
run_wrong 2 'standard output' render absent.ply -o - -o -
run_wrong 2 'needs an ending' render absent.ply -o outputs/a
run_wrong 2 'camera' render absent.ply -o outputs/a.pfm --camera absent.json --zoom 2
run_wrong 2 'planes: rgba' render absent.ply -o outputs/a.pfm --aov depth
run_wrong 2 'no output holds the plane Z' render absent.ply -o outputs/a.png --aov rgba,Z
run_wrong 2 'needs --method patch' render absent.ply -o outputs/a.pfm --degree 2
run_wrong 4 'outputs/none/a.pfm: cannot write' render absent.ply -o outputs/none/a.pfm
run_wrong 4 'outputs/none/a.json: cannot write' verify absent.ply --json outputs/none/a.json
for command in prepare octree layer hybrid 'mls project'; do # $command is one or two words
  case $command in octree) ending=cot ;; layer) ending=lpc ;; hybrid) ending=chy ;; *) ending=ply ;; esac
  run_wrong 4 'outputs/none/a: cannot write' $command absent.ply -o outputs/none/a
  run_wrong 4 'outputs: cannot write: it is a directory' $command absent.ply -o outputs
  run_wrong 2 "give the name the ending .$ending" $command absent.ply -o outputs/a.PNG
done
run_wrong 4 'cannot make the folder' chart -o "$conic" --quick
# Nor is what the work would be done with
absent_isa=neon
[[ $(uname -m) == x86_64 ]] || absent_isa=avx2
for command in 'render -o outputs/a.pfm' verify 'explain --pixel 1,1' 'mls project -o outputs/a.ply' bench; do
  # shellcheck disable=SC2086 # the options are words
  run_wrong 4 "no $absent_isa" $command absent.ply --isa $absent_isa
done
for command in 'render -o outputs/a.pfm' verify 'explain --pixel 1,1' bench; do
  # shellcheck disable=SC2086
  run_wrong 4 'opencl' $command absent.ply --device opencl:77.0
  # shellcheck disable=SC2086
  run_wrong 3 'absent.json' $command absent.ply --camera absent.json
done
run_wrong 3 'absent.png' render absent.obj -o outputs/a.pfm --as mesh --texture absent.png
# Nor is anything read that may never end
mkfifo pipe.png
run_wrong 3 'pipe.png: cannot read: it is no regular file' render absent.obj -o outputs/a.pfm --as mesh --texture pipe.png
run_wrong 3 '/dev/zero: cannot read: it is no regular file' render absent.obj -o outputs/a.pfm --as mesh --texture /dev/zero
run_wrong 3 'pipe.png: cannot read: it is no regular file' diff pipe.png pipe.png
printf '%s\n' 'v 0 0 0' 'v 1 0 0' 'v 0 1 0' 'vt 0 0' 'f 1/1 2/1 3/1' > one.obj
"$conic" render --plain one.obj -o large.pfm --size 512x512
run_wrong 3 '512 × 512 pixels takes 6 MiB' render one.obj -o outputs/a.pfm --as mesh --texture large.pfm --max-texture 5
run_wrong 3 '512 × 512 pixels takes 6 MiB' hybrid one.obj -o outputs/a.chy --texture large.pfm --max-texture 5
"$conic" render --plain one.obj -o b.pfm --size 64x64 --as mesh --texture large.pfm --max-texture 6 || fail "a texture that fits"
# A file has many names: none of the outputs is another one, or what the work begins with
mkdir linked
: > linked/there.pfm
: > linked/there.ply
ln -s linked elsewhere
ln -s linked/there.pfm linked.pfm
ln linked/there.ply twin.ply
for pair in 'outputs/a.pfm ./outputs/a.pfm' "outputs/a.pfm $work/outputs/a.pfm" 'linked/a.pfm elsewhere/a.pfm' \
  'linked/there.pfm linked.pfm' 'a.pfm ./a.pfm'; do
  run_wrong 2 'two outputs' render absent.ply -o "${pair% *}" -o "${pair#* }"
done
for name in linked/there.ply elsewhere/there.ply twin.ply; do
  run_wrong 2 "$name is an input" render ./linked/there.ply -o outputs/a.pfm --json $name
  run_wrong 2 "$name is an input" info ./linked/there.ply --json $name
done
run_wrong 2 'is an input' diff linked.pfm outputs/a.pfm --heatmap linked/there.pfm
run_wrong 2 'is an input' layer linked/there.ply -o twin.lpc --json twin.ply
no_files_but

# Inputs that cannot be used
run_wrong 3 'absent.ply' info absent.ply
run_wrong 3 'absent.ply' render absent.ply -o outputs/a.pfm
run_wrong 3 'absent.ply' prepare absent.ply -o outputs/a.ply
run_wrong 3 'absent.pfm' diff absent.pfm absent.pfm
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0\n' \
  > short.ply
head -c 5000 /dev/zero > zeros.ply
: > empty.ply
for input in short.ply zeros.ply empty.ply .; do
  run_wrong 3 "^conic: error: $input: " render $input -o outputs/a.pfm
done
no_files_but

# Resources that fail
run_wrong 4 'outputs/none/a.ply' make sphere -n 10 -o outputs/none/a.ply
run_wrong 4 'outputs' make sphere -n 10 -o outputs
run_wrong 4 'outputs/none/a.json' make sphere -n 10 -o outputs/a.ply --json outputs/none/a.json
rm -f outputs/a.ply
if [[ -w /dev/full ]]; then
  run_wrong 4 '/dev/full' make sphere -n 100000 -o /dev/full
  "$conic" help > /dev/full 2> err
  [[ $? -eq 4 ]] || fail "help on a full disk: exit code"
  "$conic" --version > /dev/full 2> err
  [[ $? -eq 4 ]] || fail "version on a full disk: exit code"
  "$conic" make sphere -n 10 -o outputs/a.ply --json - > /dev/full 2> err
  [[ $? -eq 4 ]] || fail "statistics on a full disk: exit code"
  rm -f outputs/a.ply
fi
no_files_but

# Done: pictures of the same splats are equal, of others different
run 0 make sphere -n 2000 -o a.ply --json -
head -n 1 out | grep -q '^{$' || fail "statistics do not begin the standard output"
tail -n 1 out | grep -q '^}$' || fail "statistics do not end the standard output"
grep -q '"points_out": 2000' out || fail "statistics without points_out"
run 0 make torus -n 2000 -o - # the same bytes by way of a pipe
cp out b.ply
run 0 make torus -n 2000 -o c.ply
cmp -s b.ply c.ply || fail "make writes other bytes to standard output"
[[ ! -s err ]] || fail "make says something without a terminal: $(head -c 300 err)"
for scene in a b c; do
  run 0 render $scene.ply -o $scene.pfm --size 64x48
  [[ ! -s out && ! -s err ]] || fail "render says something without a terminal: $(head -c 300 err)"
done
run 0 render a.ply -o empty.pfm --size 64x48 --near 1e6
[[ $(cat err) == 'conic: warning: a.ply: the picture is empty: all is out of sight' ]] || fail "nothing is said of an empty picture"
for quiet in --quiet -q; do
  run 0 render a.ply -o empty.pfm --size 64x48 --near 1e6 $quiet --fov 30 --fov 31
  [[ ! -s err ]] || fail "a run with $quiet speaks: $(cat err)"
done
# Of an option that is given twice the last value holds, and the one that is lost is named
run 0 render a.ply -o twice.pfm --size 8x8 --size 64x48 --fov 40 --fov 40 -o again.pfm
[[ $(cat err) == 'conic: warning: render: --size 64x48 holds, and not 8x8, which was given before it' ]] ||
  fail "of an option that is given twice: $(cat err)"
run 0 diff a.pfm twice.pfm
run 0 diff a.pfm again.pfm
run 0 octree a.ply -o a.cot
run_wrong 3 'this is a point-octree' prepare a.cot -o outputs/a.ply
run 0 prepare a.ply --count 500 -o few.ply
run 0 prepare a.ply --count 500 --ellipse voronoi -o named.ply
run 0 prepare a.ply --count 500 --ellipse bounding -o bounding.ply
cmp -s few.ply named.ply || fail "--ellipse voronoi is not the default"
cmp -s few.ply bounding.ply && fail "--ellipse bounding changes nothing"
run_wrong 2 'ellipse' prepare a.ply --ellipse delaunay -o outputs/a.ply
run 0 diff b.pfm c.pfm
run 1 diff a.pfm b.pfm
run 1 diff a.pfm b.pfm --max-abs 0.0001
run 0 diff a.pfm b.pfm --max-abs 1e9
run_wrong 3 'b.ply' diff a.pfm b.ply
run 0 info a.ply --json -
grep -q '"points": 2000' out || fail "info does not count"

# What --verbose says is on standard error, and nowhere without it
printf 'v %s\n' '0 0 0' '1 0 0' '1 0 1' '0 0 1' > square.obj
printf 'f 1 2 3 4\n' >> square.obj
has_zstd=$("$conic" --version | grep -c '^In this build:.* zstd')
for command in 'make torus -n 2000 -o told.ply' 'prepare a.ply -o told.ply' 'octree a.ply -o told.cot' \
  'layer a.ply -o told.lpc' 'hybrid square.obj -o told.chy' 'mls project a.ply -o told.ply' \
  'mls thin a.ply -o told.ply --count 500' 'render a.ply -o told.pfm --size 64x48'; do
  [[ $command == layer* && $has_zstd -eq 0 ]] && continue
  # shellcheck disable=SC2086
  run 0 $command --verbose
  [[ ! -s out ]] || fail "conic $command --verbose: something on standard output"
  grep -q '^conic: .* in all, [0-9]* MiB of memory at most$' err || fail "conic $command --verbose: no times: $(cat err)"
  grep -q 'write [0-9.]* m\?s' err || fail "conic $command --verbose: no stages: $(cat err)"
  grep -qv 'in all' err || fail "conic $command --verbose: nothing of what was done: $(cat err)"
  # shellcheck disable=SC2086
  run 0 $command -v -v
  grep -q '^conic: .* in all' err || fail "conic $command -v is not --verbose: $(cat err)"
  # shellcheck disable=SC2086
  run 0 $command
  [[ ! -s err ]] || fail "conic $command: not silent: $(cat err)"
done
# What makes points of a mesh says so
for command in 'prepare square.obj -o told.ply' 'octree square.obj -o told.cot' 'layer square.obj -o told.lpc'; do
  [[ $command == layer* && $has_zstd -eq 0 ]] && continue
  # shellcheck disable=SC2086
  run 0 $command
  grep -q '^conic: warning: square.obj: .* 2 faces are left out; conic render --as mesh' err ||
    fail "conic $command loses faces in silence: $(cat err)"
done
printf '0 0 0\n1 0 0\n0 1 0\n1 1 0\n1 1 0\nnan 0 0\n' > odd.xyz
for command in 'prepare -o told.ply' 'octree -o told.cot' 'render --size 64x48 -o told.pfm'; do
  # shellcheck disable=SC2086
  run 0 $command odd.xyz --verbose
  grep -q '^conic: odd.xyz: of the points: 1 left out, not finite.*1 at the place of another' err ||
    fail "conic $command --verbose does not say what was left out: $(cat err)"
done

# What lies too far out is left out as what is not finite is, and all say so
printf '0 0 0\n0 1e30 0\n' > giant.xyz
for command in 'render --size 16x16 -o far.pfm' 'octree -o far.cot' 'prepare -o far.ply' 'info --check' \
  'mls thin -o far.ply --count 1'; do
  # shellcheck disable=SC2086
  run 0 $command giant.xyz
  grep -q 'giant.xyz: 1 points are left out, which are farther out than 1e20' err ||
    fail "conic $command does not say that a point is left out: $(cat err)"
done
run 0 info giant.xyz --check
grep -q '^sound *no' out || fail "info takes what cannot be drawn for sound"
grep -q '^bounds *0 0 0 to 0 0 0' out || fail "info has bounds that are not drawn: $(cat out)"
printf '0 1e300 0\n' >> giant.xyz
run 0 render giant.xyz --size 16x16 -o farther.pfm
grep -q 'giant.xyz: 2 points are left out' err || fail "points that floats do not hold are told otherwise: $(cat err)"
printf '1e30 0 0\n' > giant.xyz
run_wrong 3 'giant.xyz: cannot be drawn: ' render giant.xyz -o outputs/a.pfm

# A table that has no line has no head
run_wrong 3 'absent.ply' bench absent.ply

[[ $failures -eq 0 ]]
