/* How far out points may be for a scene to be framed or kept. */
#pragma once

#include "conic/splats.h"

/* Whether the box can be framed: the camera's numbers then stay well within the limits of drawing. */
static inline int conic_is_in_reach(const double low[3], const double high[3]) {
  for (int axis = 0; axis < 3; axis++)
    if (!(low[axis] > -1e20 && high[axis] < 1e20))
      return 0;
  return 1;
}

/* Why no camera can be placed before the points, in words; null where one can. */
static inline const char *conic_why_out_of_reach(const conic_splats *points) {
  double low[3], high[3];
  if (conic_splats_bounds(points, low, high) == 0)
    return points->count ? "no point is finite" : "it holds no points";
  return conic_is_in_reach(low, high) ? NULL : "a point is farther out than 1e20";
}
