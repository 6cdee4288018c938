/* The renderer's hot loops, a small table a family, which stands with what it works on. All instruction
 * sets give the same bits as plain C (core/lanes/instruction_sets.h).
 *
 * Contract of every slot: it writes what is named there and nothing else. Records are finite; a lane that is not
 * covered may hold anything, and is dropped by a comparison, never by a multiplication with zero. Sums are in the order
 * of the band's list. */
#pragma once

#include "core/lanes/instruction_sets.h"
#include "raster/project/project_loops.h"
#include "raster/tiles/tile_loops.h"
#include "raster/triangles/triangle_loops.h"
#include "raster/view/reach_loops.h"

typedef struct conic_raster_loops {
  conic_project_loops project;
  conic_bin_loops bins;
  conic_pass_loops passes;
  conic_resolve_loops resolve;
  conic_triangle_loops triangles;
  conic_texture_loops texture;
  conic_reach_loops reach;
} conic_raster_loops;

CONIC_DECLARE_LOOPS(conic_raster_loops);
