#include "gaussians/draw/screen_variance.h"

#include "core/base/vectors.h"

double conic_screen_compensation(const conic_profile_row *rules, double bare, double wide) {
  const double slack = rules->compensation_slack, ratio = bare / (wide + slack);
  if (slack > 0.0 && !(bare > slack))
    return 0.0;
  return sqrt((ratio > rules->compensation_least ? ratio : rules->compensation_least) + slack);
}

/* The greatest standard deviation along an axis. */
static double longest_axis(const conic_gaussian_view *view) {
  const conic_profile_row *rules = view->rules;
  const int width = view->camera->width, height = view->camera->height;
  double most = rules->axis_most > 0.0 ? rules->axis_most : INFINITY;
  double share = rules->axis_share * (double)(width < height ? width : height);
  return share > 0.0 && share < most ? share : most;
}

int conic_screen_limit_axes(const conic_gaussian_view *view, conic_screen_variance *v) {
  const conic_profile_row *rules = view->rules;
  const double middle = 0.5 * (v->c[0] + v->c[2]), apart = 0.5 * (v->c[0] - v->c[2]);
  const double own = sqrt(apart * apart + v->c[1] * v->c[1]), least = rules->spread_least;
  const double spread = own > least ? own : least, most = longest_axis(view) * longest_axis(view);
  double across[3] = {1.0, 0.0, 0.0}, longer = middle + spread,
         shorter = own > least ? v->area / longer : middle - spread;
  const int is_free = own >= least && shorter >= rules->axis_least && longer <= most;
  if (longer < rules->axis_seen * rules->axis_seen || !(shorter > 0.0 || rules->axis_least > 0.0))
    return 0;
  if (is_free)
    return 1;
  if (own > least) {
    across[0] = 0.5 + 0.5 * apart / own;
    across[1] = 0.5 * v->c[1] / own;
    across[2] = 0.5 - 0.5 * apart / own;
  } else if (spread > apart || v->c[1] != 0.0) {
    const double down = spread - apart, squares = v->c[1] * v->c[1] + down * down;
    across[0] = v->c[1] * v->c[1] / squares;
    across[1] = v->c[1] * down / squares;
    across[2] = down * down / squares;
  }
  shorter = shorter > rules->axis_least ? shorter : rules->axis_least;
  shorter = shorter < most ? shorter : most;
  longer = longer < most ? longer : most;
  v->c[0] = shorter + (longer - shorter) * across[0];
  v->c[1] = (longer - shorter) * across[1];
  v->c[2] = shorter + (longer - shorter) * across[2];
  v->area = shorter * longer;
  return 1;
}
