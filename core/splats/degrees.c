#include "core/splats/degrees.h"

#include <math.h>

#include "core/base/trigonometry.h"

/* Of a scan: degrees that it spans at most; how much farther than that it lies from the scales' origin, and how much
 * higher it is. A degree is 111 km, so a scan of a kilometre with a relief of ten metres is a thousand times as high.
 */
static const double most_degrees = 5.0, least_remoteness = 4.0, least_height = 50.0;

/* WGS 84: the semi-major axis in metres, and the squared eccentricity. */
static const double earth_radius = 6378137.0, earth_eccentricity_squared = 6.69437999014e-3;

int conic_points_are_degrees(const conic_splats *points) {
  double low[3], high[3], middle[2];
  if (conic_splats_bounds(points, low, high) < 2)
    return 0;
  double width = high[0] - low[0], depth = high[1] - low[1], ground = width > depth ? width : depth;
  for (int axis = 0; axis < 2; axis++)
    middle[axis] = 0.5 * low[axis] + 0.5 * high[axis];
  return low[0] >= -180.0 && high[0] <= 180.0 && low[1] >= -90.0 && high[1] <= 90.0 && ground > 0.0 &&
         ground <= most_degrees && sqrt(middle[0] * middle[0] + middle[1] * middle[1]) > least_remoteness * ground &&
         high[2] - low[2] > least_height * ground;
}

void conic_points_take_metres(conic_splats *points, double middle[2]) {
  double low[3], high[3], metres[2];
  conic_splats_bounds(points, low, high);
  for (int axis = 0; axis < 2; axis++)
    middle[axis] = 0.5 * low[axis] + 0.5 * high[axis];
  double sine = conic_sin(conic_radians(middle[1]));
  double flattening = 1.0 - earth_eccentricity_squared * sine * sine;
  double across = earth_radius / sqrt(flattening); /* the radius of curvature across the meridian … */
  metres[0] = conic_radians(1.0) * across * conic_cos(conic_radians(middle[1]));
  metres[1] = conic_radians(1.0) * across * (1.0 - earth_eccentricity_squared) / flattening; /* … and along it */
  for (int axis = 0; axis < 2; axis++) {
    double offset = points->origin[axis] - middle[axis];
    for (size_t i = 0; i < points->count; i++)
      points->position[axis][i] = (float)(((double)points->position[axis][i] + offset) * metres[axis]);
    points->origin[axis] = 0.0;
  }
}
