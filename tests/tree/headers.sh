#!/usr/bin/env bash
# Every header compiles alone, and all of them together; the public ones as C11 and as C++17; what libconic exports is what the headers declare;
# every global name has the project's prefix. A header that some file of the build includes first has compiled alone there.
set -euo pipefail

source_folder=$1
build_folder=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$source_folder"
failures=0

fail() {
  echo "$*"
  failures=$((failures + 1))
}

setting() { # NAME: its value in the build
  sed -nE "s/^$1:[A-Z]+=(.*)$/\1/p" "$build_folder/CMakeCache.txt"
}
library_folder=$(dirname "$(find "$build_folder" -name libconic.a)")
c_compiler=$(setting CMAKE_C_COMPILER)
cpp_compiler=$(setting CMAKE_CXX_COMPILER)

compiles_c() { # FILE
  echo 'typedef int not_empty;' >> "$1"
  "$c_compiler" -std=c11 -D_POSIX_C_SOURCE=200809L -Wall -Wextra -Werror -pedantic -fsyntax-only -Iinclude -I. "$1"
}
compiles_cpp() { # FILE; true where there is no compiler for it
  [[ ! -x $cpp_compiler ]] ||
    "$cpp_compiler" -std=c++17 -Wall -Wextra -Werror -pedantic -fsyntax-only -Iinclude "$1"
}

# The first that each file of the libraries and programs includes: those do not compile where theirs does not.
declare -A is_first
while read -r header; do
  is_first[$header]=1
done < <(find core raster oracle lod surface gaussians judge lighting accumulation gathering source shots bench cli -name '*.c' \
  ! -path 'bench/peers/*' ! -name '*_windows.c' ! -name '*_bridge.c' -exec grep -hm 1 '^#include' {} + | sed -n 's/#include "\(.*\)"/\1/p')
[[ ${#is_first[@]} -gt 100 ]] || fail "what files include first was not found"

for header in $(find include core raster oracle lod surface gaussians judge lighting accumulation gathering source shots opencl bench cli mpi -name '*.h' | sort); do
  [[ -e $header && $header != *_body.h ]] || continue # a body is included by what sets its types
  [[ $header != opencl/shared.h ]] || continue          # stands before what OpenCL C compiles
  [[ $header != opencl/c_library/* ]] || continue       # stands for the C library where there is none
  [[ $header != opencl/*.h || -e $build_folder/opencl ]] || continue # a build without OpenCL
  printf '#include "%s"\n' "${header#include/}" | tee "$work/alone.c" >> "$work/together.c"
  [[ ! -v is_first[${header#include/}] ]] || continue
  compiles_c "$work/alone.c" || fail "$header does not compile alone as C11"
done
compiles_c "$work/together.c" || fail "the headers do not compile together as C11"
for header in include/conic/*.h; do
  printf '#include "%s"\n' "${header#include/}" | tee "$work/alone.cpp" >> "$work/together.cpp"
  compiles_cpp "$work/alone.cpp" || fail "$header does not compile alone as C++17"
done
compiles_cpp "$work/together.cpp" || fail "the public headers do not compile together as C++17"

# Two headers that are sound by themselves, but not together.
printf 'struct one {\n  int a;\n};\n' | tee "$work/first.h" > "$work/second.h"
printf '#include "%s"\n' first.h second.h > "$work/together.c"
! compiles_c "$work/together.c" 2> /dev/null || fail "sees no type that is defined twice"

perl -0777 -ne 's{/\*.*?\*/}{}gs; s{^\s*#.*$}{}gm; print "$1\n" while /\bCONIC_API\b[^;(]*?(\w+)\s*\(/g' \
  include/conic/*.h | sort -u > "$work/declared"
nm -D --defined-only "$library_folder/libconic.so" | awk '$2 != "A" {sub("@.*", "", $3); print $3}' | sort -u > "$work/exported"
[[ $(wc -l < "$work/declared") -gt 10 ]] || fail "the headers' declarations were not found"
while read -r name; do
  fail "$name is declared in a public header and not exported"
done < <(comm -23 "$work/declared" "$work/exported")
while read -r name; do
  fail "$name is exported and declared in no public header"
done < <(comm -13 "$work/declared" "$work/exported")
while read -r name; do
  fail "$name is declared in a public header and does not start with conic_"
done < <(grep -v '^conic_' "$work/declared" || true)

global_names() { # FILES: strong definitions
  nm -g --defined-only "$@" | awk 'NF == 3 && $2 ~ /^[TDBRC]$/ {print $3}' | sort -u
}
while read -r name; do
  fail "$name is global in the library and does not start with conic_"
done < <(global_names "$library_folder/libconic.a" | grep -v '^conic_' || true)
mapfile -t program < <(find "$build_folder/CMakeFiles/conic_cli_objects.dir" -name '*.o')
[[ ${#program[@]} -gt 10 ]] || fail "the program's object files were not found"
while read -r name; do
  fail "$name is global in the program and does not start with cli_"
done < <(global_names "${program[@]}" | grep -vE '^(cli_|main$)' || true)

exit $((failures > 0))
