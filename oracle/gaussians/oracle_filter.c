/* A Gaussian's response to a pixel's ray under the pixel's own filter: docs/reference/gaussians.md, Filter. */
#include "oracle/gaussians/oracle_gaussian.h"
#include "oracle/oracle_math.h"

/* The ray and its change by a pixel in x and in y, turned into the Gaussian's axes; m from the ray's origin to the
 * mean. */
typedef struct turned_ray {
  double d[3][3], m[3][3];
} turned_ray;

static turned_ray turn_ray(const oracle_gaussian_view *view, const oracle_gaussian *g, double x, double y) {
  const conic_camera *camera = view->camera;
  const double place[3][3] = {{(x - camera->cx) / camera->fx, (y - camera->cy) / camera->fy, 0.0},
                              {1.0 / camera->fx, 0.0, 0.0},
                              {0.0, 1.0 / camera->fy, 0.0}};
  int is_parallel = camera->kind == CONIC_CAMERA_ORTHOGRAPHIC;
  turned_ray t;
  for (int step = 0; step < 3; step++)
    for (int axis = 0; axis < 3; axis++) {
      double along = oracle_dot(g->unit[axis], place[step]), forward = step ? 0.0 : g->unit[axis][2];
      t.d[step][axis] = is_parallel ? forward : along + forward;
      t.m[step][axis] = (step ? 0.0 : oracle_dot(g->unit[axis], g->mean)) - (is_parallel ? along : 0.0);
    }
  return t;
}

/* Where the ray meets the plane of a flat Gaussian, in standard deviations, and the change of that by a pixel. */
static double meet_flat(const oracle_gaussian *g, const turned_ray *t, double u[2], double by[2][2]) {
  double z = t->m[0][2] / t->d[0][2];
  for (int axis = 0; axis < 2; axis++) {
    u[axis] = (z * t->d[0][axis] - t->m[0][axis]) / g->scale[axis];
    for (int step = 1; step < 3; step++) {
      double z_by = (t->m[step][2] - z * t->d[step][2]) / t->d[0][2];
      by[step - 1][axis] = (z_by * t->d[0][axis] + z * t->d[step][axis] - t->m[step][axis]) / g->scale[axis];
    }
  }
  return z;
}

/* The ray's nearest point to the mean where the Gaussian is a unit ball, in two directions across the ray. */
static double meet_ball(const oracle_gaussian *g, const turned_ray *t, double u[2], double by[2][2]) {
  double d[3][3], m[3][3], across[2][3], thin[3] = {0.0, 0.0, 0.0};
  for (int step = 0; step < 3; step++)
    for (int axis = 0; axis < 3; axis++) {
      d[step][axis] = t->d[step][axis] / g->scale[axis];
      m[step][axis] = t->m[step][axis] / g->scale[axis];
    }
  int least = fabs(d[0][0]) < fabs(d[0][1]) ? 0 : 1;
  least = fabs(d[0][2]) < fabs(d[0][least]) ? 2 : least;
  thin[least] = 1.0;
  oracle_cross(d[0], thin, across[0]);
  oracle_cross(d[0], across[0], across[1]);
  double z = oracle_dot(d[0], m[0]) / oracle_dot(d[0], d[0]);
  for (int k = 0; k < 2; k++) {
    double length = oracle_length(across[k]);
    for (int axis = 0; axis < 3; axis++)
      across[k][axis] /= length;
    u[k] = -oracle_dot(across[k], m[0]); /* that of z·d − m; d has none */
    for (int step = 1; step < 3; step++)
      by[step - 1][k] = oracle_dot(across[k], d[step]) * z - oracle_dot(across[k], m[step]);
  }
  return z;
}

int conic_oracle_gaussian_filtered(const oracle_gaussian_view *view, const oracle_gaussian *g, double x, double y,
                                   double *q, double *z, double *share) {
  turned_ray t = turn_ray(view, g, x, y);
  double u[2], by[2][2], h = view->prefilter;
  *z = g->is_flat || g->scale[2] == 0.0 ? meet_flat(g, &t, u, by) : meet_ball(g, &t, u, by);
  oracle_symmetric S = {1.0 + h * (by[0][0] * by[0][0] + by[1][0] * by[1][0]),
                        h * (by[0][0] * by[0][1] + by[1][0] * by[1][1]),
                        1.0 + h * (by[0][1] * by[0][1] + by[1][1] * by[1][1])};
  double area = by[0][0] * by[1][1] - by[0][1] * by[1][0];
  double determinant = S.xx + S.yy - 1.0 + h * area * (h * area);
  *q = (S.yy * u[0] * u[0] - 2.0 * S.xy * u[0] * u[1] + S.xx * u[1] * u[1]) / determinant;
  *share = 1.0 / sqrt(determinant);
  return *z > 0.0 && oracle_is_finite(*q) && oracle_is_finite(*z);
}

/* Planes through the eye, or along the view, that are upright or level and touch the ellipsoid at q = reach. */
int conic_oracle_gaussian_box(const oracle_gaussian_view *view, oracle_gaussian *g) {
  const conic_camera *camera = view->camera;
  const double focal[2] = {camera->fx, camera->fy}, center[2] = {camera->cx, camera->cy}, *p = g->mean;
  double reach = 2.0 * conic_oracle_log(g->opacity / view->rules->alpha_least), growth = sqrt(reach * view->prefilter);
  if (!(reach >= 0.0))
    return 0;
  for (int axis = 0; axis < 2; axis++) {
    double xx = 0.0, xz = 0.0, zz = 0.0;
    for (int k = 0; k < 3; k++) {
      xx += reach * g->axes[k][axis] * g->axes[k][axis];
      xz += reach * g->axes[k][axis] * g->axes[k][2];
      zz += reach * g->axes[k][2] * g->axes[k][2];
    }
    double low = p[axis] - sqrt(xx), high = p[axis] + sqrt(xx);
    if (camera->kind != CONIC_CAMERA_ORTHOGRAPHIC) {
      double square = p[2] * p[2] - zz, half = p[axis] * p[2] - xz;
      double root = half * half - square * (p[axis] * p[axis] - xx);
      if (!(square > 0.0) || !(root >= 0.0))
        continue;
      low = (half - sqrt(root)) / square;
      high = (half + sqrt(root)) / square;
    }
    g->box_px[0][axis] = focal[axis] * low + center[axis] - growth;
    g->box_px[1][axis] = focal[axis] * high + center[axis] + growth;
  }
  return 1;
}
