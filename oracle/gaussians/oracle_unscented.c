#include "oracle/gaussians/oracle_unscented.h"

#include "oracle/gaussians/oracle_lens.h"

enum { POINTS = 7 }; /* the mean, and one on either side of it along each axis */

/* A place on the screen. */
static void show_point(const oracle_gaussian_view *view, const bounded at[3], double unit, bounded place[2],
                       oracle_unscented *u) {
  const double size[2] = {view->camera->width, view->camera->height};
  int may_be_in, is_in = conic_oracle_lens_show(view, at, unit, place, &may_be_in);
  for (int axis = 0; axis < 2; axis++) {
    const double margin = view->rules->unscented_share * size[axis];
    is_in &= place[axis].v >= -margin && place[axis].v < size[axis] + margin;
    may_be_in &= bounded_high(place[axis]) >= -margin && bounded_low(place[axis]) < size[axis] + margin;
  }
  u->is_seen |= is_in;
  u->may_be_seen |= may_be_in;
}

/* What lies between two numbers, about one of them. */
static bounded between(double v, double low, double high) {
  return (bounded){v, oracle_max(v - low, high - v)};
}

static bounded lesser(bounded a, bounded b) {
  return between(oracle_min(a.v, b.v), oracle_min(bounded_low(a), bounded_low(b)),
                 oracle_min(bounded_high(a), bounded_high(b)));
}

static double deviations_to(double opacity, double least) {
  return opacity > least ? oracle_min(sqrt(2.0 * conic_oracle_log(oracle_min(opacity / least, 1e9))), 3.33) : 0.0;
}

/* How many standard deviations it reaches, by a logarithm that may be fast. */
static bounded find_extent(bounded seen, double least, double unit) {
  const double fast = 16.0 * unit; /* of the ratio, the logarithm of which is off by as much */
  return bounded_rounded(between(deviations_to(seen.v, least), deviations_to(bounded_low(seen) * (1.0 - fast), least),
                                 deviations_to(bounded_high(seen) * (1.0 + fast), least)),
                         unit);
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
  const bounded share = bounded_within(bounded_divide(determinants[0], determinants[1], unit), 2.5e-5, INFINITY);
  const bounded seen = bounded_multiply(opacity, bounded_root(share, unit), unit);
  const bounded mean = bounded_scale(0.5, bounded_add(v[0], v[2], unit), unit);
  const bounded apart = bounded_subtract(bounded_multiply(mean, mean, unit), determinants[1], unit);
  const bounded longest =
      bounded_root(bounded_add(mean, bounded_root(bounded_within(apart, 0.01, INFINITY), unit), unit), unit);
  const bounded extent = find_extent(seen, least, unit);
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
