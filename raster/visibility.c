#include "raster/tile_walk.h"

/* Pass 1: how near something hides what is behind it (docs/picture.md, Visible). */

CONIC_INLINE void raise_threshold(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                                  const conic_fragments *fragments) {
  float *to = &tile->planes.threshold[at];
  (void)i_footprint;
  tile->n_fragments += conic_count_lanes(fragments->covered);
  conic_floats hiding_iz = conic_select(fragments->plane_iz < fragments->iz, fragments->plane_iz, fragments->iz);
  conic_floats offset_iz = footprint->nearness * hiding_iz, threshold = conic_load(to);
  conic_store(to, conic_select(fragments->covered & (offset_iz > threshold), offset_iz, threshold));
}

/* Splats come in file order, so that the first of equals stays. */
CONIC_INLINE void keep_nearest(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                               const conic_fragments *fragments) {
  float *to = &tile->planes.nearest_iz[at];
  uint32_t *whose = &tile->planes.nearest[at];
  (void)footprint;
  tile->n_fragments += conic_count_lanes(fragments->covered);
  conic_floats nearest_iz = conic_load(to);
  conic_mask nearer = fragments->covered & (fragments->iz > nearest_iz);
  conic_store(to, conic_select(nearer, fragments->iz, nearest_iz));
  conic_store_indices(whose, conic_select_indices(nearer, conic_index_lanes(i_footprint), conic_load_indices(whose)));
}

void conic_tile_visibility(conic_tile *tile, int nearest_only) {
  if (nearest_only)
    conic_walk_tile(tile, keep_nearest);
  else
    conic_walk_tile(tile, raise_threshold);
}
