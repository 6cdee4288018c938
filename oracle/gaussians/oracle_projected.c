/* What the projection makes of a Gaussian: docs/reference/judge.md, Intermediates. */
#include "oracle/gaussians/oracle_intermediates.h"

/* Those of gsplat: another box, and who is left out. */
static int is_like_gsplat(const conic_profile_row *rules) {
  return conic_oracle_has_radii(rules) && rules->coverage != CONIC_COVERAGE_TILES;
}

static oracle_range range_of(bounded a) {
  a = bounded_rounded(a, ORACLE_FLOAT_UNIT);
  return bounded_is_finite(a) ? (oracle_range){a.v, bounded_low(a), bounded_high(a)}
                              : (oracle_range){a.v, -INFINITY, INFINITY};
}

/* Tiles from a place on the screen less a radius to that place and it, as the profile rounds them. */
static void find_tiles(const oracle_doubting *d, const oracle_range *radius, bounded place, int axis,
                       oracle_range *first, oracle_range *behind) {
  const double size = axis ? d->view->camera->height : d->view->camera->width,
               tile = conic_profile_tile(d->view->rules, d->view->camera);
  const double most = ceil(size / tile);
  const int is_like_inria = d->view->rules->coverage == CONIC_COVERAGE_TILES;
  const double shift = is_like_inria ? 0.5 : 0.0, rounded = d->model->is_setup_in_float ? 2e-7 : 1e-13;
  const double ulp = rounded * (fabs(place.v) + radius->high + tile);
  const double low = bounded_low(place) - shift - ulp, high = bounded_high(place) - shift + ulp, v = place.v - shift;
  double from[3] = {v - radius->v, low - radius->high, high - radius->low};
  double to[3] = {v + radius->v, low + radius->low, high + radius->high};
  for (int k = 0; k < 3; k++) {
    to[k] = is_like_inria ? floor((to[k] + tile - 1) / tile) : ceil(to[k] / tile);
    from[k] = oracle_min(oracle_max(floor(from[k] / tile), 0.0), most);
    to[k] = oracle_min(oracle_max(to[k], 0.0), most);
  }
  *first = (oracle_range){from[0], from[1], from[2]};
  *behind = (oracle_range){to[0], to[1], to[2]};
}

/* Notes that the profile leaves it out where something holds: in double, perhaps, and for sure. */
static void leave_out_where(oracle_projected *p, int holds, int may_hold, int does_hold) {
  p->is_shown &= !holds;
  p->may_be_left_out |= may_hold;
  p->may_be_shown &= !does_hold;
}

static void look_at_picture(const oracle_doubting *d, int axis, oracle_projected *p) {
  const bounded place = p->g.place[axis];
  const oracle_range *r = &p->radius[axis];
  const double size = axis ? d->view->camera->height : d->view->camera->width;
  const double ulp = 2e-7 * (fabs(place.v) + r->high), low = bounded_low(place) - ulp, high = bounded_high(place) + ulp;
  if (is_like_gsplat(d->view->rules))
    leave_out_where(p, place.v + r->v <= 0.0 || place.v - r->v >= size, low + r->low <= 0.0 || high - r->low >= size,
                    high + r->high <= 0.0 || low - r->high >= size);
  else
    leave_out_where(p, !(p->first[axis].v < p->behind[axis].v), !(p->first[axis].high < p->behind[axis].low),
                    !(p->first[axis].low < p->behind[axis].high));
}

void conic_oracle_project(const oracle_doubting *d, size_t i, oracle_projected *p) {
  const conic_profile_row *rules = d->view->rules;
  memset(p, 0, sizeof *p);
  const int is_drawn = conic_oracle_uncertain_place(d, i, &p->g);
  oracle_uncertain *g = &p->g;
  const int has_radii = conic_oracle_has_radii(rules), is_there = has_radii ? g->is_placed : is_drawn;
  p->is_shown = is_there && g->is_here;
  p->may_be_shown = is_there;
  p->may_be_left_out = !is_there || g->may_lack_inverse || g->doubts >> CONIC_DOUBT_NEAR & 1;
  if (is_like_gsplat(rules) && rules->shape == CONIC_SHAPE_ELLIPSE) {
    const double least = d->limits.alpha_least;
    leave_out_where(p, g->opacity.v < least, bounded_low(g->opacity) < least, bounded_high(g->opacity) < least);
  }
  for (int axis = 0; axis < 2 && has_radii && is_there; axis++) {
    bounded r = g->radius[axis];
    p->radius[axis] = bounded_is_finite(r) ? (oracle_range){ceil(r.v), ceil(bounded_low(r)), ceil(bounded_high(r))}
                                           : (oracle_range){ceil(r.v), 0.0, 1e9};
    find_tiles(d, &p->radius[axis], g->place[axis], axis, &p->first[axis], &p->behind[axis]);
    look_at_picture(d, axis, p);
  }
  if (p->may_be_shown && !conic_oracle_uncertain_color(d, g))
    for (int c = 0; c < 3; c++)
      g->color[c] = (bounded){0.0, INFINITY};
}

/* --- tiles --- */

static double form_at(const oracle_uncertain *g, double x, double y) {
  const double dx = x - g->place[0].v, dy = y - g->place[1].v;
  return g->form[0].v * dx * dx + 2.0 * g->form[1].v * dx * dy + g->form[2].v * dy * dy;
}

/* Where the form is least within a rectangle: at the mean, or on one of the sides. */
static double least_in_box(const oracle_uncertain *g, const double low[2], const double high[2], double at[2]) {
  double least = INFINITY;
  for (int axis = 0; axis < 2; axis++)
    at[axis] = oracle_min(oracle_max(g->place[axis].v, low[axis]), high[axis]);
  if (at[0] == g->place[0].v && at[1] == g->place[1].v)
    return 0.0;
  for (int side = 0; side < 4; side++) {
    const int axis = side / 2, other = 1 - axis;
    double on[2];
    on[axis] = side % 2 ? high[axis] : low[axis];
    on[other] = g->place[other].v - g->form[1].v / g->form[(size_t)other * 2].v * (on[axis] - g->place[axis].v);
    on[other] = oracle_min(oracle_max(on[other], low[other]), high[other]);
    double q = form_at(g, on[0], on[1]);
    if (q < least) {
      least = q;
      memcpy(at, on, sizeof on);
    }
  }
  return least;
}

static int is_in_tiles(const oracle_projected *p, int is_wide, int x, int y) {
  const int at[2] = {x, y};
  int is_in = 1;
  for (int axis = 0; axis < 2; axis++)
    is_in &= is_wide ? at[axis] >= p->first[axis].low && at[axis] < p->behind[axis].high
                     : at[axis] >= p->first[axis].high && at[axis] < p->behind[axis].low;
  return is_in;
}

int conic_oracle_lists(const oracle_doubting *d, const oracle_projected *p, int is_by_ellipse, int x, int y) {
  const double tile = conic_profile_tile(d->view->rules, d->view->camera);
  const double low[2] = {tile * x, tile * y}, high[2] = {low[0] + tile, low[1] + tile};
  double at[2];
  if (!p->is_shown || x < p->first[0].v || x >= p->behind[0].v || y < p->first[1].v || y >= p->behind[1].v)
    return 0;
  if (!is_by_ellipse)
    return 1;
  double reach = 2.0 * conic_oracle_log(p->g.opacity.v / d->limits.alpha_least);
  return least_in_box(&p->g, low, high, at) <= oracle_min(reach, 3.33 * 3.33);
}

int conic_oracle_may_list(const oracle_projected *p, int x, int y) {
  return p->may_be_shown && is_in_tiles(p, 1, x, y);
}

int conic_oracle_has_to_list(const oracle_doubting *d, const oracle_projected *p, int x, int y) {
  const double tile = conic_profile_tile(d->view->rules, d->view->camera);
  const double low[2] = {tile * x + 0.5, tile * y + 0.5}, high[2] = {low[0] + tile - 1, low[1] + tile - 1};
  oracle_meeting meeting;
  double at[2];
  if (p->may_be_left_out || !is_in_tiles(p, 0, x, y))
    return 0;
  if (d->view->rules->shape != CONIC_SHAPE_ELLIPSE || d->view->rules->coverage == CONIC_COVERAGE_TILES)
    return 1;
  least_in_box(&p->g, low, high, at);
  conic_oracle_uncertain_meet(d, &p->g, NULL, at[0], at[1], &meeting);
  return meeting.covers && !(meeting.doubts & ~(1u << CONIC_DOUBT_MOST));
}

/* --- arrays --- */

int conic_oracle_intermediate_columns(const conic_profile_row *rules, conic_intermediate kind) {
  static const int n_columns[CONIC_N_INTERMEDIATES] = {2, 2, 1, 3, 3, 4, 1, 1, 3, 1};
  const int has_ellipse = rules->shape == CONIC_SHAPE_ELLIPSE, has_radii = conic_oracle_has_radii(rules);
  const int is_of_ellipse = kind == CONIC_INTERMEDIATE_COVARS2D || kind == CONIC_INTERMEDIATE_CONICS;
  const int is_of_radii = kind == CONIC_INTERMEDIATE_RADII || kind == CONIC_INTERMEDIATE_TILE_BOXES ||
                          kind == CONIC_INTERMEDIATE_TILES_PER_GAUSS;
  return (is_of_ellipse && !has_ellipse) || (is_of_radii && !has_radii) ? 0 : n_columns[kind];
}

static oracle_range range_of_left_out(const oracle_projected *p, oracle_range r) {
  if (!p->may_be_shown)
    return (oracle_range){0.0, 0.0, 0.0};
  return (oracle_range){p->is_shown ? r.v : 0.0, p->may_be_left_out ? 0.0 : r.low, r.high};
}

oracle_range conic_oracle_intermediate(const oracle_projected *p, conic_intermediate kind, int column) {
  const oracle_uncertain *g = &p->g;
  if (kind == CONIC_INTERMEDIATE_RADII)
    return range_of_left_out(p, p->radius[column]);
  if (kind == CONIC_INTERMEDIATE_TILE_BOXES)
    return range_of_left_out(p, column < 2 ? p->first[column] : p->behind[column - 2]);
  if (!p->may_be_shown)
    return (oracle_range){0.0, -INFINITY, INFINITY};
  oracle_range r = range_of(kind == CONIC_INTERMEDIATE_MEANS2D     ? g->place[column]
                            : kind == CONIC_INTERMEDIATE_COVARS2D  ? g->covariance[column]
                            : kind == CONIC_INTERMEDIATE_CONICS    ? g->form[column]
                            : kind == CONIC_INTERMEDIATE_OPACITIES ? g->opacity
                            : kind == CONIC_INTERMEDIATE_COLORS    ? g->color[column]
                                                                   : g->z);
  r.v = p->is_shown ? r.v : 0.0;
  return r;
}
