/* A tile of 16 × 16 pixels while Gaussians are composited in it, nearest first.
 *
 * Its pixels come block by block of 4 × 4, the blocks row by row, and the pixels of a block column by column. */
#pragma once

#include "core/lanes/instruction_sets.h"
#include "gaussians/draw/gaussian_footprint.h"

enum { CONIC_GAUSSIAN_TILE = 16 };
#ifndef CONIC_GAUSSIAN_TILE_PIXELS /* 1 where a device has a work-item for each */
#define CONIC_GAUSSIAN_TILE_PIXELS 256
_Static_assert(CONIC_GAUSSIAN_TILE_PIXELS == CONIC_GAUSSIAN_TILE * CONIC_GAUSSIAN_TILE, "all of a tile");
#endif

/* Where a frame's records lie: in a memory of its own on a device. */
#ifndef CONIC_STORED
#define CONIC_STORED
#endif

enum { CONIC_GAUSSIAN_BLOCK = 4, CONIC_GAUSSIAN_BLOCKS = 16, CONIC_GAUSSIAN_BLOCK_PIXELS = 16 };

static inline int conic_gaussian_column(size_t pixel) {
  return (int)(pixel / CONIC_GAUSSIAN_BLOCK_PIXELS % 4 * 4 + pixel % CONIC_GAUSSIAN_BLOCK_PIXELS / 4);
}

static inline int conic_gaussian_row(size_t pixel) {
  return (int)(pixel / CONIC_GAUSSIAN_BLOCK_PIXELS / 4 * 4 + pixel % 4);
}

/* Pixels beside the picture are there, too. */
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

#ifndef CONIC_ON_DEVICE
/* What a pixel was composited of. */
typedef struct conic_gaussian_step {
  float z, alpha, color[3];
  uint32_t index;
} conic_gaussian_step;

/* The steps of all pixels of a window: pixel (x, y) puts its next one at next[y·width + x], and goes on. */
typedef struct conic_gaussian_steps {
  conic_gaussian_step *steps;
  size_t *next;
  int width, first[2]; /* first: the pixel of the tile's picture that is the first of the window */
} conic_gaussian_steps;

/* The directions of a tile's rays, each the sum of two floats; NaN where there is none. */
typedef struct conic_sight_rays {
  float high[3][CONIC_GAUSSIAN_TILE_PIXELS], low[3][CONIC_GAUSSIAN_TILE_PIXELS];
  float origin_high[3][CONIC_GAUSSIAN_TILE_PIXELS], origin_low[3][CONIC_GAUSSIAN_TILE_PIXELS]; /* likewise */
} conic_sight_rays;
#endif

/* What is wanted of a picture: T, rgb and count alone; sum and sum_of_z, too; or all. Plain C composites the first or
 * all. */
enum { CONIC_GAUSSIAN_COLORS, CONIC_GAUSSIAN_DEPTHS, CONIC_GAUSSIAN_ALL };

/* What is composited in a tile: the footprints that the entries name, in their order. */
typedef struct conic_gaussian_list {
  const conic_gaussian_rules *rules;
  const CONIC_STORED conic_gaussian_footprint *footprints;
  const CONIC_STORED conic_gaussian_ray *rays; /* by footprint; of shapes that have them */
  const CONIC_STORED float (*normals)[3];      /* by footprint; null: not wanted */
  int wants;                                   /* one of the above */
  const CONIC_STORED uint32_t *entries;
  size_t n;
  CONIC_STORED void *room; /* of what is ordered along rays: CONIC_GAUSSIAN_ROOM bytes for each entry and 16 more;
                              aligned to 64 bytes */
#ifndef CONIC_ON_DEVICE
  const conic_gaussian_filter *filters; /* by footprint; of CONIC_SHAPE_FILTERED */
  const conic_gaussian_sight *sights;   /* by footprint; of CONIC_SHAPE_SIGHT */
  const conic_sight_rays *tile_rays;    /* of CONIC_SHAPE_SIGHT */
  int is_parallel;                      /* rays are */
  const float *surface_z;            /* by pixel of the tile: what is not before it is not composited; null: all is */
  const conic_gaussian_steps *steps; /* takes what is composited, in plain C alone; null: nobody does */
#endif
} conic_gaussian_list;

/* The surfaces' z from a pixel of the tile on; null: there are none, as on devices. */
static inline const float *conic_gaussian_list_surface(const conic_gaussian_list *list, size_t at) {
#ifdef CONIC_ON_DEVICE
  (void)list, (void)at;
  return 0;
#else
  return list->surface_z ? list->surface_z + at : NULL;
#endif
}

#ifndef CONIC_ON_DEVICE /* where no pointer is to a function */
typedef struct conic_gaussian_loops {
  /* Sets up CONIC_ELLIPSES Gaussians of a view that conic_gaussian_has_ellipses; null in plain C, which does it one by
   * one. */
  void (*set_up)(const conic_gaussian_view *view, const conic_gaussians *gaussians, size_t first,
                 conic_gaussian_ellipses *ellipses);
  /* One slot a shape: composites the list in the tile, whose sums and T's begin. */
  void (*composite[CONIC_N_SHAPES])(const conic_gaussian_list *list, conic_gaussian_tile *tile);
} conic_gaussian_loops;

CONIC_DECLARE_LOOPS(conic_gaussian_loops);
#endif
