#include "gaussians/draw/unscented_box.h"

#include <math.h>

#include "core/base/power.h"
#include "gaussians/draw/view_rays.h"

enum { SIGMA_POINTS = 7 }; /* the mean, and one on either side of it along each axis */

/* Where they are on the screen, 0, 0 where behind the eye. Returns 0 where none is in the picture or near it. */
static int find_sigma_points(const conic_gaussian_view *view, const conic_gaussian_placed *p, double step,
                             double points[SIGMA_POINTS][2]) {
  const double focal[2] = {view->camera->fx, view->camera->fy}, size[2] = {view->camera->width, view->camera->height};
  int is_seen = 0;
  for (int i = 0; i < SIGMA_POINTS; i++) {
    const int axis_of = (i + 2) % 3;
    const double along = (i == 0 ? 0.0 : i > 3 ? -step : step) * p->scale[axis_of];
    double at[3];
    for (int row = 0; row < 3; row++)
      at[row] = p->mean[row] + along * p->unit[axis_of][row];
    if (view->rays) {
      double share;
      is_seen |= conic_view_rays_show(view->rays, at, view->rules->unscented_share, points[i], &share);
      continue;
    }
    int is_in = at[2] > 0.0;
    for (int axis = 0; axis < 2; axis++) {
      const double margin = view->rules->unscented_share * size[axis];
      points[i][axis] = at[2] > 0.0 ? focal[axis] * (at[axis] / at[2]) + view->center_px[axis] : 0.0;
      is_in &= points[i][axis] >= -margin && points[i][axis] < size[axis] + margin;
    }
    is_seen |= is_in;
  }
  return is_seen;
}

/* The half size of the box that is looked at, from the dilated variances; 0 where it is left out. */
static int find_unscented_size(const conic_profile_row *rules, const double v[3], double opacity, double half[2]) {
  const double h = rules->dilation, wide = v[0] * v[2] - v[1] * v[1];
  const double share = ((v[0] - h) * (v[2] - h) - v[1] * v[1]) / wide;
  const double ratio = opacity * sqrt(share > 2.5e-5 ? share : 2.5e-5) / (double)(float)rules->alpha_least;
  if (!(wide > 0.0) || !(v[0] >= 0.0) || !(v[2] >= 0.0) || !(ratio >= 1.0))
    return 0;
  const double mean = 0.5 * (v[0] + v[2]), apart = mean * mean - wide;
  const double longest = mean + sqrt(apart > 0.01 ? apart : 0.01);
  const double extent = conic_limited(sqrt(2.0 * conic_logarithm(ratio)), 0.0, 3.33);
  for (int axis = 0; axis < 2; axis++)
    half[axis] = extent * sqrt(v[(size_t)axis * 2] < longest ? v[(size_t)axis * 2] : longest);
  return half[0] + half[1] - (half[0] + half[1]) == 0.0;
}

int conic_gaussian_unscented_box(const conic_gaussian_view *view, const conic_gaussian_placed *p, double place[2],
                                 double half[2]) {
  const conic_profile_row *rules = view->rules;
  const double square = rules->unscented[0] * rules->unscented[0], spread = square * (3.0 + rules->unscented[2]);
  const double of_mean = (spread - 3.0) / spread, of_others = 0.5 / spread;
  double points[SIGMA_POINTS][2], v[3] = {rules->dilation, 0.0, rules->dilation};
  if (!find_sigma_points(view, p, sqrt(spread), points))
    return 0;
  for (int axis = 0; axis < 2; axis++) {
    place[axis] = of_mean * points[0][axis];
    for (int i = 1; i < SIGMA_POINTS; i++)
      place[axis] += of_others * points[i][axis];
  }
  for (int i = 0; i < SIGMA_POINTS; i++) {
    const double x = points[i][0] - place[0], y = points[i][1] - place[1];
    const double weight = i ? of_others : of_mean + 1.0 - square + rules->unscented[1];
    v[0] += weight * x * x;
    v[1] += weight * x * y;
    v[2] += weight * y * y;
  }
  return place[0] + place[1] - (place[0] + place[1]) == 0.0 && find_unscented_size(rules, v, p->opacity, half);
}
