/* How far the outline of a disc, clipped at the near plane, reaches on the screen. */
#include "oracle/oracle_splat.h"

/* Adds the place that a point of camera space projects to. */
static void add_extreme(const oracle_view *view, const double point[3], const double e[2], oracle_extreme extremes[2],
                        int *n_found) {
  const conic_camera *c = &view->camera;
  oracle_extreme found;
  found.inverse_depth = 1.0 / point[2];
  found.place[0] = c->fx * point[0] / point[2] + c->cx;
  found.place[1] = c->fy * point[1] / point[2] + c->cy;
  found.along = e[0] * found.place[0] + e[1] * found.place[1];
  if (!oracle_is_finite(found.along))
    return;
  if (!*n_found || found.along < extremes[0].along)
    extremes[0] = found;
  if (!*n_found || found.along > extremes[1].along)
    extremes[1] = found;
  ++*n_found;
}

/* Where a·cos t + b·sin t + c = 0: up to two pairs (cos t, sin t). */
static int solve_angle(double a, double b, double c, double solutions[2][2]) {
  double squared = a * a + b * b, rest = squared - c * c;
  if (!(squared > 0.0) || !(rest >= 0.0))
    return 0;
  double foot = -c / squared, half = sqrt(rest) / squared;
  for (int i = 0; i < 2; i++) {
    double side = i ? half : -half;
    solutions[i][0] = foot * a - side * b;
    solutions[i][1] = foot * b + side * a;
  }
  return 2;
}

static void point_at(const oracle_view *view, const oracle_placed *s, const double angle[2], double point[3]) {
  for (int i = 0; i < 3; i++)
    point[i] = s->p[i] + view->cutoff * (s->tu[i] * angle[0] + s->tv[i] * angle[1]);
}

int conic_oracle_extremes(const oracle_view *view, const oracle_placed *s, const double e[2],
                          oracle_extreme extremes[2]) {
  /* Along the outline e·x is (n₀ + n₁ cos t + n₂ sin t)/(d₀ + d₁ cos t + d₂ sin t); its derivative vanishes where
   * (n₂d₀ − n₀d₂) cos t + (n₀d₁ − n₁d₀) sin t + (n₂d₁ − n₁d₂) = 0. */
  const double *vectors[3] = {s->p, s->tu, s->tv};
  double n[3], d[3], angles[2][2], point[3];
  int n_found = 0;
  for (int i = 0; i < 3; i++) {
    double factor = i ? view->cutoff : 1.0;
    n[i] = factor * (e[0] * view->camera.fx * vectors[i][0] + e[1] * view->camera.fy * vectors[i][1]);
    d[i] = factor * vectors[i][2];
  }
  int n_angles = solve_angle(n[2] * d[0] - n[0] * d[2], n[0] * d[1] - n[1] * d[0], n[2] * d[1] - n[1] * d[2], angles);
  for (int i = 0; i < n_angles; i++) {
    point_at(view, s, angles[i], point);
    if (point[2] > view->near_z)
      add_extreme(view, point, e, extremes, &n_found);
  }
  /* The chord in which the near plane cuts the disc ends on the outline. */
  n_angles = solve_angle(d[1], d[2], d[0] - view->near_z, angles);
  for (int i = 0; i < n_angles; i++) {
    point_at(view, s, angles[i], point);
    point[2] = view->near_z;
    add_extreme(view, point, e, extremes, &n_found);
  }
  return n_found > 0;
}
