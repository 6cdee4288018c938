/* Sums of squared distances from planes, as a quadratic form of the place: vᵀAv + 2bᵀv + c (HQP Eq. 3.6). */
#pragma once

#include "core/base/vectors.h"

typedef struct conic_quadric {
  double a[6], b[3], c; /* xx, xy, xz, yy, yz, zz */
} conic_quadric;

/* Adds `weight` times the squared distance from the plane n·v + d = 0. */
static inline void conic_quadric_add_plane(conic_quadric *q, const double n[3], double d, double weight) {
  const double weighted[3] = {weight * n[0], weight * n[1], weight * n[2]};
  conic_add_outer(q->a, weighted, n);
  for (int axis = 0; axis < 3; axis++)
    q->b[axis] += weight * d * n[axis];
  q->c += weight * d * d;
}

static inline void conic_quadric_add(conic_quadric *q, const conic_quadric *more) {
  for (int i = 0; i < 6; i++)
    q->a[i] += more->a[i];
  for (int i = 0; i < 3; i++)
    q->b[i] += more->b[i];
  q->c += more->c;
}

static inline double conic_quadric_at(const conic_quadric *q, const double v[3]) {
  double square = (q->a[0] * v[0] * v[0] + q->a[3] * v[1] * v[1] + q->a[5] * v[2] * v[2]) +
                  2.0 * (q->a[1] * v[0] * v[1] + q->a[2] * v[0] * v[2] + q->a[4] * v[1] * v[2]);
  return (square + 2.0 * (q->b[0] * v[0] + q->b[1] * v[1] + q->b[2] * v[2])) + q->c;
}
