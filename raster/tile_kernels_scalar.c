/* The plain C reference of the tile kernels: a pixel at a time, by the definitions of coverage.h. */
#include "raster/coverage.h"
#include "raster/tile_kernels.h"

typedef void visit_fragment(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                            const conic_fragment *fragment);

static int least(int a, int b) {
  return a < b ? a : b;
}

static int greatest(int a, int b) {
  return a > b ? a : b;
}

static inline void walk_splat(conic_tile *tile, uint32_t i_footprint, visit_fragment *visit) {
  const conic_footprint *footprint = &tile->projected->footprints[i_footprint];
  const conic_box *box = &tile->projected->boxes[i_footprint];
  int x_begin = greatest(box->x_begin, tile->x_begin), x_end = least(box->x_end, tile->x_end);
  int y_begin = greatest(box->y_begin, tile->y_begin), y_end = least(box->y_end, tile->y_end);
  for (int y = y_begin; y < y_end; y++)
    for (int x = x_begin; x < x_end; x++) {
      conic_fragment fragment;
      if (conic_fragment_at(tile->view, tile->projected, footprint, x, y, &fragment))
        visit(tile, i_footprint, footprint, conic_tile_place(tile, x, y), &fragment);
    }
}

static void raise_threshold(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                            const conic_fragment *fragment) {
  float hiding_iz = fragment->plane_iz < fragment->iz ? fragment->plane_iz : fragment->iz;
  float offset_iz = footprint->nearness * hiding_iz;
  (void)i_footprint;
  tile->n_fragments++;
  if (tile->planes.threshold[at] < offset_iz)
    tile->planes.threshold[at] = offset_iz;
}

/* Splats come in file order, so that the first of equals stays. */
static void keep_nearest(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                         const conic_fragment *fragment) {
  (void)footprint;
  tile->n_fragments++;
  if (tile->planes.nearest_iz[at] < fragment->iz) {
    tile->planes.nearest_iz[at] = fragment->iz;
    tile->planes.nearest[at] = i_footprint;
  }
}

static void blend(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
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
  if (planes->heaviest_weight[at] < weight) {
    planes->heaviest_weight[at] = weight;
    planes->heaviest[at] = i_footprint;
  }
  if (planes->nearest_iz[at] < fragment->iz) {
    planes->nearest_iz[at] = fragment->iz;
    planes->nearest[at] = i_footprint;
  }
}

static void visibility(conic_tile *tile) {
  for (size_t i = 0; i < tile->n_references; i++)
    walk_splat(tile, tile->references[i], raise_threshold);
}

static void nearest(conic_tile *tile) {
  for (size_t i = 0; i < tile->n_references; i++)
    walk_splat(tile, tile->references[i], keep_nearest);
}

static void accumulate(conic_tile *tile) {
  for (size_t i = 0; i < tile->n_references; i++)
    walk_splat(tile, tile->references[i], blend);
}

const conic_tile_kernels conic_tile_kernels_scalar = {"scalar", conic_project_chunk, visibility,
                                                      nearest,  accumulate,          conic_tile_resolve};
