/* The set-up of a Gaussian, and how far roundings may take it.
 *
 * Conic's own set-up is in double, and each result is rounded to float once. Another program's is taken to be in float
 * throughout. Its covariance may come of products in space, Σ = R·S·Sᵀ·Rᵀ and J·V·Σ·Vᵀ·Jᵀ, in whatever order. These are
 * polynomials. However one is evaluated, it errs by at most the number of a term's roundings, times the unit, times the
 * sum of its terms' absolute values. */
#include <float.h>

#include "oracle/gaussians/oracle_coverage.h"
#include "oracle/gaussians/oracle_unscented.h"

/* The roundings of any term of the covariance are some 44: quaternions 12, rotations 6, scales 2, view and Jacobian 12,
 * sums 12. A step of the set-up counts as four of them. */
static const double n_covariance_roundings = 11.0;

/* What set-up has of a Gaussian in camera space. */
typedef struct bounded_frame {
  double unit;                              /* roundoff of a step */
  bounded mean[3], world[3][3], axes[3][3]; /* world: the directions as columns; axes: with their scales */
  bounded direction[3][3];                  /* in camera space */
  double largest[3][3];                     /* of axes, with all terms of one sign */
  double scale[3];
  int is_flat;
} bounded_frame;

static bounded square_of(bounded a, double unit) {
  return bounded_multiply(a, a, unit);
}

static void bound_rotation(const double quaternion[4], int is_as_it_is, double unit, bounded r[3][3]) {
  bounded q[4], squares = bounded_of(0.0);
  for (int k = 0; k < 4; k++) {
    q[k] = bounded_of(quaternion[k]);
    squares = bounded_add(squares, square_of(q[k], unit), unit);
  }
  bounded length = bounded_root(squares, unit);
  for (int k = 0; k < 4 && !is_as_it_is; k++)
    q[k] = bounded_divide(q[k], length, unit);
  const bounded w = q[0], *v = q + 1;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    bounded along = bounded_add(square_of(v[j], unit), square_of(v[k], unit), unit);
    bounded both = bounded_multiply(v[i], v[j], unit), turned = bounded_multiply(w, v[k], unit);
    r[i][i] = bounded_subtract(bounded_of(1.0), bounded_scale(2.0, along, unit), unit);
    r[i][j] = bounded_scale(2.0, bounded_subtract(both, turned, unit), unit);
    r[j][i] = bounded_scale(2.0, bounded_add(both, turned, unit), unit);
  }
}

static int bound_axes(const oracle_doubting *d, size_t i, bounded_frame *f) {
  double q[4], squares = 0.0;
  for (int k = 0; k < 4; k++) {
    q[k] = (double)d->set->rotation[k][i];
    squares += q[k] * q[k];
  }
  if (!(squares > 0.0) || !oracle_is_finite(squares))
    return 0;
  const int as_is = d->view->rules->takes_rotation_as_is;
  bound_rotation(q, as_is > 1 || (as_is && fabs(squares - 1.0) < 0x1p-20), f->unit, f->world);
  for (int k = 0; k < 3; k++) {
    f->scale[k] = d->set->scale[k] ? (double)d->set->scale[k][i] : 0.0;
    if (!(f->scale[k] >= 0.0) || !oracle_is_finite(f->scale[k]))
      return 0;
    f->scale[k] = f->is_flat && k == 2 ? 0.0 : f->scale[k];
    for (int row = 0; row < 3; row++) {
      bounded view[3], column[3];
      f->largest[k][row] = 0.0;
      for (int j = 0; j < 3; j++) {
        view[j] = bounded_of(d->view->camera->cam_from_world[row][j]);
        column[j] = f->world[j][k];
        f->largest[k][row] += fabs(view[j].v) * f->scale[k];
      }
      f->direction[k][row] = bounded_dot(view, column, f->unit);
      f->axes[k][row] = bounded_scale(f->scale[k], f->direction[k][row], f->unit);
    }
  }
  return 1;
}

static int bound_mean(const oracle_doubting *d, size_t i, bounded_frame *f) {
  bounded mean[3];
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = bounded_rounded(bounded_of(d->set->origin[axis] + (double)d->set->position[axis][i]), f->unit);
  for (int row = 0; row < 3; row++) {
    const double *camera = d->view->camera->cam_from_world[row];
    const bounded view[3] = {bounded_of(camera[0]), bounded_of(camera[1]), bounded_of(camera[2])};
    f->mean[row] = bounded_add(bounded_dot(view, mean, f->unit), bounded_of(camera[3]), f->unit);
    for (int axis = 0; axis < 3; axis++) /* in another order */
      f->mean[row].off += f->unit * (fabs(camera[axis] * mean[axis].v) + fabs(camera[3]));
    if (!bounded_is_finite(f->mean[row]))
      return 0;
  }
  return 1;
}

/* The shortest axis, towards the eye; both signs where its side is in doubt. */
static void bound_normal(const oracle_doubting *d, const bounded_frame *f, oracle_uncertain *g) {
  int axis = 2;
  for (int k = 1; k >= 0 && !f->is_flat && d->view->rules->shape != CONIC_SHAPE_DISC; k--)
    axis = f->scale[k] < f->scale[axis] ? k : axis;
  bounded side = bounded_dot(f->direction[axis], f->mean, f->unit);
  for (int row = 0; row < 3; row++) {
    bounded n = bounded_rounded(f->world[row][axis], ORACLE_FLOAT_UNIT);
    g->normal[row] = side.v > 0.0 ? (bounded){-n.v, n.off} : n;
    if (fabs(side.v) <= side.off)
      g->normal[row].off += 2.0 * fabs(n.v);
  }
}

static bounded bounded_clamp(bounded a, double low, double high, double unit) {
  a.v = oracle_min(oracle_max(a.v, low), high);
  return (bounded){a.v, a.off + unit * 4.0 * oracle_max(fabs(low), fabs(high))};
}

/* The pixel that offsets are counted from, and the rest. A place in double may be a pixel further by its last bit. */
static void bound_offset(const oracle_doubting *d, double unit, oracle_uncertain *g) {
  const double size[2] = {d->view->camera->width, d->view->camera->height};
  for (int axis = 0; axis < 2; axis++) {
    double at = oracle_min(oracle_max(g->place[axis].v, -size[axis]), 2.0 * size[axis]);
    g->pixel[axis] = (at < 0.0 ? ceil(at) : floor(at)) + 0.5;
    g->offset[axis] = (bounded){g->pixel[axis] - g->place[axis].v, g->place[axis].off};
    double rounded = d->model->is_setup_in_float ? fabs(g->place[axis].v) + fabs(g->pixel[axis]) : 0.0;
    g->offset[axis].off += unit * rounded + ORACLE_FLOAT_UNIT * oracle_max(fabs(g->offset[axis].v), 1.0);
  }
}

/* What another program's order of forming the covariance adds: xx, xy, yy. */
static void loosen_covariance(const bounded_frame *f, const double gain[2], const double slope[2],
                              bounded covariance[3]) {
  double squares[3] = {0.0, 0.0, 0.0};
  for (int k = 0; k < 3; k++) {
    double x = gain[0] * (f->largest[k][0] + slope[0] * f->largest[k][2]);
    double y = gain[1] * (f->largest[k][1] + slope[1] * f->largest[k][2]);
    squares[0] += x * x;
    squares[1] += x * y;
    squares[2] += y * y;
  }
  for (int k = 0; k < 3; k++)
    covariance[k].off += n_covariance_roundings * f->unit * squares[k];
}

static bounded determinant_in_float(const bounded c[3], double unit) {
  return bounded_subtract(bounded_multiply(c[0], c[2], unit), bounded_multiply(c[1], c[1], unit), unit);
}

/* The rows of J·V·R·S, and their parts that another order of evaluation needs. */
static void bound_rows(const oracle_doubting *d, const bounded_frame *f, oracle_uncertain *g, bounded rows[2][3],
                       double gain[2], double size_of_slope[2]) {
  const conic_profile_row *rules = d->view->rules;
  const conic_camera *camera = d->view->camera;
  const double focal[2] = {camera->fx, camera->fy}, size[2] = {camera->width, camera->height};
  for (int axis = 0; axis < 2; axis++) {
    bounded slope = bounded_divide(f->mean[axis], f->mean[2], f->unit);
    double half = 0.5 * size[axis] / focal[axis], c = d->view->center_px[axis];
    g->place[axis] = bounded_add(bounded_scale(focal[axis], slope, f->unit), bounded_of(c), f->unit);
    if (d->model->is_setup_in_float && rules->takes_middle) /* by way of a projection, and 1/(w + 1e-7) */
      g->place[axis].off += fabs(focal[axis] * slope.v) * 1e-7 / f->mean[2].v + 4.0 * f->unit * size[axis];
    const double beyond = rules->slope_margin * half;
    if (beyond >= 0.0)
      slope = bounded_clamp(slope, -(c / focal[axis] + beyond), (size[axis] - c) / focal[axis] + beyond, f->unit);
    bounded ratio = bounded_divide(bounded_of(focal[axis]), f->mean[2], f->unit);
    for (int k = 0; k < 3; k++) {
      bounded turned = bounded_multiply(slope, f->axes[k][2], f->unit);
      rows[axis][k] = bounded_multiply(ratio, bounded_subtract(f->axes[k][axis], turned, f->unit), f->unit);
    }
    gain[axis] = fabs(ratio.v) + ratio.off;
    size_of_slope[axis] = fabs(slope.v) + slope.off;
  }
}

/* What the dilation leaves of the opacity. */
static bounded bound_compensation(const conic_profile_row *rules, bounded bare, bounded wide, double unit) {
  const double slack = rules->compensation_slack;
  bounded ratio = bounded_divide(bare, slack > 0.0 ? bounded_add(wide, bounded_of(slack), unit) : wide, unit);
  ratio.v = oracle_max(ratio.v, rules->compensation_least);
  ratio.off = oracle_min(ratio.off, 2.0); /* it is between 0 and 1 */
  if (slack > 0.0)
    ratio = bounded_add(ratio, bounded_of(slack), unit);
  bounded share = bounded_root(ratio, unit);
  if (slack > 0.0 && bare.v <= slack)
    return (bounded){0.0, bounded_high(bare) > slack ? bounded_high(share) : 0.0};
  if (slack > 0.0 && bounded_low(bare) <= slack)
    share.off = oracle_max(share.off, share.v);
  return share;
}

/* Whether a number is above a border; where that is in doubt, the Gaussian may be left out everywhere. */
static void ask_everywhere(bounded a, double border, int may_be_at, oracle_uncertain *g) {
  g->is_here &= may_be_at ? a.v >= border : a.v > border;
  if (fabs(a.v - border) <= a.off)
    g->doubts |= 1u << CONIC_DOUBT_NEAR;
}

/* u·uᵀ of the longer axis: xx, xy, yy. Others find u as (xy, λ − xx), however little is left of that difference. */
static void bound_direction(const oracle_doubting *d, const bounded c[3], bounded apart, bounded own, bounded spread,
                            bounded first, bounded across[3]) {
  const double unit = d->model->setup_roundoff;
  if (bounded_low(own) > d->view->rules->spread_least) {
    bounded x = bounded_divide(apart, own, unit), y = bounded_divide(c[1], own, unit);
    across[0] = (bounded){0.5 + 0.5 * x.v, 0.5 * x.off};
    across[1] = (bounded){0.5 * y.v, 0.5 * y.off};
    across[2] = (bounded){0.5 - 0.5 * x.v, 0.5 * x.off};
  } else {
    bounded down = bounded_subtract(spread, apart, unit), both = bounded_multiply(c[1], down, unit);
    bounded squares = bounded_add(square_of(c[1], unit), square_of(down, unit), unit);
    across[0] = bounded_divide(square_of(c[1], unit), squares, unit);
    across[1] = bounded_divide(both, squares, unit);
    across[2] = bounded_divide(square_of(down, unit), squares, unit);
  }
  const double down = spread.v - apart.v, length = sqrt(c[1].v * c[1].v + down * down);
  const double lost = d->view->rules->spread_cancels ? 2.0 * own.off : 0.0;
  const double turned = d->model->is_setup_in_float ? (8.0 * unit * bounded_high(first) + lost) / length : 0.0;
  for (int k = 0; k < 3; k++)
    across[k].off = oracle_min(across[k].off + (turned >= 0.0 ? turned : 2.0), 2.0);
}

/* The form of an ellipse whose axes have limits. Returns 0 where it is drawn nowhere. */
static int bound_limited_form(const oracle_doubting *d, const bounded c[3], bounded area, oracle_uncertain *g) {
  const conic_profile_row *rules = d->view->rules;
  const double unit = d->model->setup_roundoff, longest = conic_oracle_longest_axis(d->view), most = longest * longest;
  bounded middle = bounded_scale(0.5, bounded_add(c[0], c[2], unit), unit), across[3];
  bounded apart = bounded_scale(0.5, bounded_subtract(c[0], c[2], unit), unit);
  bounded squares = bounded_add(square_of(apart, unit), square_of(c[1], unit), unit);
  if (rules->spread_cancels && d->model->is_setup_in_float)
    squares.off += 6.0 * unit * middle.v * middle.v;
  bounded own = bounded_root(squares, unit);
  bounded spread = bounded_within(own, rules->spread_least, INFINITY), first = bounded_add(middle, spread, unit);
  bounded second = bounded_low(own) > rules->spread_least && !d->model->is_setup_in_float
                       ? bounded_divide(area, first, unit)
                       : bounded_subtract(middle, spread, unit);
  ask_everywhere(first, rules->axis_seen * rules->axis_seen, 1, g);
  if (!(rules->axis_least > 0.0))
    ask_everywhere(second, 0.0, 0, g);
  if (!g->is_here && !g->doubts)
    return 0;
  if (!d->model->is_setup_in_float && bounded_low(own) >= rules->spread_least &&
      bounded_low(second) >= rules->axis_least && bounded_high(first) <= most)
    return 1;
  bound_direction(d, c, apart, own, spread, first, across);
  first = bounded_divide(bounded_of(1.0), bounded_within(first, 0.0, most), unit);
  second = bounded_divide(bounded_of(1.0), bounded_within(second, rules->axis_least, most), unit);
  bounded difference = bounded_subtract(first, second, unit);
  for (int k = 0; k < 3; k++) {
    bounded term = bounded_multiply(difference, across[k], unit);
    g->form[k] = bounded_rounded(k == 1 ? term : bounded_add(second, term, unit), ORACLE_FLOAT_UNIT);
  }
  return 1;
}

int conic_oracle_has_radii(const conic_profile_row *rules) {
  return rules->shape == CONIC_SHAPE_DISC || rules->coverage == CONIC_COVERAGE_TILES || rules->is_beyond_stop;
}

/* As far as a Gaussian of 3.33 standard deviations reaches, or its least alpha, by a logarithm that may be fast. */
static bounded extent_in_deviations(const oracle_doubting *d, bounded opacity) {
  const double most = 3.33, ratio = opacity.v / d->limits.alpha_least, least = bounded_low(opacity);
  if (!(ratio > 1.0 && least > 0.0))
    return (bounded){0.0, bounded_high(opacity) > d->limits.alpha_least ? most : 0.0};
  double log = conic_oracle_log(ratio), unit = 8.0 * ORACLE_FLOAT_UNIT;
  bounded root = bounded_root((bounded){2.0 * log, 2.0 * (opacity.off / least + unit * (1.0 + log))}, unit);
  return root.v > most ? (bounded){most, oracle_max(most - bounded_low(root), unit * most)} : root;
}

/* Its radii, and where the rules let it be drawn, of a covariance c on the screen whose determinant is `wide`. */
static void bound_coverage(const oracle_doubting *d, const bounded c[3], bounded wide, oracle_uncertain *g) {
  const conic_profile_row *rules = d->view->rules;
  const double unit = d->model->setup_roundoff;
  if (rules->coverage == CONIC_COVERAGE_TILES) {
    bounded mean = bounded_scale(0.5, bounded_add(c[0], c[2], unit), unit);
    bounded apart = bounded_subtract(square_of(mean, unit), wide, unit);
    apart.v = oracle_max(apart.v, 0.1);
    bounded root = bounded_root(bounded_add(mean, bounded_root(apart, unit), unit), unit);
    g->radius[0] = g->radius[1] = bounded_scale(3.0, root, unit);
    conic_oracle_admit_square(d, g->radius[0], g);
  } else if (conic_oracle_has_radii(rules)) {
    const bounded extent = extent_in_deviations(d, g->opacity);
    for (int axis = 0; axis < 2; axis++)
      g->radius[axis] = bounded_multiply(extent, bounded_root(c[(size_t)axis * 2], unit), unit);
  }
  for (int axis = 0; axis < 2 && rules->clip > 0.0; axis++) {
    const double half = 0.5 * (axis ? d->view->camera->height : d->view->camera->width);
    bounded beyond = {rules->clip * half - fabs(g->place[axis].v - half), g->place[axis].off + 4.0 * unit * half};
    ask_everywhere(beyond, 0.0, 1, g);
  }
}

static int bound_ellipse(const oracle_doubting *d, const bounded_frame *f, oracle_uncertain *g) {
  const conic_profile_row *rules = d->view->rules;
  const double unit = f->unit, h = rules->dilation;
  bounded rows[2][3], area[3];
  double gain[2], slope[2];
  bound_rows(d, f, g, rows, gain, slope);
  bounded c[3] = {bounded_dot(rows[0], rows[0], unit), bounded_dot(rows[0], rows[1], unit),
                  bounded_dot(rows[1], rows[1], unit)};
  bounded_cross(rows[0], rows[1], unit, area);
  bounded bare = bounded_dot(area, area, unit), trace = bounded_add(c[0], c[2], unit);
  bounded wide = bounded_add(bounded_add(bare, bounded_scale(h, trace, unit), unit), bounded_of(h * h), unit);
  if (d->model->is_setup_in_float) {
    loosen_covariance(f, gain, slope, c);
    bare.off += determinant_in_float(c, unit).off;
  }
  c[0] = bounded_add(c[0], bounded_of(h), unit);
  c[2] = bounded_add(c[2], bounded_of(h), unit);
  if (d->model->is_setup_in_float)
    wide.off += determinant_in_float(c, unit).off;
  if (!(bounded_high(wide) > 1e-40) || !oracle_is_finite(wide.v)) /* but for underflow, it is 0 */
    return 0;
  if (rules->compensation_least >= 0.0) {
    g->opacity = bounded_multiply(g->opacity, bound_compensation(rules, bare, wide, unit), unit);
  }
  g->form[0] = bounded_rounded(bounded_divide(c[2], wide, unit), ORACLE_FLOAT_UNIT);
  g->form[1] = bounded_rounded(bounded_divide((bounded){-c[1].v, c[1].off}, wide, unit), ORACLE_FLOAT_UNIT);
  g->form[2] = bounded_rounded(bounded_divide(c[0], wide, unit), ORACLE_FLOAT_UNIT);
  bound_coverage(d, c, wide, g);
  if (conic_profile_limits_axes(rules) && !bound_limited_form(d, c, wide, g))
    return 0;
  memcpy(g->covariance, c, sizeof c);
  g->is_placed = 1;
  g->may_lack_inverse = !(bounded_low(wide) > 0.0);
  const double grown = rules->spread_least + rules->axis_least;
  const bounded variance[2] = {{c[0].v + grown, c[0].off}, {c[2].v + grown, c[2].off}};
  double q = conic_oracle_reach_in_q(d, g->opacity);
  conic_oracle_reach_of_ellipse(variance, q, g);
  bound_offset(d, unit, g);
  return q >= 0.0;
}

/* Where planes through the eye touch the ellipsoid of q: (p_a − s·p_z)² = q·Σ(A_ka − s·A_kz)², solved for s. */
static void reach_of_ellipsoid(const oracle_doubting *d, const bounded_frame *f, double q, oracle_uncertain *g) {
  const double focal[2] = {d->view->camera->fx, d->view->camera->fy}, z = f->mean[2].v;
  conic_oracle_reach_everywhere(g);
  double along = z * z;
  for (int k = 0; k < 3; k++)
    along -= q * f->axes[k][2].v * f->axes[k][2].v * (1.0 + 1e-6);
  if (!(along > 1e-6 * z * z) || !(z > 0.0))
    return;
  for (int axis = 0; axis < 2; axis++) {
    double across = f->mean[axis].v * f->mean[axis].v, mixed = f->mean[axis].v * z;
    for (int k = 0; k < 3; k++) {
      across -= q * f->axes[k][axis].v * f->axes[k][axis].v;
      mixed -= q * f->axes[k][axis].v * f->axes[k][2].v;
    }
    double root = sqrt(oracle_max(mixed * mixed - along * across, 0.0)) * (1.0 + 1e-3);
    double margin = ORACLE_REACH_MARGIN_PX + 1e-6 * focal[axis] * fabs(mixed) / along;
    g->reach[0][axis] = focal[axis] * (mixed - root) / along + d->view->center_px[axis] - margin;
    g->reach[1][axis] = focal[axis] * (mixed + root) / along + d->view->center_px[axis] + margin;
  }
}

/* The direction that a Gaussian is set up about where rays are not affine: towards its mean, as conic has it, too. */
static void aim_at(const oracle_doubting *d, const bounded_frame *f, oracle_uncertain *g) {
  const double at[3] = {f->mean[0].v, f->mean[1].v, f->mean[2].v};
  if (d->view->camera->shutter) {
    conic_oracle_aim_in_time(d->view, at, g->towards, g->from);
    return;
  }
  const int is_fisheye = d->view->camera->kind == CONIC_CAMERA_FISHEYE;
  const double length = is_fisheye ? oracle_length(at) : at[2];
  const int is_steep = !is_fisheye && (fabs(at[0]) > 1000.0 * length || fabs(at[1]) > 1000.0 * length);
  for (int axis = 0; axis < 3; axis++)
    g->towards[axis] = is_steep || !(length > 0.0) ? axis == 2 : at[axis] / length;
}

/* g, c and e of docs/reference/gaussians.md about the pixel that the Gaussian has as its own, or about its direction.
 */
static int bound_ray(const oracle_doubting *d, const bounded_frame *f, oracle_uncertain *g) {
  const conic_camera *camera = d->view->camera;
  const double unit = f->unit;
  double steps[4][3] = {
      {(g->pixel[0] - d->view->center_px[0]) / camera->fx, (g->pixel[1] - d->view->center_px[1]) / camera->fy, 1.0},
      {1.0 / camera->fx, 0.0, 0.0},
      {0.0, 1.0 / camera->fy, 0.0}};
  const int n = conic_oracle_is_bent(camera) ? 4 : 3;
  if (n == 4) {
    aim_at(d, f, g);
    memset(steps, 0, sizeof steps);
    memcpy(steps[0], g->towards, sizeof g->towards);
    steps[1][0] = steps[2][1] = steps[3][2] = 1.0;
  }
  bounded m[3], from[3];
  double longest = 0.0;
  for (int axis = 0; axis < 3; axis++)
    from[axis] = camera->shutter ? bounded_subtract(f->mean[axis], bounded_of(g->from[axis]), unit) : f->mean[axis];
  for (int k = 0; k < 3; k++) {
    bounded inverse = bounded_of(f->is_flat && k == 2 ? 1.0 : 1.0 / f->scale[k]);
    m[k] = bounded_multiply(bounded_dot(f->direction[k], from, unit), inverse, unit);
    for (int step = 0; step < n; step++) {
      bounded ray[3];
      for (int row = 0; row < 3; row++)
        ray[row] = bounded_rounded(bounded_of(steps[step][row]), unit);
      g->g[step][k] = bounded_multiply(bounded_dot(f->direction[k], ray, unit), inverse, unit);
    }
  }
  for (int step = 0; step < n; step++) {
    bounded_cross(g->g[step], m, unit, g->c[step]);
    if (f->is_flat)
      g->c[step][2] = g->g[step][0] = g->g[step][1] = bounded_of(0.0);
    g->e[step] = f->is_flat ? bounded_multiply(g->g[step][2], m[2], unit) : bounded_dot(g->g[step], m, unit);
    double length = 0.0;
    for (int k = 0; k < 3; k++)
      length += g->g[step][k].v * g->g[step][k].v;
    longest = oracle_max(longest, sqrt(length));
  }
  if (!(longest > 0.0) || !oracle_is_finite(longest))
    return 0;
  g->unit = longest;
  for (int step = 0; step < n; step++) {
    for (int k = 0; k < 3; k++) {
      g->g[step][k] = bounded_rounded(bounded_scale(1.0 / longest, g->g[step][k], unit), ORACLE_FLOAT_UNIT);
      g->c[step][k] = bounded_rounded(bounded_scale(1.0 / longest, g->c[step][k], unit), ORACLE_FLOAT_UNIT);
    }
    g->e[step] = bounded_scale(1.0 / longest, bounded_scale(1.0 / longest, g->e[step], unit), unit);
    g->e[step] = bounded_rounded(g->e[step], ORACLE_FLOAT_UNIT);
  }
  double sum = g->c[0][0].v + g->c[0][1].v + g->c[0][2].v + g->e[0].v; /* floats may overflow */
  return sum - sum == 0.0 && fabs(sum) <= FLT_MAX;
}

static int place_ray(const oracle_doubting *d, const bounded_frame *f, oracle_uncertain *g) {
  const conic_camera *camera = d->view->camera;
  const double focal[2] = {camera->fx, camera->fy};
  for (int axis = 0; axis < 2; axis++) {
    g->place[axis] = bounded_of(d->view->center_px[axis]);
    if (bounded_low(f->mean[2]) > 0.0)
      g->place[axis] =
          bounded_add(g->place[axis],
                      bounded_scale(focal[axis], bounded_divide(f->mean[axis], f->mean[2], f->unit), f->unit), f->unit);
  }
  bound_offset(d, f->unit, g);
  g->is_placed = 1;
  double q = conic_oracle_reach_in_q(d, g->opacity);
  if (conic_oracle_is_bent(camera))
    conic_oracle_reach_everywhere(g);
  else
    reach_of_ellipsoid(d, f, q, g);
  return q >= 0.0 && bound_ray(d, f, g);
}

/* Along the ray, within the box of the unscented transform. */
static int place_solid(const oracle_doubting *d, const bounded_frame *f, oracle_uncertain *g) {
  oracle_unscented u;
  for (int k = 0; k < 3; k++)
    if (!(f->scale[k] > 0x1p-23))
      return 0;
  if (!place_ray(d, f, g)) {
    g->is_placed = 0;
    return 0;
  }
  conic_oracle_unscent(d->view, f->mean, (const bounded(*)[3])f->axes, g->opacity, f->unit, &u);
  g->is_here &= u.is_seen;
  if (u.may_be_seen && !u.is_seen)
    g->doubts |= 1u << CONIC_DOUBT_NEAR;
  for (int k = 0; k < 4; k++)
    ask_everywhere(u.conditions[k], 0.0, k > 0, g);
  memcpy(g->place, u.place, sizeof g->place);
  memcpy(g->radius, u.radius, sizeof g->radius);
  if (d->view->rules->coverage == CONIC_COVERAGE_BOX)
    conic_oracle_admit_box(d, g->radius, g);
  g->is_placed = g->is_here || g->doubts;
  return g->is_placed;
}

/* The box of the outline at the profile's cutoff: its centre and half its size. */
static int bound_disc_box(const oracle_doubting *d, const bounded_frame *f, oracle_uncertain *g, bounded extent[2]) {
  const conic_profile_row *rules = d->view->rules;
  const double focal[2] = {d->view->camera->fx, d->view->camera->fy}, unit = f->unit;
  const double sign[3] = {rules->disc_cutoff * rules->disc_cutoff, rules->disc_cutoff * rules->disc_cutoff, -1.0};
  bounded weight = bounded_of(0.0);
  for (int k = 0; k < 3; k++) {
    const bounded *column = k < 2 ? f->axes[k] : f->mean;
    for (int axis = 0; axis < 2; axis++)
      g->rows[axis][k] = bounded_add(bounded_scale(focal[axis], column[axis], unit),
                                     bounded_scale(d->view->center_px[axis], column[2], unit), unit);
    g->rows[2][k] = column[2];
    weight = bounded_add(weight, bounded_scale(sign[k], square_of(g->rows[2][k], unit), unit), unit);
  }
  if (weight.v == 0.0 || !oracle_is_finite(weight.v))
    return 0;
  for (int axis = 0; axis < 2; axis++) {
    bounded place = bounded_of(0.0), square = bounded_of(0.0);
    for (int k = 0; k < 3; k++) {
      bounded both = bounded_multiply(g->rows[axis][k], g->rows[2][k], unit);
      place = bounded_add(place, bounded_scale(sign[k], both, unit), unit);
      square = bounded_add(square, bounded_scale(sign[k], square_of(g->rows[axis][k], unit), unit), unit);
    }
    g->place[axis] = bounded_divide(place, weight, unit);
    bounded apart = bounded_subtract(square_of(g->place[axis], unit), bounded_divide(square, weight, unit), unit);
    apart.v = oracle_max(apart.v, 1e-4);
    extent[axis] = bounded_root(apart, unit);
  }
  return oracle_is_finite(g->place[0].v) && oracle_is_finite(g->place[1].v);
}

static int bound_disc(const oracle_doubting *d, const bounded_frame *f, oracle_uncertain *g) {
  const conic_profile_row *rules = d->view->rules;
  bounded extent[2];
  double q = conic_oracle_reach_in_q(d, g->opacity);
  if (!bound_disc_box(d, f, g, extent))
    return 0;
  if (rules->coverage == CONIC_COVERAGE_TILES) {
    bounded radius = extent[0].v > extent[1].v ? extent[0] : extent[1];
    radius.off = oracle_max(extent[0].off, extent[1].off);
    radius.v = oracle_max(radius.v, 3.0 * 0.707106);
    g->radius[0] = g->radius[1] = radius;
    conic_oracle_admit_square(d, radius, g);
  } else {
    for (int axis = 0; axis < 2; axis++)
      g->radius[axis] = bounded_scale(rules->disc_extent, extent[axis], d->model->setup_roundoff);
    conic_oracle_admit_box(d, g->radius, g);
  }
  g->is_placed = 1;
  reach_of_ellipsoid(d, f, q, g);
  for (int axis = 0; axis < 2; axis++) { /* or the dot, whose variance is ½ px² */
    double half = sqrt(0.5 * q) + ORACLE_REACH_MARGIN_PX + g->place[axis].off;
    g->reach[0][axis] = oracle_min(g->reach[0][axis], g->place[axis].v - half);
    g->reach[1][axis] = oracle_max(g->reach[1][axis], g->place[axis].v + half);
  }
  bound_offset(d, f->unit, g);
  return q >= 0.0 && bound_ray(d, f, g);
}

/* Whether the mean is beyond near: the double run's answer, and whether it is in doubt. 0: nowhere. */
static int pass_near(const oracle_doubting *d, const bounded_frame *f, oracle_uncertain *g) {
  const conic_profile_row *rules = d->view->rules;
  const bounded z = f->mean[2];
  g->is_here = 1;
  if (rules->shape == CONIC_SHAPE_RAY)
    return 1;
  double off = z.off + f->unit * fabs(rules->near_z);
  if (rules->is_beyond_near ? z.v <= rules->near_z : z.v < rules->near_z || z.v <= 0.0)
    g->is_here = 0;
  if (fabs(z.v - rules->near_z) <= off && off > 0.0)
    g->doubts |= 1u << CONIC_DOUBT_NEAR;
  return (g->is_here || g->doubts) && bounded_high(z) > 0.0;
}

/* How much is left of opacity and colour next to the near plane: it grows with z. */
static bounded bound_fade(const conic_profile_row *rules, bounded z, double unit) {
  const double v = conic_profile_fade(rules, oracle_max(z.v, rules->near_z));
  const double low = conic_profile_fade(rules, oracle_max(bounded_low(z), rules->near_z));
  const double high = conic_profile_fade(rules, oracle_max(bounded_high(z), rules->near_z));
  const double rounded = v < 1.0 ? 8.0 * unit * (1.0 + rules->fade_z / oracle_max(z.v, rules->near_z)) : 0.0;
  return (bounded){v, oracle_max(v - low, high - v) + rounded};
}

int conic_oracle_uncertain_place(const oracle_doubting *d, size_t i, oracle_uncertain *g) {
  const conic_profile_row *rules = d->view->rules;
  bounded_frame f = {.unit = d->model->setup_roundoff};
  memset(g, 0, sizeof *g);
  g->index = (uint32_t)i;
  for (int axis = 0; axis < 2; axis++) {
    g->sure[0][axis] = g->wide[0][axis] = -INFINITY;
    g->sure[1][axis] = g->wide[1][axis] = INFINITY;
    g->radius[axis] = bounded_of(-1.0);
  }
  double opacity = (double)d->set->opacity[i];
  g->opacity = bounded_of(opacity);
  f.is_flat = !d->set->scale[2] || rules->shape == CONIC_SHAPE_DISC ||
              (rules->shape == CONIC_SHAPE_RAY && !(d->set->scale[2][i] != 0.0f));
  if (!oracle_is_finite(opacity) || !bound_mean(d, i, &f) || !bound_axes(d, i, &f) || !pass_near(d, &f, g))
    return 0;
  g->fade = bound_fade(rules, f.mean[2], f.unit);
  if (rules->fade_z > 0.0)
    g->opacity = bounded_multiply(g->opacity, g->fade, f.unit);
  if (rules->shape != CONIC_SHAPE_ELLIPSE && !(f.scale[0] > 0.0 && f.scale[1] > 0.0))
    return 0;
  int is_drawn = rules->shape == CONIC_SHAPE_ELLIPSE ? bound_ellipse(d, &f, g)
                 : rules->shape == CONIC_SHAPE_RAY   ? place_ray(d, &f, g)
                 : rules->shape == CONIC_SHAPE_SOLID ? place_solid(d, &f, g)
                                                     : bound_disc(d, &f, g);
  g->opacity = bounded_rounded(g->opacity, ORACLE_FLOAT_UNIT);
  g->z = bounded_rounded(f.mean[2], ORACLE_FLOAT_UNIT);
  g->key = rules->orders_by_distance ? bounded_root(bounded_dot(f.mean, f.mean, f.unit), f.unit) : f.mean[2];
  bound_normal(d, &f, g);
  return is_drawn;
}
