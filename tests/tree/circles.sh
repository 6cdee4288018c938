#!/usr/bin/env bash
# No files of the program call each other in a circle, function by function: each can be read without those that call
# it. The rule is first tried on files that break it.
set -euo pipefail

source_folder=$1
circles=$source_folder/tests/tree/circles.pl
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
n_blind=0

put() { # FILE, LINES
  mkdir -p "$work/$(dirname "$1")"
  printf '%s\n' "${@:2}" > "$work/$1"
}

expect() { # circle or peace: what is said of the files that were put
  local said=circle
  perl "$circles" "$work" > /dev/null && said=peace
  if [[ $said != "$1" ]]; then
    echo "says $said of:"
    find "$work" -type f -exec cat {} +
    n_blind=$((n_blind + 1))
  fi
  rm -rf "${work:?}"/*
}

# Two, and three by a function that is handed over, in different folders.
put a.c 'int one(void) {' '  return two(1);' '}'
put b.c 'int two(int i) {' '  if (i) {' '    return one();' '  }' '  return 0;' '}'
expect circle
put a.c 'int one(void) {' '  return two(1);' '}'
put b/b.c 'static int apart(void) {' '  return three();' '}' 'int two(int i) {' '  return i;' '}'
put c.c 'struct pair *three(' '    int (*call)(int)) {' '  take(one);' '}'
expect circle
# One way, the same name within a file, a name in a comment, a text, a member or a directive, and a function of nobody.
put a.c 'int one(void) {' '  return two(1) + three();' '}' 'static int three(void) { return 1; }'
put b.c '#define TWICE one()' 'int two(int i) {' '  /* one() */' '  return say("one") + x.one + y->one + other();' '}'
put c.c 'int three(void) {' '  return one();' '}'
expect peace
# A function of two systems is called in both.
put a_posix.c 'int one(void) {' '  return 1;' '}'
put a_windows.c 'int one(void) {' '  return two();' '}'
put b.c 'int two(void) {' '  return one();' '}'
expect circle

cd "$source_folder"
perl "$circles" cli
[[ $n_blind -eq 0 ]]
