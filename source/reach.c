#include "source/reach.h"

#include <math.h>

#include "core/base/base.h"
#include "core/splats/splats_gather.h"

static int leave_if_far(conic_splats *points, size_t i) {
  double at[3];
  for (int axis = 0; axis < 3; axis++)
    at[axis] = points->origin[axis] + (double)points->position[axis][i];
  if (conic_is_in_reach(at, at) || isnan(at[0]) || isnan(at[1]) || isnan(at[2]))
    return 0;
  for (int axis = 0; axis < 3; axis++)
    points->position[axis][i] = NAN;
  return 1;
}

conic_status conic_leave_far_points(conic_context *context, const char *name, conic_splats *points, double low[3],
                                    double high[3]) {
  size_t n = conic_splats_bounds_by(context, points, low, high), n_far = 0;
  int are_in_reach = n == points->count && conic_is_in_reach(low, high);
  for (size_t i = 0; !are_in_reach && i < points->count; i++)
    n_far += (size_t)leave_if_far(points, i);
  if (n_far)
    n = conic_splats_bounds_by(context, points, low, high);
  if (n && n_far)
    conic_log(context, CONIC_LOG_WARNING, "%s: %zu points are left out, which are farther out than 1e20", name, n_far);
  return n ? CONIC_OK
           : conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot be drawn: %s", name,
                        n_far && n_far == points->count ? "all points are farther out than 1e20"
                        : points->count                 ? "no point is finite"
                                                        : "it holds no points");
}
