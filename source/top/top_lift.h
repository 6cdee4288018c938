/* Moves splats so that a pinhole high above them sees what a parallel projection downwards shows.
 *
 * About the middle of a small picture, a point (x, y, z) of the world, at the depth D - z below the camera, moves to
 * (x·(D - z)/D, y·(D - z)/D, z). There the pinhole of focal length D / pixel sees it at x / pixel, y / pixel, as the
 * parallel projection does, at any height. Tangents move by the derivative of this map. So centres are where they
 * belong, and outlines are off by at most the share radius / D of themselves. */
#pragma once

#include "conic/splats.h"

typedef struct conic_top_place {
  double origin[3];       /* the picture's middle, and the height from which z is measured: world units */
  double distance;        /* D */
  double low[2], high[2]; /* splats that reach into here are wanted: x and y from the origin */
  double heights[2];      /* and their centre must be between these: z in the world */
  float cutoff;           /* F_g */
} conic_top_place;

/* Lifted splats; zero before the first use, the memory is kept. */
typedef struct conic_top_set {
  conic_splats splats;
  float *arrays;
  size_t room, clips_room;
  unsigned fields; /* fields that there is room for */
} conic_top_set;

/* A bound of how far from its centre a splat can be seen, without any filter. */
double conic_top_reach(const conic_splats *splats, size_t i, float cutoff);

/* Fills the set with splats that are finite and reach into the place: of the `n` that `chosen` names in ascending order
 * (null: the first n). Clip lines are taken along; dots stay as they are. Errors: MEMORY. */
conic_status conic_top_lift(conic_context *context, const conic_top_place *place, const conic_splats *splats,
                            const uint32_t *chosen, size_t n, conic_top_set *set);
void conic_top_set_release(conic_context *context, conic_top_set *set);

/* Which splats of a set are where on the ground: lists of splats by the square that holds their centre. */

/* Zeroed: empty. */
typedef struct conic_top_bins {
  double low[2], edge; /* where the squares begin, and the length of an edge: world units */
  size_t n_columns, n_rows;
  size_t *starts;    /* of each square, row after row; then of the splats that reach farther than half a square */
  uint32_t *members; /* ascending in each list */
  uint32_t *found;   /* room for the results of a query */
  size_t found_room;
} conic_top_bins;

/* Makes lists with squares of an edge of at least `edge`. Splats that are not finite are in none. Errors: MEMORY. */
conic_status conic_top_bins_make(conic_context *context, const conic_splats *splats, float cutoff, double edge,
                                 conic_top_bins *bins);
void conic_top_bins_release(conic_context *context, conic_top_bins *bins);

/* Finds the splats that may reach into a box no larger than a square, in ascending order: bins->found holds them until
 * the next call. Errors: MEMORY. */
conic_status conic_top_bins_find(conic_context *context, conic_top_bins *bins, const double low[2],
                                 const double high[2], size_t *n);
