/* Which footprints meet which tile, in the order of all. */
#pragma once

#include "core/base/radix.h"
#include "gaussians/draw/gaussian_parts.h"

typedef struct conic_gaussian_bins {
  size_t first_x, first_y; /* tile of the picture */
  size_t n_tiles_x, n_tiles;
  size_t *tile_begin; /* n_tiles + 1 places among the entries */
  uint32_t *entries;
} conic_gaussian_bins;

/* Makes the lists of a window's tiles, of the footprints that the order names, which all meet it. On failure *bins is
 * to be released, too. Errors: MEMORY. */
conic_status conic_gaussian_bins_make(conic_context *context, const conic_gaussian_footprint *footprints,
                                      const conic_radix_item *order, size_t n, const conic_gaussian_window *window,
                                      conic_gaussian_bins *bins);
void conic_gaussian_bins_release(conic_context *context, conic_gaussian_bins *bins);
