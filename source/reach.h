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

/* Points farther out than 1e20 become points that are not finite, with a warning: a reader that met a stray number has
 * made them, and no camera would hold them and the rest. Finds the box of the others. Errors: INPUT (none is left). */
conic_status conic_leave_far_points(conic_context *context, const char *name, conic_splats *points, double low[3],
                                    double high[3]);
