/* Algebraic point-set surfaces (Guennebaud and Gross 2007): a sphere u₀ + u·x + u₄ x·x = 0 is fitted to the samples'
 * places and normals, and the point's foot on it is found. The weights are about the foot; both steps repeat until they
 * agree. */
#include <math.h>

#include "core/base/vectors.h"
#include "surface/mls_surface.h"

enum { MAX_ROUNDS = 100, LEAST_SAMPLES = 4 };

/* In units of h: a step shorter than this is the last one; if the samples' mean is farther from the foot than this,
 * they lie to one side, and the sphere there follows no data. */
static const double SETTLED = 1e-10, FARTHEST_MEAN = 0.75;

typedef struct fitted_sphere {
  double constant, linear[3], square; /* about the place of its weights */
} fitted_sphere;

/* The sphere whose gradient is nearest to the normals, through the samples' mean. 0 where the normals cancel. */
static int fit_sphere(const double sums[CONIC_N_SPHERE_SUMS], fitted_sphere *s) {
  double w = sums[0], inverse = 1.0 / w;
  const double *places = sums + 1, *normals = sums + 4;
  double spread = sums[7] - conic_dot(places, places) * inverse;
  double turn = sums[8] - conic_dot(places, normals) * inverse;
  s->square = spread > 0.0 ? 0.5 * turn / spread : 0.0;
  for (int axis = 0; axis < 3; axis++)
    s->linear[axis] = (normals[axis] - 2.0 * s->square * places[axis]) * inverse;
  s->constant = -(conic_dot(s->linear, places) + s->square * sums[7]) * inverse;
  return conic_dot(s->linear, s->linear) - 4.0 * s->constant * s->square > 0.0;
}

/* Moves from `from` along the sphere's gradient to its surface; returns 0 where there is none. */
static int drop_to_sphere(const fitted_sphere *s, const double from[3], double foot[3], double normal[3]) {
  double gradient[3], value = s->constant + conic_dot(s->linear, from) + s->square * conic_dot(from, from);
  for (int axis = 0; axis < 3; axis++)
    gradient[axis] = s->linear[axis] + 2.0 * s->square * from[axis];
  double length2 = conic_dot(gradient, gradient), root2 = length2 - 4.0 * s->square * value;
  if (!(length2 > 0.0 && root2 >= 0.0))
    return 0;
  double length = sqrt(length2), along = -2.0 * value / (length + sqrt(root2));
  for (int axis = 0; axis < 3; axis++) {
    foot[axis] = from[axis] + along * gradient[axis] / length;
    normal[axis] = s->linear[axis] + 2.0 * s->square * foot[axis];
  }
  length = conic_length(normal);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = length > 0.0 ? normal[axis] / length : 0.0;
  return length > 0.0;
}

conic_surface_outcome conic_surface_find_sphere(const conic_surface *surface, double h, double margin,
                                                conic_workspace *workspace, conic_landing *projection) {
  double foot[3] = {0.0, 0.0, 0.0}, normal[3], sums[CONIC_N_SPHERE_SUMS];
  for (int i = 0; i < MAX_ROUNDS; i++) {
    fitted_sphere s;
    double from[3], step[3];
    surface->loops.sphere(&workspace->near, &surface->weighing, foot, sums);
    if (!(sums[9] >= (double)LEAST_SAMPLES))
      return CONIC_SURFACE_TOO_FEW;
    for (int axis = 0; axis < 3; axis++)
      from[axis] = -foot[axis]; /* the point itself, relative to the foot */
    if (!fit_sphere(sums, &s) || !drop_to_sphere(&s, from, step, normal))
      return CONIC_SURFACE_NO_MINIMUM;
    double moved = conic_length(step);
    for (int axis = 0; axis < 3; axis++)
      foot[axis] += step[axis];
    if (!(conic_dot(foot, foot) <= margin * margin))
      return CONIC_SURFACE_NO_MINIMUM;
    if (moved <= SETTLED * h) {
      if (conic_dot(sums + 1, sums + 1) > (FARTHEST_MEAN * h * sums[0]) * (FARTHEST_MEAN * h * sums[0]))
        return CONIC_SURFACE_ILL_CONDITIONED;
      for (int axis = 0; axis < 3; axis++) {
        projection->offset[axis] = projection->foot[axis] = foot[axis];
        projection->normal[axis] = projection->plane_normal[axis] = normal[axis];
      }
      projection->n_neighbours = (int)sums[9];
      return CONIC_SURFACE_DONE;
    }
  }
  return CONIC_SURFACE_NO_MINIMUM;
}
