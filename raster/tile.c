#include "raster/tile.h"

#include <string.h>

#include "raster/coverage.h"

/* The widest vector is four columns of a band; what of it is past the last column falls into the padding. */
static int stride_of(int edge) {
  return edge + 4;
}

size_t conic_tile_bytes(int edge) {
  return CONIC_N_TILE_PLANES * (size_t)stride_of(edge) * (size_t)edge * sizeof(float);
}

void conic_tile_clear(conic_tile *tile, int edge, void *memory) {
  conic_tile_planes *planes = &tile->planes;
  tile->stride = stride_of(edge);
  size_t n = (size_t)tile->stride * (size_t)edge;
  float *next = memory;
  memset(memory, 0, conic_tile_bytes(edge));
  float **float_planes[] = {&planes->threshold, &planes->nearest_iz, &planes->weight,   &planes->heaviest_weight,
                            &planes->color[0],  &planes->color[1],   &planes->color[2], &planes->normal[0],
                            &planes->normal[1], &planes->normal[2]};
  uint32_t **index_planes[] = {&planes->nearest, &planes->heaviest, &planes->count};
  for (size_t i = 0; i < sizeof float_planes / sizeof float_planes[0]; i++, next += n)
    *float_planes[i] = next;
  for (size_t i = 0; i < sizeof index_planes / sizeof index_planes[0]; i++, next += n)
    *index_planes[i] = (uint32_t *)(void *)next;
  memset(planes->nearest, 0xff, n * sizeof(uint32_t));
  memset(planes->heaviest, 0xff, n * sizeof(uint32_t));
  tile->n_fragments = tile->n_covered = 0;
}

/* The weight with which a footprint covers a pixel that it is known to cover. */
static float weight_at(const conic_tile *tile, const conic_footprint *footprint, int x, int y) {
  conic_fragment fragment = {.scale = 1.0f};
  conic_fragment_at(tile->view, tile->projected, footprint, x, y, &fragment);
  return conic_final_weight(tile->view, footprint, fragment.q, fragment.scale);
}

void conic_tile_take_nearest(conic_tile *tile) {
  conic_tile_planes *planes = &tile->planes;
  for (int y = tile->y_begin; y < tile->y_end; y++)
    for (int x = tile->x_begin; x < tile->x_end; x++) {
      size_t at = conic_tile_place(tile, x, y);
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
