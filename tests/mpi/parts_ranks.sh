#!/usr/bin/env bash
# conic-mpi: of files of splats each rank reads a part, and draws what its windows see: the bits and the facts of one
# process. What needs all of a file is given all of it.
set -uo pipefail

source "$1/tests/support/program.bash"
source "$1/tests/support/ranks.bash"

# Random splats with axes about a place, and of these (all are there if N is above 30): one larger than the others
# together, one that is nowhere, one that is infinitely far, one without a colour that can be seen.
splats() { # N, SEED, X, TYPE OF x y z, COLUMNS BESIDE
  perl -e '
    my ($n, $seed, $x, $type, $more) = @ARGV;
    srand($seed);
    my %pack = (double => "d<", float => "f<", uchar => "C");
    my @axes = qw(tu_x tu_y tu_z tv_x tv_y tv_z);
    my @beside = split / /, $more;
    binmode STDOUT;
    print "ply\nformat binary_little_endian 1.0\nelement vertex $n\n", map("property $type $_\n", qw(x y z)),
      map("property float $_\n", @axes), map("property " . ($_ eq "opacity" ? "float" : "uchar") . " $_\n", @beside),
      "end_header\n";
    for my $i (0 .. $n - 1) {
      my @p = map { rand(2) + rand(2) + $_ } $x, 2 * $x, 0;
      my @u = map { (rand(2) - 1) / 8 } 1 .. 3;
      my @v = ($u[1], -$u[0], 0);
      @p = ($x + 2, 2 * $x + 2, 2), @u = (2, 0, 0), @v = (0, 0, 2) if $n > 30 && $i == 7;
      $p[$i % 3] = 9 ** 9 ** 9 / ($i == 12 ? 9 ** 9 ** 9 : 1) if $n > 30 && ($i == 12 || $i == 25);
      @u = (0, 0, 0) if $seed == 0 && $i == 5;
      print pack("($pack{$type})3 (f<)6", @p, @u, @v), map $_ eq "opacity" ? pack("f<", rand) : pack("C", rand(256)), @beside;
    }' "$@"
}
splats 400 1 0 float "red green blue" > near.ply
splats 300 2 3e5 double "red green blue opacity" > far.ply
splats 40 3 3e5 double "" > plain.ply
splats 3 4 0 float "red green blue" > few.ply
splats 40 0 0 float "red green blue" > needy.ply
"$conic" make knot -n 2500 -o knot.ply --quiet

# What is said of a picture but for times, and what each rank did
facts() { # JSON FILE
  sed '/"team": {/,/^  },/d; /"ms": {/,$d' "$1"
}
compare() { # NAME, RANKS, OPTIONS … of `render`
  local name=$1 n=$2
  err=$name.err ranks "$n" 0 render "${@:3}" --threads 1 -o "$name.exr" --json "$name.json" --trace "$name.trace" ||
    return
  cmp "$name.alone.exr" "$name.exr" || fail "$name: $n ranks make another file"
  [[ $(facts "$name.alone.json") == "$(facts "$name.json")" ]] ||
    fail "$name: $n ranks say otherwise: $(diff <(facts "$name.alone.json") <(facts "$name.json") | head -5)"
}
alone() { # NAME, OPTIONS …
  "$conic" render "${@:2}" --threads 1 -o "$1.alone.exr" --json "$1.alone.json" --quiet || fail "$1: cannot be drawn"
}
alike() { # NAME, RANKS, OPTIONS …
  alone "$1" "${@:3}"
  compare "$@"
  [[ $(grep -c '"splats 0"' "$1.trace") -ge $2 ]] || fail "$1: its splats were not shared"
}

all=(--size 200x130 --aov rgba,Z,N,albedo,weight,count,id)
alike seven 7 near.ply "${all[@]}"
compare seven 4 near.ply "${all[@]}"
alike inside 2 near.ply knot.ply --plain --eye 2,2,2 "${all[@]}"        # where some are behind the eye
alike several 3 far.ply plain.ply --samples 2 --repeat 2 "${all[@]}" # files with other columns and origins
alike gathered 2 few.ply knot.ply --projection fisheye --exposure auto --size 90x70 --aov rgba,id
alike strips 3 knot.ply --size 1100x400 --memory 2 --compression none
alike bands 2 knot.ply --plain --size 1200x70 --samples 16 --fov 2 # each of which is set up by itself

# Light comes from all that there is, and a splat without axes gets them from its neighbours: everybody needs all.
alone needy needy.ply --size 90x70 --aov rgba,id
compare needy 2 needy.ply --size 90x70 --aov rgba,id
alone lit near.ply --size 60x50 --ao 3 --aov rgba,ao
compare lit 2 near.ply --size 60x50 --ao 3 --aov rgba,ao
! grep -q '"splats 0"' needy.trace lit.trace || fail "splats were shared of which everybody needs all"

# Who finds another file is told of, once, and nobody waits.
mkdir here there
cp knot.ply here
head -c 40000 knot.ply > there/knot.ply
printf '#!/bin/sh\ncd "$1" && shift && exec "$@"\n' > within
chmod +x within
"${launcher[@]}" -n 1 ./within here "$conic_mpi" render knot.ply -o a.png : \
  -n 1 ./within there "$conic_mpi" render knot.ply -o a.png > out 2> err < /dev/null
[[ $? -eq 3 && $(grep -c '^conic: ' err) -eq 1 ]] && grep -q '^conic: error: knot.ply: it changes while it is read' err ||
  fail "a part that cannot be read: $(cat err)"
[[ ! -e here/a.png && ! -e there/a.png ]] || fail "there is a picture of what could not be read"

exit $((failures > 0))
