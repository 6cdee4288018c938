/* Splats as a pinhole high above must be given them so that it sees what a parallel projection downwards shows.
 *
 * About the middle of a small picture, a point (x, y, z) of the world, at the depth D - z below the camera, moves to
 * (x·(D - z)/D, y·(D - z)/D, z): there the pinhole of focal length D / pixel sees it at x / pixel, y / pixel, where the
 * parallel projection does, whatever its height. Tangents move as the derivative of that says. Centres are so where
 * they belong, and outlines are off by no more than the share radius / D of themselves. */
#ifndef CONIC_TOP_LIFT_H
#define CONIC_TOP_LIFT_H

#include "conic/splats.h"

typedef struct conic_top_place {
  double origin[3];       /* the picture's middle, and the height from which z is measured: world units */
  double distance;        /* D */
  double low[2], high[2]; /* what reaches into here is wanted: x and y from the origin */
  double heights[2];      /* and has its centre between these: z in the world */
  float cutoff;           /* F_g */
} conic_top_place;

/* Lifted splats; zero before the first use, the memory is kept. */
typedef struct conic_top_set {
  conic_splats splats;
  float *arrays;
  size_t room, clips_room;
  unsigned fields; /* that there is room for */
} conic_top_set;

/* How far from its centre a splat may be seen, without any filter: a bound. */
double conic_top_reach(const conic_splats *splats, size_t i, float cutoff);

/* Fills the set with those splats, of `n` that `chosen` names in ascending order (null: the first n), that are finite
 * and reach into the place; clip lines go along, dots stay as they are. Errors: MEMORY. */
conic_status conic_top_lift(conic_context *context, const conic_top_place *place, const conic_splats *splats,
                            const uint32_t *chosen, size_t n, conic_top_set *set);
void conic_top_set_release(conic_context *context, conic_top_set *set);

#endif
