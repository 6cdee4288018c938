/* The renderer's hot loops, a small table a family, which stands with what it works on. All instruction
 * sets give the same bits as plain C (core/lanes/instruction_sets.h).
 *
 * Contract of every slot: it writes what is named there and nothing else. Records are finite; a lane that is not
 * covered may hold anything, and is dropped by a comparison, never by a multiplication with zero. Sums are in the order
 * of the band's list. */
#ifndef CONIC_RASTER_KERNELS_H
#define CONIC_RASTER_KERNELS_H

#include "core/lanes/instruction_sets.h"
#include "raster/project/project_kernels.h"
#include "raster/tiles/tile_kernels.h"
#include "raster/triangles/triangle_kernels.h"

typedef struct conic_raster_kernels {
  conic_project_kernels project;
  conic_bin_kernels bins;
  conic_pass_kernels passes;
  conic_resolve_kernels resolve;
  conic_triangle_kernels triangles;
  conic_texture_kernels texture;
} conic_raster_kernels;

CONIC_DECLARE_KERNELS(conic_raster_kernels);

#endif
