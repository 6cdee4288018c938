#include "core/base/triangle_distance.h"

#include "core/base/vectors.h"

/* From p - a and the side b - a; `along` is their dot product, and the foot lies between the ends. */
static double distance2_to_side(const double way[3], const double side[3], double along) {
  double length2 = conic_dot(side, side), t = length2 > 0.0 ? along / length2 : 0.0, sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double d = way[axis] - t * side[axis];
    sum += d * d;
  }
  return sum;
}

/* By regions: the nearest place is a corner, on a side, or inside; the products with the sides tell which (Ericson,
 * Real-Time Collision Detection, §5.1.5). */
double conic_distance2_to_triangle(const double p[3], const double a[3], const double b[3], const double c[3]) {
  double ab[3], ac[3], ap[3], bp[3], cp[3], bc[3], normal[3];
  conic_subtract(b, a, ab);
  conic_subtract(c, a, ac);
  conic_subtract(p, a, ap);
  double ab_ap = conic_dot(ab, ap), ac_ap = conic_dot(ac, ap);
  if (ab_ap <= 0.0 && ac_ap <= 0.0)
    return conic_dot(ap, ap);
  conic_subtract(p, b, bp);
  double ab_bp = conic_dot(ab, bp), ac_bp = conic_dot(ac, bp);
  if (ab_bp >= 0.0 && ac_bp <= ab_bp)
    return conic_dot(bp, bp);
  conic_subtract(p, c, cp);
  double ab_cp = conic_dot(ab, cp), ac_cp = conic_dot(ac, cp);
  if (ac_cp >= 0.0 && ab_cp <= ac_cp)
    return conic_dot(cp, cp);
  if (ab_ap * ac_bp - ab_bp * ac_ap <= 0.0 && ab_ap >= 0.0 && ab_bp <= 0.0)
    return distance2_to_side(ap, ab, ab_ap);
  if (ab_cp * ac_ap - ab_ap * ac_cp <= 0.0 && ac_ap >= 0.0 && ac_cp <= 0.0)
    return distance2_to_side(ap, ac, ac_ap);
  conic_subtract(c, b, bc);
  if (ab_bp * ac_cp - ab_cp * ac_bp <= 0.0 && ac_bp - ab_bp >= 0.0 && ab_cp - ac_cp >= 0.0)
    return distance2_to_side(bp, bc, conic_dot(bp, bc));
  conic_cross(ab, ac, normal);
  double height = conic_dot(ap, normal);
  return height * height / conic_dot(normal, normal);
}
