/* One tile: visibility, accumulation, resolving. The tile's planes are small enough to stay in the cache. */
#ifndef RASTER_TILE_H
#define RASTER_TILE_H

#include "conic/image.h"
#include "raster/bins.h"

#define CONIC_NO_SPLAT 0xFFFFFFFFu

/* The final weight of a visible splat is never below this, so that no sum is zero and no product denormal. */
#define CONIC_LEAST_WEIGHT 0x1p-60f

/* The planes of one tile, in bands of four rows; a band lies column by column (conic_tile_place). Tiny splats so need
 * few vectors, whatever their width. Splats are named by their footprint. */
typedef struct conic_tile_planes {
  float *threshold;  /* max of s·min(iz, iz_plane) over what covers the pixel, at least 0 */
  float *nearest_iz; /* the largest iz among the visible splats, and whose it is */
  uint32_t *nearest;
  float *weight;               /* Σ w */
  float *color[3], *normal[3]; /* Σ w c, Σ w n */
  float *heaviest_weight;      /* the largest w, and whose it is */
  uint32_t *heaviest;
  uint32_t *count; /* visible splats */
} conic_tile_planes;

#define CONIC_N_TILE_PLANES 13

typedef struct conic_tile {
  const conic_view *view;
  const conic_projected *projected;
  const uint32_t *references;
  size_t n_references;
  int stride;                         /* columns of a band: the edge, and room for a vector past it */
  int x_begin, x_end, y_begin, y_end; /* its pixels of the image */
  conic_tile_planes planes;
  int keeps_indices;               /* the image wants counts or ids: nearest and count are kept too */
  uint64_t n_fragments, n_covered; /* found by visibility, and by resolving */
} conic_tile;

/* The memory that a tile's planes take. */
size_t conic_tile_bytes(int edge);

/* Points the planes into `memory`, of conic_tile_bytes, and empties what the passes add to. */
void conic_tile_clear(conic_tile *tile, int edge, void *memory);

/* Where a pixel of the image is in the tile's planes. */
static inline size_t conic_tile_place(const conic_tile *tile, int x, int y) {
  size_t row = (size_t)(y - tile->y_begin), column = (size_t)(x - tile->x_begin);
  return (row / 4 * (size_t)tile->stride + column) * 4 + row % 4;
}

/* In place of pass 2 where the nearest splat wins: its colour, normal and weight. */
void conic_tile_take_nearest(conic_tile *tile);

#endif
