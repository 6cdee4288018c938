#!/usr/bin/env bash
# No name twice in the tree. Every rule is first tried on files that break it.
set -euo pipefail

source_folder=$1
names=$source_folder/tests/tree/names.pl
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
n_blind=0

put() { # FILE, LINES
  mkdir -p "$work/$(dirname "$1")"
  printf '%s\n' "${@:2}" > "$work/$1"
}

expect() { # breach or peace: what the rules say of the files that were put
  local said=breach
  perl "$names" "$work" > /dev/null && said=peace
  if [[ $said != "$1" ]]; then
    echo "says $said of:"
    find "$work" -type f -exec cat {} +
    n_blind=$((n_blind + 1))
  fi
  rm -rf "${work:?}"/*
}

put core/base/a.c 'int a;'
put tests/core/a.c 'int a;'
expect breach
put core/a.c 'typedef struct grid {' '  int n;' '} grid;'
put lod/b.c 'struct grid {' '  int m;' '};'
expect breach
put core/a.c 'typedef int side;'
put lod/b.c 'typedef unsigned side;'
expect breach
put core/a.c 'typedef int (*visit)(int);'
put lod/b.c 'enum visit { ONE };'
expect breach
put core/a.c 'int both(int i) {' '  return i;' '}'
put cli/b.c 'int both(void) {' '  return 1;' '}'
expect breach
put core/a.c 'static int one(int i) {' '  if (i) {' '    return i; /* i */' '  }' '  return 0;' '}'
put cli/b.c 'static int one(int k) {' '  if (k) { return k; } return 0;' '}'
expect breach
put core/a.c 'static int one(int i) {' '  return i;' '}' 'static float two(const float a[3]) {' '  return a[0];' '}'
put gaussians/b.h '#ifndef CONIC_B_H' '#define CONIC_B_H' 'static inline float two(const float v[3]) {' '  return v[0];' '}' '#endif'
expect breach
put core/a.c 'static int one(int i) {' '  if (i) {' '    return i;' '  }' '  return 0;' '}'
put cli/b.c 'static int one(void) {' '  return 1;' '}'
expect peace
put core/a.c 'static const char *one(void) {' '  return "one {";' '}'
put cli/b.c 'static const char *one(void) {' '  return "two {";' '}'
expect peace
put core/a.c 'static int size(float x) {' '  return sizeof x;' '}'
put cli/b.c 'static int size(double x) {' '  return sizeof x;' '}'
expect peace
put core/a.c 'enum { N = 2 };' 'static int part(int i) {' '  return i / N;' '}'
put cli/b.c 'enum { N = 3 };' 'static int part(int i) {' '  return i / N;' '}'
expect peace
put gaussians/scene/a.c 'int a;'
put opencl/a.c 'int a;'
expect breach
put core/a.c 'static int one(void) {' '  return 1;' '}'
put cli/b.c 'int one(void) {' '  return 1;' '}'
expect breach
put core/a.h '#ifndef CONIC_B_H' '#define CONIC_B_H' '#endif'
expect breach
put core/a.h 'int a;'
expect breach
put include/conic/a.h '#pragma once' 'int a;'
expect breach
put core/a.h '#pragma once' 'int a;'
expect peace
for i in {1..46}; do
  put "core/base/a$i.c" ''
done
expect breach
put core/a.h '/* typedef int one; */' '#ifndef CONIC_A_H' '#define CONIC_A_H' 'typedef struct one one;' '#endif'
put core/a_body.h 'int two(int one);'
put core/b.c 'struct one {' '  int one;' '};' 'int two(int one) {' '  return one;' '}' 'static int three(void) { return two(1); }'
put tests/c.c 'struct one {' '  int one;' '};' 'static int three(void) { return two(1); }'
expect peace
put core/a_posix.c 'int four(void) { return 1; }'
put core/a_windows.c 'int four(void) { return 2; }'
expect peace
put core/a_posix.c 'int five(void) { return 1; }'
put core/b_windows.c 'int five(void) { return 2; }'
expect breach

perl "$names" "$source_folder"
[[ $n_blind -eq 0 ]]
