#include "core/splats/ellipse.h"

#include <math.h>

#include "core/base/eigen.h"

void conic_tangent_basis(const double normal[3], double u[3], double v[3]) {
  /* sign + z is at least 1 in magnitude, wherever the normal points. */
  double sign = normal[2] >= 0.0 ? 1.0 : -1.0;
  double s = -1.0 / (sign + normal[2]), t = normal[0] * normal[1] * s;
  u[0] = 1.0 + sign * normal[0] * normal[0] * s;
  u[1] = sign * t;
  u[2] = -sign * normal[0];
  v[0] = t;
  v[1] = sign + normal[1] * normal[1] * s;
  v[2] = -normal[1];
}

conic_ellipse conic_ellipse_shape(const double covariance[3], double least_ratio) {
  double values[2];
  conic_ellipse ellipse;
  conic_eigen2(covariance[0], covariance[1], covariance[2], values, ellipse.major);
  /* The eigenvalues are variances, so the axes go as their roots. */
  double ratio = values[0] > 0.0 && values[1] > 0.0 ? sqrt(values[1] / values[0]) : 0.0;
  ellipse.ratio = ratio > least_ratio ? ratio : least_ratio;
  ellipse.reach = 0.0;
  return ellipse;
}

static double reach2_of(const conic_ellipse *ellipse, double x, double y) {
  double along = x * ellipse->major[0] + y * ellipse->major[1];
  double across = (y * ellipse->major[0] - x * ellipse->major[1]) / ellipse->ratio;
  return along * along + across * across;
}

void conic_ellipse_cover(conic_ellipse *ellipse, double x, double y) {
  double reach = sqrt(reach2_of(ellipse, x, y));
  ellipse->reach = reach > ellipse->reach ? reach : ellipse->reach;
}

/* A root of the greatest is the greatest root. */
static void cover_all(conic_ellipse *ellipse, const double (*points)[2], int n_points) {
  double greatest2 = 0.0;
  for (int i = 0; i < n_points; i++) {
    double reach2 = reach2_of(ellipse, points[i][0], points[i][1]);
    greatest2 = reach2 > greatest2 ? reach2 : greatest2;
  }
  ellipse->reach = sqrt(greatest2);
}

conic_ellipse conic_ellipse_bound(const double (*points)[2], int n_points, double least_ratio) {
  double covariance[3] = {0.0, 0.0, 0.0};
  for (int i = 0; i < n_points; i++)
    conic_ellipse_add(covariance, points[i][0], points[i][1]);
  conic_ellipse ellipse = conic_ellipse_shape(covariance, least_ratio);
  cover_all(&ellipse, points, n_points);
  return ellipse;
}

void conic_ellipse_retract(conic_ellipse *ellipse, const double (*points)[2], int n_points, double limit) {
  if (!(ellipse->reach > limit))
    return;
  for (int i = 0; i < n_points; i++) {
    double along = points[i][0] * ellipse->major[0] + points[i][1] * ellipse->major[1];
    double across = points[i][1] * ellipse->major[0] - points[i][0] * ellipse->major[1];
    double room2 = limit * limit - along * along;
    double ratio = room2 > 0.0 ? sqrt(across * across / room2) : 1.0;
    ellipse->ratio = ratio > ellipse->ratio ? ratio : ellipse->ratio;
  }
  ellipse->ratio = ellipse->ratio < 1.0 ? ellipse->ratio : 1.0;
  cover_all(ellipse, points, n_points);
}

void conic_ellipse_overlap(conic_ellipse *ellipse, double cell_area, double cover, double blend,
                           double greatest_reach) {
  double wanted = blend * sqrt(cell_area / ellipse->ratio);
  wanted = wanted < greatest_reach ? wanted : greatest_reach;
  double least = cover * ellipse->reach;
  ellipse->reach = wanted > least ? wanted : least;
}

int conic_ellipse_axes(const conic_ellipse *ellipse, const double u[3], const double v[3], double sigmas,
                       float tangent_u[3], float tangent_v[3]) {
  double a = ellipse->reach / sigmas, b = a * ellipse->ratio, length_u = 0.0, length_v = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    tangent_u[axis] = (float)(a * (ellipse->major[0] * u[axis] + ellipse->major[1] * v[axis]));
    tangent_v[axis] = (float)(b * (ellipse->major[0] * v[axis] - ellipse->major[1] * u[axis]));
    length_u += fabs((double)tangent_u[axis]);
    length_v += fabs((double)tangent_v[axis]);
  }
  int is_good = length_u > 0.0 && length_v > 0.0 && length_u * 0.0 == 0.0 && length_v * 0.0 == 0.0;
  for (int axis = 0; axis < 3 && !is_good; axis++)
    tangent_u[axis] = tangent_v[axis] = NAN;
  return is_good;
}
