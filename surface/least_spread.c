#include "surface/least_spread.h"

#include "core/base/eigen.h"
#include "core/base/vectors.h"

enum { MAX_STEPS = 24 };

/* The product of the eigenvalues' gaps, with their sum as unit: below this, the cross products lose too many digits. */
static const double LEAST_GAPS = 1e-5;

/* The least root of the characteristic polynomial of a matrix with trace 1. Newton's steps climb from 0 and never pass
 * it, because the polynomial is convex there. */
static double least_eigenvalue(const double m[6]) {
  double minors = (m[0] * m[3] - m[1] * m[1]) + (m[0] * m[5] - m[2] * m[2]) + (m[3] * m[5] - m[4] * m[4]);
  double determinant =
      m[0] * (m[3] * m[5] - m[4] * m[4]) - m[1] * (m[1] * m[5] - m[4] * m[2]) + m[2] * (m[1] * m[4] - m[3] * m[2]);
  double value = 0.0;
  for (int i = 0; i < MAX_STEPS; i++) {
    double height = ((1.0 - value) * value - minors) * value + determinant;
    double slope = (2.0 - 3.0 * value) * value - minors;
    double step = slope < 0.0 ? -height / slope : 0.0;
    value += step;
    if (!(fabs(step) > 1e-16))
      break;
  }
  return value;
}

/* The rows of the matrix less the eigenvalue span a plane; finds its normal from the best two of them. Returns 0 where
 * none will do. */
static int find_least_axis(const double m[6], double normal[3]) {
  double value = least_eigenvalue(m), best2 = LEAST_GAPS * LEAST_GAPS;
  const double rows[3][3] = {{m[0] - value, m[1], m[2]}, {m[1], m[3] - value, m[4]}, {m[2], m[4], m[5] - value}};
  int is_found = 0;
  for (int i = 0; i < 3; i++) {
    double across[3];
    conic_cross(rows[i], rows[(i + 1) % 3], across);
    double length2 = conic_dot(across, across);
    if (!(length2 > best2))
      continue;
    best2 = length2;
    is_found = 1;
    for (int axis = 0; axis < 3; axis++)
      normal[axis] = across[axis] / sqrt(length2);
  }
  return is_found;
}

void conic_least_spread(const double covariance[6], double frame[3][3]) {
  double m[6], trace = covariance[0] + covariance[3] + covariance[5], values[3];
  for (int i = 0; i < 6; i++)
    m[i] = covariance[i] / trace;
  if (!find_least_axis(m, frame[2])) {
    conic_eigen3(covariance, values, frame);
    conic_cross(frame[2], frame[0], frame[1]);
    return;
  }
  const double *n = frame[2];
  int least = fabs(n[0]) <= fabs(n[1]) ? 0 : 1;
  least = fabs(n[2]) < fabs(n[least]) ? 2 : least;
  double along = n[least], inverse = 1.0 / sqrt(1.0 - along * along);
  for (int axis = 0; axis < 3; axis++)
    frame[0][axis] = ((axis == least ? 1.0 : 0.0) - along * n[axis]) * inverse;
  conic_cross(frame[2], frame[0], frame[1]);
}
