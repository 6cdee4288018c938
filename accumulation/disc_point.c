#include "accumulation/disc_point.h"

#include <math.h>

#include "core/base/trigonometry.h"

void conic_disc_point(double u, double v, double point[2]) {
  double x = 2.0 * u - 1.0, y = 2.0 * v - 1.0;
  int is_flat = fabs(x) > fabs(y);
  double radius = is_flat ? x : y, other = is_flat ? y : x;
  double angle = radius == 0.0 ? 0.0 : CONIC_PI / 4.0 * (other / radius);
  double along = radius * conic_cos(angle), across = radius * conic_sin(angle);
  point[0] = is_flat ? along : across;
  point[1] = is_flat ? across : along;
}
