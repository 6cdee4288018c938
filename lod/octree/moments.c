/* Sums over a set of splats: the generic homogeneous covariance of Confetti (§4.2), and the averages beside it. A node
 * gets them by merging its children's. */
#include "lod/octree/octree_fit.h"

#include <string.h>

#include "core/base/vectors.h"

/* The symmetric product a·bᵀ, b being a multiple of a, into the six. */
static void add_outer(double scatter[6], const double a[3], const double b[3]) {
  scatter[0] += a[0] * b[0];
  scatter[1] += a[0] * b[1];
  scatter[2] += a[0] * b[2];
  scatter[3] += a[1] * b[1];
  scatter[4] += a[1] * b[2];
  scatter[5] += a[2] * b[2];
}

void conic_moments_of_splat(const conic_splats *splats, size_t i, conic_moments *moments) {
  double u[3], v[3];
  memset(moments, 0, sizeof *moments);
  moments->count = 1.0;
  conic_vector_at(splats->position, i, moments->mean);
  conic_vector_at(splats->tangent_u, i, u);
  conic_vector_at(splats->tangent_v, i, v);
  conic_cross(u, v, moments->normal);
  add_outer(moments->scatter, u, u);
  add_outer(moments->scatter, v, v);
  double opacity = splats->opacity ? (double)splats->opacity[i] : 1.0;
  moments->area = conic_length(moments->normal);
  moments->weight = opacity > 0.0 ? opacity * moments->area : 0.0;
  for (int axis = 0; axis < 3; axis++)
    moments->color[axis] = moments->weight * (splats->color[axis] ? (double)splats->color[axis][i] : 1.0);
}

void conic_moments_merge(conic_moments *sum, const conic_moments *more) {
  double apart[3], pulled[3], count = sum->count + more->count;
  if (sum->count == 0.0) {
    *sum = *more;
    return;
  }
  /* Both translated to the mean of the union: the outer product of what parts the means. */
  for (int axis = 0; axis < 3; axis++) {
    apart[axis] = more->mean[axis] - sum->mean[axis];
    pulled[axis] = apart[axis] * (sum->count * more->count / count);
    sum->mean[axis] += apart[axis] * (more->count / count);
    sum->normal[axis] += more->normal[axis];
    sum->color[axis] += more->color[axis];
  }
  for (int i = 0; i < 6; i++)
    sum->scatter[i] += more->scatter[i];
  add_outer(sum->scatter, apart, pulled);
  sum->count = count;
  sum->area += more->area;
  sum->weight += more->weight;
}
