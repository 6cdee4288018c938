#include "lod/distance.h"

#include <math.h>

#include "lod/mesh.h"

static void subtract(const double a[3], const double b[3], double difference[3]) {
  for (int axis = 0; axis < 3; axis++)
    difference[axis] = a[axis] - b[axis];
}

static double distance2_to_side(const double p[3], const double a[3], const double b[3]) {
  double side[3], way[3];
  subtract(b, a, side);
  subtract(p, a, way);
  double length2 = conic_dot(side, side), t = length2 > 0.0 ? conic_dot(way, side) / length2 : 0.0;
  t = t > 0.0 ? t < 1.0 ? t : 1.0 : 0.0;
  for (int axis = 0; axis < 3; axis++)
    way[axis] -= t * side[axis];
  return conic_dot(way, way);
}

/* Above the inside it is the distance from the plane, else that from the nearest side. */
double conic_distance2_to_triangle(const double p[3], const double a[3], const double b[3], const double c[3]) {
  const double *corners[3] = {a, b, c};
  double ab[3], ac[3], normal[3], way[3], side[3], inwards[3];
  subtract(b, a, ab);
  subtract(c, a, ac);
  conic_cross(ab, ac, normal);
  double length2 = conic_dot(normal, normal), least = HUGE_VAL;
  int is_above = length2 > 0.0;
  for (int k = 0; k < 3; k++) {
    subtract(corners[(k + 1) % 3], corners[k], side);
    subtract(p, corners[k], way);
    conic_cross(normal, side, inwards);
    is_above = is_above && conic_dot(way, inwards) >= 0.0;
  }
  if (is_above) {
    subtract(p, a, way);
    double height = conic_dot(way, normal);
    return height * height / length2;
  }
  for (int k = 0; k < 3; k++) {
    double distance2 = distance2_to_side(p, corners[k], corners[(k + 1) % 3]);
    least = distance2 < least ? distance2 : least;
  }
  return least;
}
