#include "raster/tile_walk.h"

/* conic_final_weight in every lane; 0 in those that are not visible. */
CONIC_INLINE conic_floats weigh(const conic_tile *tile, const conic_footprint *footprint,
                                const conic_fragments *fragments, conic_mask visible, int is_gauss) {
  conic_floats kernel, least = conic_splat_lanes(CONIC_LEAST_WEIGHT);
  if (is_gauss)
    kernel = conic_exp_negative_lanes(-0.5f * fragments->q);
  else
    for (int lane = 0; lane < CONIC_LANES; lane++)
      kernel[lane] = visible[lane] ? conic_kernel_value(&tile->view->kernel, fragments->q[lane]) : 0.0f;
  conic_floats weight = (footprint->amplitude * fragments->scale) * kernel;
  weight = conic_select(weight > least, weight, least);
  return (conic_floats)((conic_mask)weight & visible);
}

CONIC_INLINE void add_to(float *sum, conic_floats term) {
  conic_store(sum, conic_load(sum) + term);
}

/* Where `better` holds, `value` and `i_footprint` take the place of what is kept. */
CONIC_INLINE void keep_better(float *kept, uint32_t *whose, conic_mask better, conic_floats value, conic_floats old,
                              uint32_t i_footprint) {
  conic_store(kept, conic_select(better, value, old));
  conic_store_indices(whose, conic_select_indices(better, conic_index_lanes(i_footprint), conic_load_indices(whose)));
}

/* Adds the visible fragments to the pixels' sums: an invisible one adds 0, which changes no bit. Splats come in file
 * order: sums keep it, and the first of equals stays. */
CONIC_INLINE void blend(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                        const conic_fragments *fragments, int is_gauss) {
  conic_tile_planes *planes = &tile->planes;
  conic_floats seen_iz = conic_select(fragments->plane_iz > fragments->iz, fragments->plane_iz, fragments->iz);
  conic_mask visible = fragments->covered & (seen_iz >= conic_load(&planes->threshold[at]));
  if (!conic_any(visible))
    return;
  const conic_surface *surface = &tile->projected->surfaces[i_footprint];
  conic_floats weight = weigh(tile, footprint, fragments, visible, is_gauss);
  add_to(&planes->weight[at], weight);
  for (int axis = 0; axis < 3; axis++) {
    add_to(&planes->color[axis][at], weight * surface->color[axis]);
    add_to(&planes->normal[axis][at], weight * surface->normal[axis]);
  }
  conic_store_indices(&planes->count[at], conic_load_indices(&planes->count[at]) - (conic_indices)visible);
  conic_floats heaviest = conic_load(&planes->heaviest_weight[at]), nearest = conic_load(&planes->nearest_iz[at]);
  keep_better(&planes->heaviest_weight[at], &planes->heaviest[at], weight > heaviest, weight, heaviest, i_footprint);
  keep_better(&planes->nearest_iz[at], &planes->nearest[at], visible & (fragments->iz > nearest), fragments->iz,
              nearest, i_footprint);
}

CONIC_INLINE void blend_gauss(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                              const conic_fragments *fragments) {
  blend(tile, i_footprint, footprint, at, fragments, 1);
}

CONIC_INLINE void blend_other(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                              const conic_fragments *fragments) {
  blend(tile, i_footprint, footprint, at, fragments, 0);
}

void conic_tile_accumulate(conic_tile *tile) {
  if (tile->view->kernel.type == CONIC_KERNEL_GAUSS)
    conic_walk_tile(tile, blend_gauss);
  else
    conic_walk_tile(tile, blend_other);
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
