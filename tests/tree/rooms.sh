#!/usr/bin/env bash
# Who may include whom, and what the library may not call. Every rule is first tried on a file that breaks it.
set -euo pipefail

source_folder=$1
rooms=$source_folder/tests/tree/rooms.pl
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
n_blind=0

put() { # FILE, LINES
  mkdir -p "$work/$(dirname "$1")"
  printf '%s\n' "${@:2}" > "$work/$1"
}

expect() { # breach or peace: what the rules say of the files that were put
  local said=breach
  perl "$rooms" breaches "$work" > /dev/null && said=peace
  if [[ $said != "$1" ]]; then
    echo "says $said of:"
    find "$work" -type f -exec cat {} +
    n_blind=$((n_blind + 1))
  fi
  rm -rf "${work:?}"/*
}

while IFS='|' read -r file line; do
  put "$file" "$line"
  expect breach
done << 'END'
core/a.c|#include "raster/project.h"
core/a.h|#include "cli/session.h"
include/conic/a.h|#include "core/base/memory.h"
raster/a.c|#include "cli/session.h"
oracle/oracle.c|#include "raster/project.h"
surface/a.c|#include "raster/project.h"
surface/a.c|x = exp(y);
gaussians/a.c|#include "raster/project.h"
raster/a.c|#include "surface/mls_surface.h"
cli/a.c|#include "tests/support/check.h"
examples/a.c|#include "core/splats/splats_gather.h"
core/a.c|x = sinf(y);
core/a.c|/* text */ x = pow (y, 2.0);
raster/a.c|char *p = malloc(3);
raster/a.c|fprintf(stderr, "text");
core/a.cpp|printf("text");
core/a.c|exit(1);
cli/a.c|#include "mpi/ranks.h"
END
put core/a_bridge.c 'p = malloc(3); exit(1);'
expect peace
put core/a.c '/* sin(x), malloc(3)' 'free(p) */ x = conic_sin(y);' 'text = "exit(1)"; // abort()'
expect peace
put core/base/a.h '#include "core/files/b.h"'
put core/files/b.h '#include "core/image/c.h"'
put core/image/c.h ''
expect peace
put core/base/a.h '#include "core/files/b.h"'
put core/files/b.h '#include "core/image/c.h"'
put core/image/c.c '#include "core/base/a.h"'
put core/image/c.h ''
expect breach

perl "$rooms" breaches "$source_folder"
[[ $n_blind -eq 0 ]]
