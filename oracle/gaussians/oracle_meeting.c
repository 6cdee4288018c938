/* A Gaussian at a pixel with bounds: q, z and α as floats may have them, and which of the questions that keep it out
 * are in doubt. */
#include "oracle/gaussians/oracle_uncertain.h"

/* Whether the form is positive, whatever rounding does to its terms: then q is not below 0. */
static int is_definite(const oracle_uncertain *g, double rounded) {
  double least[2], most = bounded_high((bounded){fabs(g->form[1].v), g->form[1].off}) * (1.0 + rounded);
  for (int axis = 0; axis < 2; axis++)
    least[axis] = bounded_low(g->form[(size_t)axis * 2]) * (1.0 - rounded);
  return least[0] > 0.0 && least[1] > 0.0 && least[0] * least[1] >= most * most;
}

/* q/2 of the ellipse. Whatever the order of its operations, a term is rounded so often on its way into the sum. */
static void meet_ellipse(const oracle_doubting *d, const bounded at[2], const oracle_uncertain *g, oracle_meeting *m) {
  const double rounded = d->model->n_form_roundings * ORACLE_FLOAT_UNIT;
  double sum = 0.0, off = 0.0;
  for (int k = 0; k < 3; k++) {
    bounded square = bounded_multiply(at[k == 2], at[k > 0], 0.0), term = bounded_multiply(g->form[k], square, 0.0);
    double share = k == 1 ? 1.0 : 0.5;
    sum += share * term.v;
    off += share * (term.off + rounded * (fabs(term.v) + term.off));
  }
  m->half_q_v = sum;
  m->half_q[0] = off < INFINITY ? sum - off : -INFINITY;
  m->half_q[1] = off < INFINITY ? sum + off : INFINITY;
  if (is_definite(g, rounded))
    m->half_q[0] = oracle_max(m->half_q[0], 0.0);
}

/* f₀ + Σ f_k·at_k, of n. */
static bounded affine_in(const bounded f[4], const bounded *at, int n) {
  const double unit = ORACLE_FLOAT_UNIT;
  bounded sum = f[0];
  for (int k = 0; k < n; k++)
    sum = bounded_add(sum, bounded_multiply(at[k], f[k + 1], unit), unit);
  return sum;
}

/* From the ray that the Gaussian is set up about: in pixels, or in directions, which conic takes as two floats each. */
static int find_steps(const oracle_uncertain *g, const oracle_sight *sight, const double at[2], bounded steps[3]) {
  if (!sight) {
    steps[0] = bounded_of(at[0]);
    steps[1] = bounded_of(at[1]);
    return 2;
  }
  for (int k = 0; k < 3; k++) {
    const double step = sight->direction[k] - g->towards[k];
    steps[k] = (bounded){step, sight->off + 2.0 * ORACLE_FLOAT_UNIT * fabs(step)};
  }
  return 3;
}

void conic_oracle_sight_of(const oracle_doubting *d, double x, double y, oracle_sight *sight) {
  memset(sight, 0, sizeof *sight);
  if (!conic_oracle_is_bent(d->view->camera))
    return;
  conic_oracle_lens_see(d->view, x, y, d->model->setup_roundoff, sight);
  const double split = 0x1p-47 * (1.0 + oracle_length(sight->direction));
  sight->off += d->model->is_setup_in_float ? 0.0 : split;
  if (d->view->camera->shutter)
    sight->origin_off += 0x1p-47 * (1.0 + oracle_length(sight->origin));
}

/* What of a bounded number is known where it may also be infinite. */
static void take_bounded(bounded a, double *v, double range[2]) {
  *v = a.v;
  range[0] = a.off < INFINITY ? a.v - a.off : -INFINITY;
  range[1] = a.off < INFINITY ? a.v + a.off : INFINITY;
}

/* What c and e gain where the ray begins elsewhere than the one that the Gaussian is set up about. */
static void move_origin(const oracle_uncertain *g, const oracle_sight *sight, const bounded along[3], bounded across[3],
                        bounded *e) {
  const double unit = ORACLE_FLOAT_UNIT;
  bounded moved[3], a[3], gained[3];
  for (int k = 0; k < 3; k++) {
    const double step = sight->origin[k] - g->from[k];
    moved[k] = (bounded){step, sight->origin_off + 2.0 * unit * fabs(step)};
  }
  for (int k = 0; k < 3; k++) {
    const bounded row[3] = {g->g[1][k], g->g[2][k], g->g[3][k]};
    a[k] = bounded_dot(row, moved, unit);
  }
  bounded_cross(along, a, unit, gained);
  for (int k = 0; k < 3; k++)
    across[k] = bounded_subtract(across[k],
                                 bounded_multiply(bounded_rounded(bounded_of(g->unit), unit), gained[k], unit), unit);
  *e = bounded_subtract(*e, bounded_dot(along, a, unit), unit);
}

static void meet_along_ray(const oracle_uncertain *g, const oracle_sight *sight, const double at[2],
                           oracle_meeting *m) {
  const double unit = ORACLE_FLOAT_UNIT;
  bounded along[3], across[3], steps[3], e;
  const int n = find_steps(g, sight, at, steps);
  for (int k = 0; k < 3; k++) {
    const bounded of_g[4] = {g->g[0][k], g->g[1][k], g->g[2][k], g->g[3][k]};
    const bounded of_c[4] = {g->c[0][k], g->c[1][k], g->c[2][k], g->c[3][k]};
    along[k] = affine_in(of_g, steps, n);
    across[k] = affine_in(of_c, steps, n);
  }
  e = affine_in(g->e, steps, n);
  if (sight && sight->origin_off > 0.0)
    move_origin(g, sight, along, across, &e);
  bounded squares = bounded_dot(along, along, unit), distance = bounded_dot(across, across, unit);
  bounded inverse = bounded_divide(bounded_of(1.0), squares, unit);
  take_bounded(bounded_scale(0.5, bounded_multiply(distance, inverse, unit), unit), &m->half_q_v, m->half_q);
  take_bounded(bounded_multiply(e, inverse, unit), &m->z_v, m->z);
  m->half_q[0] = oracle_max(m->half_q[0], 0.0); /* squares */
  if (!(squares.v > 0.0)) {
    m->half_q_v = -1.0;
    m->half_q[0] = -1.0;
  }
}

/* Another program's: the cross product of the pixel's two planes in the disc's own coordinates. */
static void meet_disc_in_float(const oracle_uncertain *g, double x, double y, oracle_meeting *m) {
  const double unit = ORACLE_FLOAT_UNIT;
  bounded k[3], l[3], p[3];
  for (int i = 0; i < 3; i++) {
    k[i] = bounded_subtract(bounded_scale(x, g->rows[2][i], unit), g->rows[0][i], unit);
    l[i] = bounded_subtract(bounded_scale(y, g->rows[2][i], unit), g->rows[1][i], unit);
  }
  bounded_cross(k, l, unit, p);
  bounded u = bounded_divide(p[0], p[2], unit), v = bounded_divide(p[1], p[2], unit);
  bounded q = bounded_add(bounded_multiply(u, u, unit), bounded_multiply(v, v, unit), unit);
  const bounded place[3] = {u, v, bounded_of(1.0)};
  take_bounded(bounded_scale(0.5, q, unit), &m->half_q_v, m->half_q);
  take_bounded(bounded_dot(place, g->rows[2], unit), &m->z_v, m->z);
  m->half_q[0] = oracle_max(m->half_q[0], 0.0);
}

/* The lesser of the disc's response and the dot's. */
static void take_dot(const bounded at[2], oracle_meeting *m) {
  const double unit = ORACLE_FLOAT_UNIT;
  bounded dot = bounded_add(bounded_multiply(at[0], at[0], unit), bounded_multiply(at[1], at[1], unit), unit);
  m->half_q_v = oracle_min(m->half_q_v, dot.v);
  m->half_q[0] = oracle_min(m->half_q[0], oracle_max(bounded_low(dot), 0.0));
  m->half_q[1] = oracle_min(m->half_q[1], bounded_high(dot));
}

/* Of o·e^x, where the falloff falls to zero at the border; each step of it is rounded. */
static double fall_to_zero(const oracle_limits *limits, double opacity, double alpha, double side) {
  const double end = opacity * limits->fall_end, rounded = 6.0 * ORACLE_FLOAT_UNIT * (alpha + end);
  return end > 0.0 ? (alpha - end + side * rounded) * limits->fall_factor : alpha;
}

/* o·e^x, x ≤ 0, and its product rounded. */
static void find_alpha(const oracle_doubting *d, const oracle_uncertain *g, oracle_meeting *m) {
  const conic_float_model *model = d->model;
  const double most = d->limits.alpha_most;
  double nearest = -oracle_max(m->half_q[0], 0.0), farthest = -oracle_max(m->half_q[1], 0.0);
  double off = model->exp_relative + 2.0 * ORACLE_FLOAT_UNIT, low, high;
  const double faintest = oracle_max(bounded_low(g->opacity), 0.0), strongest = bounded_high(g->opacity);
  low = faintest * conic_oracle_exp(farthest);
  high = strongest * conic_oracle_exp(nearest);
  low *= oracle_max(1.0 - (off + model->exp_by_argument * oracle_min(-farthest, 1e3)), 0.0);
  high *= 1.0 + (off + model->exp_by_argument * -nearest);
  low = fall_to_zero(&d->limits, faintest, low, -1.0);
  high = fall_to_zero(&d->limits, strongest, high, 1.0);
  const double alpha = g->opacity.v * conic_oracle_exp(-m->half_q_v);
  m->alpha_v = oracle_min(fall_to_zero(&d->limits, g->opacity.v, alpha, 0.0), most);
  if (high >= most && low < most)
    m->doubts |= 1u << CONIC_DOUBT_MOST;
  m->alpha[0] = oracle_min(low, most);
  m->alpha[1] = oracle_min(high, most);
}

/* One question that admits a Gaussian: the double run's answer, and whether floats may say yes, or no. */
static void ask_whether(oracle_meeting *m, conic_gaussian_doubt doubt, conic_gaussian_part part, int is_so, int may_be,
                        int may_not_be) {
  if (!is_so && m->covers) {
    m->covers = 0;
    m->part = part;
  }
  m->may_cover &= may_be;
  if (may_be && may_not_be)
    m->doubts |= 1u << doubt;
}

static int is_in_area(const double box[2][2], double x, double y) {
  return x >= box[0][0] && x < box[1][0] && y >= box[0][1] && y < box[1][1];
}

static void ask_all(const oracle_doubting *d, double x, double y, oracle_meeting *m) {
  const conic_profile_row *rules = d->view->rules;
  const oracle_limits *limits = &d->limits;
  const oracle_uncertain *g = m->g;
  int sure = is_in_area(g->sure, x, y), wide = is_in_area(g->wide, x, y);
  ask_whether(m, CONIC_DOUBT_NEAR, CONIC_PART_NEAR, g->is_here, 1, (g->doubts >> CONIC_DOUBT_NEAR & 1) != 0);
  ask_whether(m, CONIC_DOUBT_EDGE, CONIC_PART_OUTSIDE, sure, wide, !sure);
  if (limits->half_cutoff > 0.0)
    ask_whether(m, CONIC_DOUBT_EDGE, CONIC_PART_OUTSIDE, m->half_q_v <= limits->half_cutoff,
                m->half_q[0] <= limits->half_cutoff, m->half_q[1] > limits->half_cutoff);
  if (rules->shape == CONIC_SHAPE_RAY || rules->shape == CONIC_SHAPE_SOLID)
    ask_whether(m, CONIC_DOUBT_NEAR, CONIC_PART_NEAR, m->z_v > 0.0, m->z[1] > 0.0, !(m->z[0] > 0.0));
  if (limits->disc_near > 0.0)
    ask_whether(m, CONIC_DOUBT_NEAR, CONIC_PART_NEAR, m->z_v >= limits->disc_near, m->z[1] >= limits->disc_near,
                !(m->z[0] >= limits->disc_near));
  ask_whether(m, CONIC_DOUBT_SIGN, CONIC_PART_FAINT, m->half_q_v >= 0.0, m->half_q[1] >= 0.0, !(m->half_q[0] >= 0.0));
  ask_whether(m, CONIC_DOUBT_LEAST, CONIC_PART_FAINT, m->alpha_v >= limits->alpha_least,
              m->alpha[1] >= limits->alpha_least, !(m->alpha[0] >= limits->alpha_least));
}

/* Where it is composited, floats have seen it pass. */
static void take_what_passes(const oracle_doubting *d, oracle_meeting *m) {
  double nearest = d->limits.disc_near > 0.0 ? d->limits.disc_near : 0.0;
  m->alpha[0] = oracle_max(m->alpha[0], d->limits.alpha_least);
  m->alpha_v = oracle_max(m->alpha_v, 0.0);
  if (d->view->rules->shape == CONIC_SHAPE_RAY || nearest > 0.0)
    m->z[0] = oracle_max(m->z[0], nearest);
}

void conic_oracle_uncertain_meet(const oracle_doubting *d, const oracle_uncertain *g, const oracle_sight *sight,
                                 double x, double y, oracle_meeting *m) {
  const conic_profile_row *rules = d->view->rules;
  const double from[2] = {x - g->pixel[0], y - g->pixel[1]};
  const int is_bent = conic_oracle_is_bent(d->view->camera);
  bounded at[2];
  *m = (oracle_meeting){.g = g, .covers = 1, .may_cover = 1, .doubts = g->doubts};
  for (int axis = 0; axis < 2; axis++)
    at[axis] = bounded_add(bounded_of(from[axis]), g->offset[axis], ORACLE_FLOAT_UNIT);
  if (rules->shape == CONIC_SHAPE_ELLIPSE)
    meet_ellipse(d, at, g, m);
  else if (rules->shape == CONIC_SHAPE_DISC && d->model->is_setup_in_float)
    meet_disc_in_float(g, x, y, m);
  else
    meet_along_ray(g, is_bent ? sight : NULL, from, m);
  if (rules->shape == CONIC_SHAPE_DISC)
    take_dot(at, m);
  if (rules->shape == CONIC_SHAPE_ELLIPSE || (rules->shape == CONIC_SHAPE_DISC && !(d->limits.disc_near > 0.0)))
    take_bounded(g->z, &m->z_v, m->z);
  find_alpha(d, g, m);
  ask_all(d, x, y, m);
  if (is_bent)
    ask_whether(m, CONIC_DOUBT_NEAR, CONIC_PART_OUTSIDE, sight->is_there, sight->may_be_there,
                !(sight->off < INFINITY));
  if (rules->shape == CONIC_SHAPE_SOLID)
    take_bounded(g->z, &m->z_v, m->z);
  if (m->may_cover)
    take_what_passes(d, m);
  if (rules->shape == CONIC_SHAPE_RAY) {
    m->key = (double)(float)m->z_v;
    m->key_low = m->z[0];
    m->key_high = m->z[1];
  } else { /* both ends rounded to float, as keys are */
    m->key = (double)(float)g->key.v;
    m->key_low = (double)(float)bounded_low(g->key);
    m->key_high = (double)(float)bounded_high(g->key);
  }
}

int conic_oracle_is_before(const oracle_meeting *a, const oracle_meeting *b) {
  return a->key_high < b->key_low || (a->key_high == b->key_low && a->g->index < b->g->index);
}
