/* Which footprints meet which tile, nearest first. */
#pragma once

#include "gaussians/draw/gaussian_parts.h"
#include "gaussians/draw/gaussian_tile.h"

typedef struct conic_gaussian_bins {
  size_t first_x, first_y; /* tile of the picture */
  size_t n_tiles_x, n_tiles;
  size_t *tile_begin; /* n_tiles + 1 places among the entries */
  uint32_t *entries;
} conic_gaussian_bins;

/* Footprints in runs of `a_run` places, of which each run uses the first n_of_run. */
typedef struct conic_gaussian_runs {
  const conic_gaussian_footprint *footprints;
  const float *keys; /* by footprint: what they are ordered by */
  const size_t *n_of_run;
  size_t n_runs, a_run;
} conic_gaussian_runs;

/* Makes the lists of a window's tiles, each in the footprints' own order. On failure *bins is to be released, too.
 * Errors: MEMORY. */
conic_status conic_gaussian_bins_make(conic_context *context, const conic_gaussian_runs *runs,
                                      const conic_gaussian_window *window, conic_gaussian_bins *bins);
/* Puts each list in the order of keys; of equal ones, the first stays first. Errors: MEMORY. */
conic_status conic_gaussian_bins_sort(conic_context *context, const conic_gaussian_runs *runs,
                                      conic_gaussian_bins *bins);
/* The length of the longest list. */
size_t conic_gaussian_bins_longest(const conic_gaussian_bins *bins);
void conic_gaussian_bins_release(conic_context *context, conic_gaussian_bins *bins);
