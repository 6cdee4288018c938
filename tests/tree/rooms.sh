#!/usr/bin/env bash
# The order of the layers, and what the library may not call. Every rule is first tried on a file that breaks it.
set -euo pipefail

source_folder=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The folders that each folder may include from, besides its own.
declare -A may_include=(
  [include/conic]=""
  [core]="conic"
  [raster]="conic core"
  [oracle]="conic core"
  [lod]="conic core raster"
  [surface]="conic core"
  [source]="conic core raster lod surface"
  [opencl]="conic core raster lod"
  [cli]="conic core raster lod surface source opencl"
  [bench]="conic core raster lod surface source opencl cli tests"
  [examples]="conic"
  [tests]="conic core raster oracle lod surface source opencl cli bench"
)

# Calls that the library leaves to others: output, the end of the program, memory past the context, state of the whole
# process, and mathematics whose last bit depends on the machine.
output='printf|vprintf|puts|putchar|perror'
process='exit|_exit|abort|atexit|signal|setlocale|srand|rand'
memory='malloc|calloc|realloc|aligned_alloc|posix_memalign|strdup|strndup|free'
angles='(sin|cos|tan|asin|acos|atan|atan2|sincos|sinh|cosh|tanh|asinh|acosh|atanh)[fl]?'
powers='(exp|exp2|exp10|expm1|log|log2|log10|log1p|pow|cbrt|hypot|erf|erfc|tgamma|lgamma|ldexp|fma|fmod)[fl]?'
locale='strtod|strtof|strtold|atof|sscanf|fscanf|scanf'
forbidden="\\b($output|$process|$memory|$angles|$powers|$locale)\\s*\\(|\\bf(printf|puts|putc|write)\\s*\\([^;]*\\bstd(out|err)\\b|\\bstderr\\b"

# Prints FILE with comments and texts blanked, lines as they were; includes keep theirs.
code_of() {
  perl -0777 -pe '
    s{(/\*.*?\*/|//[^\n]*)|(#\s*include\s*"[^"\n]*")|"(?:\\.|[^"\\\n])*"|\x27(?:\\.|[^\x27\\\n])+\x27}
     {defined $2 ? $2 : defined $1 ? "\n" x ($1 =~ tr/\n//) : "\"\""}gse' "$1"
}

sources_in() { # FOLDER
  find "$1" -type f \( -name '*.c' -o -name '*.h' -o -name '*.cpp' \) 2> /dev/null | sort
}

# Prints every breach in the tree FOLDER.
breaches() {
  local folder file included allowed
  for folder in "${!may_include[@]}"; do
    allowed=" ${folder#include/} ${may_include[$folder]} "
    for file in $(sources_in "$1/$folder"); do
      while IFS= read -r included; do
        [[ $allowed == *" ${included%%/*} "* ]] || echo "${file#"$1/"} may not include $included"
      done < <(code_of "$file" | sed -nE 's/^\s*#\s*include\s*["<]([a-z]+\/[^">]+)[">].*/\1/p' |
        grep -E "^(conic|core|raster|oracle|lod|surface|source|opencl|cli|bench|tests|examples)/" || true)
      case $folder/${file##*/} in
        include/conic/* | core/context.c) ;;
        core/* | raster/* | oracle/* | lod/* | surface/* | source/* | opencl/*)
          code_of "$file" | grep -nE "$forbidden" | sed "s|^|${file#"$1/"}:|" || true
          ;;
      esac
    done
  done
}

# Each line breaks a rule when it stands in its file; each must be seen.
n_blind=0
expect_breach() { # FILE, LINE
  rm -rf "$work/tree"
  mkdir -p "$work/tree/$(dirname "$1")"
  printf '%s\n' "$2" > "$work/tree/$1"
  if [[ -z $(breaches "$work/tree") ]]; then
    echo "blind to $2 in $1"
    n_blind=$((n_blind + 1))
  fi
}
expect_breach core/a.c '#include "raster/project.h"'
expect_breach core/a.h '#include "cli/session.h"'
expect_breach include/conic/a.h '#include "core/base/memory.h"'
expect_breach raster/a.c '#include "cli/session.h"'
expect_breach oracle/oracle.c '#include "raster/project.h"'
expect_breach surface/a.c '#include "raster/project.h"'
expect_breach surface/a.c 'x = exp(y);'
expect_breach lod/a.c '#include "source/source_kind.h"'
expect_breach source/a.c 'x = acos(y);'
expect_breach raster/a.c '#include "surface/mls_surface.h"'
expect_breach cli/a.c '#include "tests/support/check.h"'
expect_breach examples/a.c '#include "core/splats/splats_gather.h"'
expect_breach core/a.c 'x = sinf(y);'
expect_breach core/a.c '/* text */ x = pow (y, 2.0);'
expect_breach raster/a.c 'char *p = malloc(3);'
expect_breach raster/a.c 'fprintf(stderr, "text");'
expect_breach core/a.cpp 'printf("text");'
expect_breach core/a.c 'exit(1);'
rm -rf "$work/tree"
mkdir -p "$work/tree/core"
printf '%s\n' '/* sin(x), malloc(3)' 'free(p) */ x = conic_sin(y);' 'text = "exit(1)"; // abort()' > "$work/tree/core/a.c"
if [[ -n $(breaches "$work/tree") ]]; then
  echo "sees a breach where none is"
  n_blind=$((n_blind + 1))
fi

found=$(breaches "$source_folder")
if [[ -n $found ]]; then
  echo "$found"
fi
[[ -z $found && $n_blind -eq 0 ]]
