/* Keeps patches at their points: a polynomial does not know where the surface ends, but splats may. */
#include <math.h>

#include "core/base/vectors.h"
#include "core/splats/clip.h"
#include "surface/patches/patch_set.h"

const double conic_eight_directions[8][2] = {
    {1, 0},  {0.70710678118654752, 0.70710678118654752},   {0, 1},  {-0.70710678118654752, 0.70710678118654752},
    {-1, 0}, {-0.70710678118654752, -0.70710678118654752}, {0, -1}, {0.70710678118654752, -0.70710678118654752}};

static int is_kept(const conic_splats *splats, size_t splat, double u, double v) {
  size_t i = conic_clip_find(splats, splat);
  int n_keeping = 0;
  if (i == splats->n_clips || splats->clips[i].splat != splat)
    return 1;
  const conic_clip *clip = &splats->clips[i];
  for (int k = 0; k < clip->n_lines; k++)
    n_keeping += (double)clip->lines[k][0] * u + (double)clip->lines[k][1] * v + (double)clip->lines[k][2] >= 0.0;
  return clip->operation == CONIC_CLIP_OR ? n_keeping > 0 : n_keeping == clip->n_lines;
}

/* Whether a splat with its centre at `to` from the place is within most_off of the place. */
static int is_at_splat(const conic_patches *patches, size_t splat, const double to[3]) {
  const conic_splats *splats = &patches->splats;
  double u[3], v[3], normal[3], limit = (double)patches->options.cutoff;
  conic_vector_at(splats->tangent_u, splat, u);
  conic_vector_at(splats->tangent_v, splat, v);
  double along = -conic_dot(to, u) / conic_dot(u, u), across = -conic_dot(to, v) / conic_dot(v, v);
  conic_cross(u, v, normal);
  return along * along + across * across <= limit * limit && conic_normalize(normal) &&
         fabs(conic_dot(to, normal)) <= patches->options.most_off && is_kept(splats, splat, along, across);
}

static double height_at(const conic_fit *fit, int degree, double x, double y) {
  double sum = 0.0, first = 1.0;
  for (int i = 0; i <= degree; i++, first *= x) {
    double power = first;
    for (int j = 0; i + j <= degree; j++, power *= y)
      sum += fit->coefficients[(i + j) * (i + j + 1) / 2 + j] * power;
  }
  return sum;
}

/* Whether the polynomial at (x, y), in units of h, is at a splat of the nearby points. */
static int is_at_points(const conic_patches *patches, const conic_workspace *workspace, int degree, double h, double x,
                        double y) {
  const conic_near *near = &workspace->near;
  const conic_fit *fit = &workspace->fit;
  double place[3], height = height_at(fit, degree, x, y);
  for (int axis = 0; axis < 3; axis++)
    place[axis] =
        fit->foot[axis] + h * (x * fit->frame[0][axis] + y * fit->frame[1][axis] + height * fit->frame[2][axis]);
  for (size_t i = 0; i < near->n; i++) {
    double to[3];
    if (near->sources[i] & CONIC_CLUSTER_BIT)
      continue;
    for (int axis = 0; axis < 3; axis++)
      to[axis] = near->offset[axis][i] - place[axis];
    if (is_at_splat(patches, patches->surface->tree.point_of_slot[near->sources[i]], to))
      return 1;
  }
  return 0;
}

int conic_patch_stays_at_points(const conic_patches *patches, const conic_workspace *workspace, int degree, double h,
                                double radius) {
  for (int i = 0; i < 17; i++) {
    double share = i < 8 ? 1.0 : i < 16 ? 0.5 : 0.0;
    if (!is_at_points(patches, workspace, degree, h, share * radius / h * conic_eight_directions[i % 8][0],
                      share * radius / h * conic_eight_directions[i % 8][1]))
      return 0;
  }
  return 1;
}
