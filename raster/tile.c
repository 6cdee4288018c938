#include "raster/tile.h"

#include <string.h>

#include "raster/lanes.h"

/* Lanes past a row's end fall into its padding, and are masked. */
static int stride_of(int edge) {
  return edge + CONIC_LANES;
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
