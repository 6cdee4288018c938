/* A tile of 16 × 16 pixels while Gaussians are composited in it, nearest first. */
#ifndef CONIC_GAUSSIAN_TILE_H
#define CONIC_GAUSSIAN_TILE_H

#include "core/lanes/instruction_sets.h"
#include "gaussians/draw/gaussian_footprint.h"

enum { CONIC_GAUSSIAN_TILE = 16, CONIC_GAUSSIAN_TILE_PIXELS = CONIC_GAUSSIAN_TILE * CONIC_GAUSSIAN_TILE };

/* Pixels row by row; those beside the picture are there, too. */
typedef struct conic_gaussian_tile {
  float T[CONIC_GAUSSIAN_TILE_PIXELS];    /* 0 where compositing has ended; */
  float rest[CONIC_GAUSSIAN_TILE_PIXELS]; /* this is T then */
  float rgb[3][CONIC_GAUSSIAN_TILE_PIXELS];
  float sum[CONIC_GAUSSIAN_TILE_PIXELS], sum_of_z[CONIC_GAUSSIAN_TILE_PIXELS]; /* of w, w·z */
  float inverse_z[CONIC_GAUSSIAN_TILE_PIXELS], median_z[CONIC_GAUSSIAN_TILE_PIXELS];
  float heaviest[CONIC_GAUSSIAN_TILE_PIXELS];
  uint32_t count[CONIC_GAUSSIAN_TILE_PIXELS], id[CONIC_GAUSSIAN_TILE_PIXELS], last[CONIC_GAUSSIAN_TILE_PIXELS];
  float normal[3][CONIC_GAUSSIAN_TILE_PIXELS];
  int x, y; /* of its first pixel */
} conic_gaussian_tile;

/* A pixel's response to a Gaussian that is ordered pixel by pixel. */
typedef struct conic_gaussian_hit {
  float z, alpha;
  uint32_t footprint;
} conic_gaussian_hit;

/* The directions of a tile's rays, row by row, each the sum of two floats; NaN where there is none. */
typedef struct conic_tile_rays {
  float high[3][CONIC_GAUSSIAN_TILE_PIXELS], low[3][CONIC_GAUSSIAN_TILE_PIXELS];
} conic_tile_rays;

/* What is composited in a tile. Footprints are numbered in the order of all. */
typedef struct conic_gaussian_list {
  const conic_gaussian_rules *rules;
  const conic_gaussian_footprint *footprints;
  const conic_gaussian_ray *rays;       /* by footprint; of shapes that have them */
  const conic_gaussian_filter *filters; /* by footprint; of filtered rays */
  int is_parallel;                      /* the rays are */
  const conic_gaussian_sight *sights;   /* by footprint; where the tile has rays of its own */
  const conic_tile_rays *tile_rays;
  const float (*normals)[3]; /* by footprint; null: not wanted */
  int wants_all;             /* else T and rgb alone */
  const uint32_t *entries;
  size_t n;
  conic_gaussian_hit *hits; /* room for n · CONIC_GAUSSIAN_TILE, of CONIC_SHAPE_RAY */
} conic_gaussian_list;

/* One slot a shape: composites the list in the tile, whose sums and T's begin. */
typedef struct conic_gaussian_kernels {
  void (*composite[3])(const conic_gaussian_list *list, conic_gaussian_tile *tile);
} conic_gaussian_kernels;

CONIC_DECLARE_KERNELS(conic_gaussian_kernels);

/* Composites a pixel's hits, in the order of z, and of the list. */
void conic_gaussian_composite_hits(const conic_gaussian_list *list, conic_gaussian_hit *hits, size_t n,
                                   conic_gaussian_tile *tile, size_t pixel);

#endif
