/* Where what was drawn together is put. */
#include <math.h>
#include <string.h>

#include "core/base/vectors.h"
#include "lod/clusters/cluster_simplifier.h"

/* What holds a vertex at its place where the quadric does not, as a part of the quadric's own size. */
static const double hold = 1e-3;

/* Solves the symmetric system whose upper half is given: by the cofactors, so that it is the same everywhere. Returns
 * whether it has a solution. */
static int solve_upper(const double a[6], const double right[3], double x[3]) {
  double c0 = a[3] * a[5] - a[4] * a[4], c1 = a[2] * a[4] - a[1] * a[5], c2 = a[1] * a[4] - a[2] * a[3];
  double determinant = a[0] * c0 + a[1] * c1 + a[2] * c2;
  double c3 = a[0] * a[5] - a[2] * a[2], c4 = a[1] * a[2] - a[0] * a[4], c5 = a[0] * a[3] - a[1] * a[1];
  if (!(determinant > 0.0))
    return 0;
  x[0] = (c0 * right[0] + c1 * right[1] + c2 * right[2]) / determinant;
  x[1] = (c1 * right[0] + c3 * right[1] + c4 * right[2]) / determinant;
  x[2] = (c2 * right[0] + c4 * right[1] + c5 * right[2]) / determinant;
  return 1;
}

/* What has one colour is moved to where the quadric is least, but no farther than the edge is long; what lies on a
 * border only along one. */
static int may_move(const conic_simplifier *s, uint32_t u, uint32_t v) {
  return s->is_one && !s->contrasts && s->vertices[v].kind == s->vertices[u].kind;
}

void conic_simplifier_find_place(const conic_simplifier *s, uint32_t u, uint32_t v, const conic_quadric *both,
                                 double at[3]) {
  const double *from = s->vertices[v].at, *gone = s->vertices[u].at, *a = both->a;
  double side[3], step[3], held = hold * (a[0] + a[3] + a[5]);
  const double holding[6] = {a[0] + held, a[1], a[2], a[3] + held, a[4], a[5] + held};
  const double right[3] = {-(a[0] * from[0] + a[1] * from[1] + a[2] * from[2] + both->b[0]),
                           -(a[1] * from[0] + a[3] * from[1] + a[4] * from[2] + both->b[1]),
                           -(a[2] * from[0] + a[4] * from[1] + a[5] * from[2] + both->b[2])};
  memcpy(at, from, 3 * sizeof *at);
  conic_subtract(gone, from, side);
  if (!may_move(s, u, v) || !solve_upper(holding, right, step) || !(conic_dot(step, step) <= conic_dot(side, side)))
    return;
  for (int axis = 0; axis < 3; axis++)
    at[axis] = (double)(float)(from[axis] + step[axis]);
}
