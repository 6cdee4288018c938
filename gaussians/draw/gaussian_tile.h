/* A tile of 16 × 16 pixels while Gaussians are composited in it, nearest first.
 *
 * Its pixels come block by block of 4 × 4, the blocks row by row, and the pixels of a block column by column. */
#ifndef CONIC_GAUSSIAN_TILE_H
#define CONIC_GAUSSIAN_TILE_H

#include "core/lanes/instruction_sets.h"
#include "gaussians/draw/gaussian_footprint.h"

enum { CONIC_GAUSSIAN_TILE = 16, CONIC_GAUSSIAN_TILE_PIXELS = CONIC_GAUSSIAN_TILE * CONIC_GAUSSIAN_TILE };

enum { CONIC_GAUSSIAN_BLOCK = 4, CONIC_GAUSSIAN_BLOCKS = 16, CONIC_GAUSSIAN_BLOCK_PIXELS = 16 };

static inline int conic_gaussian_column(size_t pixel) {
  return (int)(pixel / CONIC_GAUSSIAN_BLOCK_PIXELS % 4 * 4 + pixel % CONIC_GAUSSIAN_BLOCK_PIXELS / 4);
}

static inline int conic_gaussian_row(size_t pixel) {
  return (int)(pixel / (4 * CONIC_GAUSSIAN_BLOCK_PIXELS) * 4 + pixel % 4);
}

static inline size_t conic_gaussian_pixel(int column, int row) {
  return (size_t)((row / 4 * 4 + column / 4) * CONIC_GAUSSIAN_BLOCK_PIXELS + column % 4 * 4 + row % 4);
}

/* Pixels beside the picture are there, too. What follows rgb is for planes beside colour. */
typedef struct conic_gaussian_tile {
  float T[CONIC_GAUSSIAN_TILE_PIXELS];
  float rgb[3][CONIC_GAUSSIAN_TILE_PIXELS];
  float sum[CONIC_GAUSSIAN_TILE_PIXELS], sum_of_z[CONIC_GAUSSIAN_TILE_PIXELS]; /* of w, w·z */
  float inverse_z[CONIC_GAUSSIAN_TILE_PIXELS], median_z[CONIC_GAUSSIAN_TILE_PIXELS];
  float heaviest[CONIC_GAUSSIAN_TILE_PIXELS];
  uint32_t count[CONIC_GAUSSIAN_TILE_PIXELS], id[CONIC_GAUSSIAN_TILE_PIXELS], last[CONIC_GAUSSIAN_TILE_PIXELS];
  float normal[3][CONIC_GAUSSIAN_TILE_PIXELS];
  int x, y; /* of its first pixel */
} conic_gaussian_tile;

enum { CONIC_GAUSSIAN_ROOM = 320 };

/* What is composited in a tile: the footprints that the entries name. They come in the order of the profile, but those
 * of CONIC_SHAPE_RAY in that of their z. */
typedef struct conic_gaussian_list {
  const conic_gaussian_rules *rules;
  const conic_gaussian_footprint *footprints;
  const conic_gaussian_ray *rays; /* by footprint; of shapes that have them */
  const float (*normals)[3];      /* by footprint; null: not wanted */
  const uint32_t *keys;           /* by footprint: the profile's order, as a number */
  int wants_all;                  /* else T and rgb alone */
  const uint32_t *entries;
  size_t n;
  void *room; /* of CONIC_SHAPE_RAY: CONIC_GAUSSIAN_ROOM bytes for each entry and 16 more; aligned to 64 bytes */
} conic_gaussian_list;

/* One slot a shape: composites the list in the tile, whose sums and T's begin. */
typedef struct conic_gaussian_kernels {
  void (*composite[3])(const conic_gaussian_list *list, conic_gaussian_tile *tile);
} conic_gaussian_kernels;

CONIC_DECLARE_KERNELS(conic_gaussian_kernels);

#endif
