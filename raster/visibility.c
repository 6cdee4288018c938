#include "raster/tile_walk.h"

/* Pass 1: how near something hides what is behind it (docs/picture.md, Visible). */

static inline __attribute__((always_inline)) void raise_threshold(conic_tile *tile, uint32_t i_footprint,
                                                                  const conic_footprint *footprint, size_t at,
                                                                  const conic_fragment *fragment) {
  float *threshold = &tile->planes.threshold[at];
  float hiding_iz = fragment->plane_iz < fragment->iz ? fragment->plane_iz : fragment->iz;
  float offset_iz = footprint->nearness * hiding_iz;
  (void)i_footprint;
  tile->n_fragments++;
  *threshold = offset_iz > *threshold ? offset_iz : *threshold;
}

/* Splats come in file order, so that the first of equals stays. */
static inline __attribute__((always_inline)) void keep_nearest(conic_tile *tile, uint32_t i_footprint,
                                                               const conic_footprint *footprint, size_t at,
                                                               const conic_fragment *fragment) {
  (void)footprint;
  tile->n_fragments++;
  if (fragment->iz > tile->planes.nearest_iz[at]) {
    tile->planes.nearest_iz[at] = fragment->iz;
    tile->planes.nearest[at] = i_footprint;
  }
}

void conic_tile_visibility(conic_tile *tile, int nearest_only) {
  if (nearest_only)
    conic_walk_tile(tile, keep_nearest);
  else
    conic_walk_tile(tile, raise_threshold);
}
