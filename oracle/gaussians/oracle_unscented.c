#include "oracle/gaussians/oracle_unscented.h"

enum { POINTS = 7 }; /* the mean, and one on either side of it along each axis */

/* A place on the screen; 0, 0 where it is behind the eye. */
static void show_point(const oracle_gaussian_view *view, const bounded at[3], double unit, bounded place[2],
                       oracle_unscented *u) {
  const double focal[2] = {view->camera->fx, view->camera->fy}, size[2] = {view->camera->width, view->camera->height};
  int is_in = at[2].v > 0.0, may_be_in = bounded_high(at[2]) > 0.0;
  for (int axis = 0; axis < 2; axis++) {
    const double margin = view->rules->unscented_share * size[axis];
    const bounded slope = bounded_scale(focal[axis], bounded_divide(at[axis], at[2], unit), unit);
    place[axis] = bounded_add(slope, bounded_of(view->center_px[axis]), unit);
    if (bounded_high(at[2]) <= 0.0)
      place[axis] = bounded_of(0.0);
    else if (!(at[2].v > 0.0))
      place[axis].v = 0.0;
    is_in &= place[axis].v >= -margin && place[axis].v < size[axis] + margin;
    may_be_in &= bounded_high(place[axis]) >= -margin && bounded_low(place[axis]) < size[axis] + margin;
  }
  u->is_seen |= is_in;
  u->may_be_seen |= may_be_in;
}

static bounded lesser(bounded a, bounded b) {
  return (bounded){oracle_min(a.v, b.v), oracle_max(a.off, b.off)};
}

static bounded at_least(bounded a, double least) {
  return (bounded){oracle_max(a.v, least), a.off};
}

/* The half sizes of the box from the variances, undilated and dilated. */
static void find_radii(const oracle_gaussian_view *view, const bounded bare[3], bounded opacity, double unit,
                       oracle_unscented *u) {
  const double h = view->rules->dilation, least = (double)(float)view->rules->alpha_least;
  const bounded v[3] = {bounded_add(bare[0], bounded_of(h), unit), bare[1], bounded_add(bare[2], bounded_of(h), unit)};
  bounded determinants[2];
  for (int i = 0; i < 2; i++) {
    const bounded *c = i ? v : bare;
    determinants[i] = bounded_subtract(bounded_multiply(c[0], c[2], unit), bounded_multiply(c[1], c[1], unit), unit);
  }
  const bounded share = at_least(bounded_divide(determinants[0], determinants[1], unit), 2.5e-5);
  const bounded seen = bounded_multiply(opacity, bounded_root(share, unit), unit);
  const bounded mean = bounded_scale(0.5, bounded_add(v[0], v[2], unit), unit);
  const bounded apart = bounded_subtract(bounded_multiply(mean, mean, unit), determinants[1], unit);
  const bounded longest = bounded_root(bounded_add(mean, bounded_root(at_least(apart, 0.01), unit), unit), unit);
  const double log = seen.v > least ? conic_oracle_log(seen.v / least) : 0.0;
  const double of_log = bounded_low(seen) > 0.0 ? seen.off / bounded_low(seen) + 8.0 * unit * (1.0 + log) : INFINITY;
  const bounded extent = lesser(bounded_root((bounded){2.0 * log, 2.0 * of_log}, unit), bounded_of(3.33));
  for (int axis = 0; axis < 2; axis++)
    u->radius[axis] = bounded_multiply(extent, lesser(bounded_root(v[(size_t)axis * 2], unit), longest), unit);
  u->conditions[0] = determinants[1];
  u->conditions[1] = v[0];
  u->conditions[2] = v[2];
  u->conditions[3] = bounded_subtract(seen, bounded_of(least), unit);
}

void conic_oracle_unscent(const oracle_gaussian_view *view, const bounded mean[3], const bounded axes[3][3],
                          bounded opacity, double unit, oracle_unscented *u) {
  const double *constants = view->rules->unscented, square = constants[0] * constants[0];
  const double spread = square * (3.0 + constants[2]), first = (spread - 3.0) / spread;
  const bounded step = bounded_rounded(bounded_of(sqrt(spread)), unit);
  const bounded others = bounded_rounded(bounded_of(0.5 / spread), unit);
  bounded points[POINTS][2], variances[3] = {bounded_of(0.0), bounded_of(0.0), bounded_of(0.0)};
  memset(u, 0, sizeof *u);
  for (int i = 0; i < POINTS; i++) {
    bounded at[3];
    for (int row = 0; row < 3; row++) {
      const bounded along = i ? bounded_multiply(step, axes[(i - 1) % 3][row], unit) : bounded_of(0.0);
      at[row] = i > 3 ? bounded_subtract(mean[row], along, unit) : bounded_add(mean[row], along, unit);
    }
    show_point(view, at, unit, points[i], u);
  }
  for (int axis = 0; axis < 2; axis++)
    for (int i = 0; i < POINTS; i++) {
      const bounded weight = i ? others : bounded_rounded(bounded_of(first), unit);
      u->place[axis] = bounded_add(u->place[axis], bounded_multiply(weight, points[i][axis], unit), unit);
    }
  for (int i = 0; i < POINTS; i++) {
    const bounded weight = i ? others : bounded_rounded(bounded_of(first + 1.0 - square + constants[1]), unit);
    const bounded from[2] = {bounded_subtract(points[i][0], u->place[0], unit),
                             bounded_subtract(points[i][1], u->place[1], unit)};
    for (int k = 0; k < 3; k++) {
      const bounded product = bounded_multiply(from[k == 2], from[k > 0], unit);
      variances[k] = bounded_add(variances[k], bounded_multiply(weight, product, unit), unit);
    }
  }
  find_radii(view, variances, opacity, unit, u);
}
