/* The set-up of ellipses in lanes of doubles: the operations of gaussian_setup.c, in its order. */
#pragma once

#include "core/base/vectors.h"
#include "core/lanes/lanes_double.h"
#include "gaussians/draw/gaussian_outline.h"

#define NUMBER wide
#include "gaussians/scene/harmonics_body.h"

CONIC_INLINE wide_mask wide_is_number(wide v) {
  return v - v == 0.0;
}

CONIC_INLINE wide wide_dot(const wide a[3], const wide b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

CONIC_INLINE wide wide_limited(wide value, double least, double most) {
  return wide_select(value > least, wide_min(value, wide_of(most)), wide_of(least));
}

/* conic_logarithm of normal numbers over 0. */
CONIC_INLINE wide wide_logarithm(wide v) {
  const wide_mask bits = (wide_mask)v;
  wide m = (wide)((bits & INT64_C(0xfffffffffffff)) | INT64_C(1022) << 52);
  const wide_mask is_small = m < 0.70710678118654752;
  const wide exponent =
      __builtin_convertvector(__builtin_convertvector((bits >> 52) - 1022 + is_small, wide_ints), wide);
  m = wide_select(is_small, m * 2.0, m);
  const wide t = (m - 1.0) / (m + 1.0), t_squared = t * t;
  wide sum = wide_of(0.0);
  for (int k = 23; k >= 1; k -= 2)
    sum = sum * t_squared + 1.0 / (double)k;
  return exponent * 0.69314718055994530942 + 2.0 * t * sum;
}

typedef struct wide_gaussian {
  wide mean[3], from_eye[3], unit[3][3], scale[3], opacity; /* as in conic_gaussian_placed */
  wide_mask is_good, is_drawn;
} wide_gaussian;

CONIC_INLINE void place_wide_axes(const conic_gaussian_view *view, const wide q[4], wide squares, wide_gaussian *g) {
  wide one_over = 1.0 / wide_sqrt(squares), rows[3][3];
  if (view->rules->takes_rotation_as_is)
    one_over =
        wide_select((squares - 1.0 < CONIC_UNIT_SLACK) & (1.0 - squares < CONIC_UNIT_SLACK), wide_of(1.0), one_over);
  const wide w = q[0] * one_over, x = q[1] * one_over, y = q[2] * one_over, z = q[3] * one_over;
  CONIC_ROTATION_OF(rows, w, x, y, z);
  for (int axis = 0; axis < 3; axis++)
    for (int row = 0; row < 3; row++) {
      const double *camera = view->camera->cam_from_world[row];
      g->unit[axis][row] = camera[0] * rows[0][axis] + camera[1] * rows[1][axis] + camera[2] * rows[2][axis];
    }
}

CONIC_INLINE wide_gaussian place_wide(const conic_gaussian_view *view, const conic_gaussians *set, size_t i) {
  const conic_profile_row *rules = view->rules;
  wide_gaussian g;
  wide mean[3], q[4], squares = wide_of(0.0);
  g.opacity = wide_load_floats(set->opacity + i);
  g.is_good = wide_is_number(g.opacity);
  for (int axis = 0; axis < 3; axis++) {
    mean[axis] = set->origin[axis] + wide_load_floats(set->position[axis] + i);
    g.from_eye[axis] = mean[axis] - view->eye[axis];
    g.scale[axis] = set->scale[axis] ? wide_load_floats(set->scale[axis] + i) : wide_of(0.0);
    g.is_good &= (g.scale[axis] >= 0.0) & wide_is_number(g.scale[axis]);
  }
  for (int row = 0; row < 3; row++) {
    const double *camera = view->camera->cam_from_world[row];
    g.mean[row] = camera[0] * mean[0] + camera[1] * mean[1] + camera[2] * mean[2] + camera[3];
    g.is_good &= wide_is_number(g.mean[row]);
  }
  for (int k = 0; k < 4; k++) {
    q[k] = wide_load_floats(set->rotation[k] + i);
    squares += q[k] * q[k];
  }
  g.is_good &= (squares > 0.0) & wide_is_number(squares);
  g.is_drawn =
      g.is_good & (g.mean[2] > 0.0) & (rules->is_beyond_near ? g.mean[2] > rules->near_z : g.mean[2] >= rules->near_z);
  place_wide_axes(view, q, squares, &g);
  return g;
}

CONIC_INLINE wide wide_reach(const conic_profile_row *rules, wide opacity) {
  const double least = (double)(float)rules->alpha_least;
  const wide most = wide_of(rules->greatest_half_q > 0.0 ? 2.0 * rules->greatest_half_q : (double)__builtin_inff());
  if (!(least > 0.0))
    return most;
  return wide_min(wide_keep(opacity >= least, 2.0 * wide_logarithm(opacity / least) + CONIC_REACH_SLACK), most);
}

CONIC_INLINE wide wide_compensation(const conic_profile_row *rules, wide bare, wide wider) {
  const double slack = rules->compensation_slack;
  const wide share = wide_sqrt(wide_max(bare / (wider + slack), wide_of(rules->compensation_least)) + slack);
  return slack > 0.0 ? wide_keep(bare > slack, share) : share;
}

/* The ellipse at `at`. */
CONIC_INLINE void find_wide_ellipse(const conic_gaussian_view *view, wide_gaussian *g, size_t at,
                                    conic_gaussian_ellipses *e) {
  const conic_profile_row *rules = view->rules;
  const double focal[2] = {view->camera->fx, view->camera->fy}, h = rules->dilation;
  const double size[2] = {view->camera->width, view->camera->height};
  wide rows[2][3], area[3];
  for (int axis = 0; axis < 2; axis++) {
    const double half = 0.5 * size[axis] / focal[axis], c = view->center_px[axis];
    wide slope = g->mean[axis] / g->mean[2], place = focal[axis] * slope + c;
    if (rules->slope_margin >= 0.0)
      slope = wide_limited(slope, -(c / focal[axis] + rules->slope_margin * half),
                           (size[axis] - c) / focal[axis] + rules->slope_margin * half);
    for (int k = 0; k < 3; k++)
      rows[axis][k] = focal[axis] / g->mean[2] * (g->unit[k][axis] - slope * g->unit[k][2]) * g->scale[k];
    g->is_drawn &= wide_is_number(place);
    wide_store(e->place[axis] + at, place);
  }
  for (int k = 0; k < 3; k++)
    area[k] = rows[0][(k + 1) % 3] * rows[1][(k + 2) % 3] - rows[0][(k + 2) % 3] * rows[1][(k + 1) % 3];
  const wide xx = wide_dot(rows[0], rows[0]), xy = wide_dot(rows[0], rows[1]), yy = wide_dot(rows[1], rows[1]);
  const wide bare = wide_dot(area, area), wider = bare + h * (xx + yy) + h * h, c[3] = {xx + h, xy, yy + h};
  if (rules->compensation_least >= 0.0)
    g->opacity = g->opacity * wide_compensation(rules, bare, wider);
  const wide reach = wide_reach(rules, g->opacity), mean = 0.5 * (c[0] + c[2]), apart = mean * mean - wider;
  g->is_drawn &= (wider > 0.0) & wide_is_number(wider) & (reach > 0.0);
  for (int axis = 0; axis < 2; axis++)
    wide_store(e->half[axis] + at, wide_sqrt(reach * c[2 * axis]) + CONIC_GAUSSIAN_SLACK_PX);
  if (rules->coverage == CONIC_COVERAGE_TILES)
    wide_store(e->spread + at, 3.0 * wide_sqrt(mean + wide_sqrt(wide_max(apart, wide_of(0.1)))));
  wide_store(e->form[0] + at, c[2] / wider);
  wide_store(e->form[1] + at, -c[1] / wider);
  wide_store(e->form[2] + at, c[0] / wider);
  wide_store(e->reach + at, reach);
  wide_store(e->opacity + at, g->opacity);
  wide_store(e->z + at, g->mean[2]);
  wide_store(e->key + at, rules->orders_by_distance ? wide_sqrt(wide_dot(g->mean, g->mean)) : g->mean[2]);
}

CONIC_INLINE void find_wide_harmonics(const wide from_eye[3], int degree, size_t at, conic_gaussian_ellipses *e) {
  const wide length = wide_sqrt(wide_dot(from_eye, from_eye));
  const wide_mask is_good = (length > 0.0) & wide_is_number(length);
  wide direction[3], y[CONIC_MOST_FUNCTIONS];
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = wide_keep(is_good, from_eye[axis] / length);
  evaluate_harmonics(direction, degree, y);
  for (int k = 0; k < (degree + 1) * (degree + 1); k++) {
    const wide_floats rounded = __builtin_convertvector(y[k], wide_floats);
    memcpy(e->harmonics[k] + at, &rounded, sizeof rounded);
  }
}

static void set_up_ellipses_in_lanes(const conic_gaussian_view *view, const conic_gaussians *set, size_t first,
                                     conic_gaussian_ellipses *e) {
  e->is_good = e->is_drawn = 0;
  for (size_t at = 0; at < CONIC_ELLIPSES; at += CONIC_WIDE_LANES) {
    wide_gaussian g = place_wide(view, set, first + at);
    find_wide_ellipse(view, &g, at, e);
    find_wide_harmonics(g.from_eye, set->sh_degree, at, e);
    e->is_good |= (uint64_t)wide_bits(g.is_good) << at;
    e->is_drawn |= (uint64_t)wide_bits(g.is_drawn) << at;
  }
}
