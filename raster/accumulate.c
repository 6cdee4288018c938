#include "raster/tile_walk.h"

/* Adds a visible fragment to the pixel's sums. Splats come in file order: sums keep it, and the first of equals stays.
 */
static inline __attribute__((always_inline)) void blend(conic_tile *tile, uint32_t i_footprint,
                                                        const conic_footprint *footprint, size_t at,
                                                        const conic_fragment *fragment) {
  conic_tile_planes *planes = &tile->planes;
  float seen_iz = fragment->plane_iz > fragment->iz ? fragment->plane_iz : fragment->iz;
  if (!(seen_iz >= planes->threshold[at]))
    return;
  const conic_surface *surface = &tile->projected->surfaces[i_footprint];
  float weight = conic_final_weight(tile->view, footprint, fragment->q, fragment->scale);
  planes->weight[at] += weight;
  for (int axis = 0; axis < 3; axis++) {
    planes->color[axis][at] += weight * surface->color[axis];
    planes->normal[axis][at] += weight * surface->normal[axis];
  }
  planes->count[at]++;
  if (weight > planes->heaviest_weight[at]) {
    planes->heaviest_weight[at] = weight;
    planes->heaviest[at] = i_footprint;
  }
  if (fragment->iz > planes->nearest_iz[at]) {
    planes->nearest_iz[at] = fragment->iz;
    planes->nearest[at] = i_footprint;
  }
}

void conic_tile_accumulate(conic_tile *tile) {
  conic_walk_tile(tile, blend);
}

/* The weight with which a footprint covers a pixel that it is known to cover. */
static float weight_at(const conic_tile *tile, const conic_footprint *footprint, int x, int y) {
  float dx = conic_row_dx(footprint, x), dy = conic_row_dy(footprint, y);
  if (footprint->s3 != 0.0f) {
    conic_row row = conic_row_begin(footprint, dy);
    return conic_final_weight(tile->view, footprint, conic_row_q(footprint, &row, dx), 1.0f);
  }
  conic_fragment fragment = {.scale = 1.0f};
  conic_ray_fragment(tile->view, footprint, &tile->projected->rays[footprint->i_ray], dx, dy, &fragment);
  return conic_final_weight(tile->view, footprint, fragment.q, fragment.scale);
}

void conic_tile_take_nearest(conic_tile *tile) {
  conic_tile_planes *planes = &tile->planes;
  for (int y = tile->y_begin; y < tile->y_end; y++)
    for (int x = tile->x_begin; x < tile->x_end; x++) {
      size_t at = conic_tile_row(tile, y) + (size_t)(x - tile->x_begin);
      uint32_t i_footprint = planes->nearest[at];
      if (i_footprint == CONIC_NO_SPLAT)
        continue;
      const conic_surface *surface = &tile->projected->surfaces[i_footprint];
      float weight = weight_at(tile, &tile->projected->footprints[i_footprint], x, y);
      planes->weight[at] = planes->heaviest_weight[at] = weight;
      planes->heaviest[at] = i_footprint;
      planes->count[at] = 1;
      for (int axis = 0; axis < 3; axis++) {
        planes->color[axis][at] = weight * surface->color[axis];
        planes->normal[axis][at] = weight * surface->normal[axis];
      }
    }
}
