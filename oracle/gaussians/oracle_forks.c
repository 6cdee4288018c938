/* Front to back with bounds. What one path has is a range for each sum; each sum is rounded at each step.
 *
 * A decision in doubt (is the Gaussian composited, does compositing end before it) is followed both ways, up to
 * MOST_FORKS times on a path; where more Gaussians than that are in doubt, which no paths tell apart, up to FEW_FORKS
 * times. From then on, and where it matters too little to be worth a path, both ways are one range: the weight may be
 * nothing, and T may stay.
 *
 * An order in doubt needs no paths: exchanging two neighbours i and j leaves T, and changes a sum Σ w·v by exactly
 * T·αᵢ·αⱼ·(vᵢ − vⱼ). Any order comes of exchanging pairs, each at most once, so all of them lie within the sum of these
 * (`slack`), T being that before the first of them.
 *
 * Others may add up in any order, which errs no more than this one: of n weights, the k-th has n − k roundings by sums
 * here and two by each T before it, and any order rounds it at most n − 1 times. */

#include "oracle/gaussians/oracle_uncertain.h"

enum { MOST_FORKS = 8, FEW_FORKS = 2, N_SUMS = 8 };

/* Weight below which a decision is not followed both ways. */
static const double negligible_weight = 1e-7;

/* w times: colour, z, 1/z, normal. */
enum { SUM_RGB = 0, SUM_Z = 3, SUM_INVERSE_Z = 4, SUM_NORMAL = 5 };

typedef struct range {
  double v, low, high;
} range;

typedef struct fork_state {
  range T, ended, weight, sums[N_SUMS], median; /* ended: T where compositing may have ended */
  double group_T;                               /* the greatest T before those that may come in any order */
  double slack[N_SUMS], nearest_z, farthest_z;  /* of what is composited */
  double count[2], count_v;
  int n_forks, is_central, has_ended; /* is_central: so far as the double run decides; has_ended: that run has */
  int may_have_ended;
  size_t n_steps;
} fork_state;

typedef struct fork_job {
  const oracle_doubting *d;
  oracle_meeting *meetings;
  size_t n;
  int most_forks;
  const float *background;
  const oracle_surface *surface;
  oracle_step *steps;
  conic_gaussian_bound *bound;
} fork_job;

static range range_of(double low, double v, double high) {
  return (range){v, low, high};
}

/* Rounded to float. */
static range round_range(range a) {
  a.low -= ORACLE_FLOAT_UNIT * fabs(a.low) + ORACLE_UNDERFLOW;
  a.high += ORACLE_FLOAT_UNIT * fabs(a.high) + ORACLE_UNDERFLOW;
  return a;
}

/* Nothing times what may be infinite is nothing. */
static double end_of_product(double a, double b) {
  return a == 0.0 || b == 0.0 ? 0.0 : a * b;
}

static range multiply_ranges(range a, range b) {
  double p[4] = {end_of_product(a.low, b.low), end_of_product(a.low, b.high), end_of_product(a.high, b.low),
                 end_of_product(a.high, b.high)};
  range result = {a.v * b.v, p[0], p[0]};
  for (int k = 1; k < 4; k++) {
    result.low = oracle_min(result.low, p[k]);
    result.high = oracle_max(result.high, p[k]);
  }
  return round_range(result);
}

static range add_ranges(range a, range b) {
  return round_range((range){a.v + b.v, a.low + b.low, a.high + b.high});
}

/* The share of the light that a Gaussian leaves, by which T grows. Others may subtract α·T, rounded, from T. */
static range rest_of_light(const fork_job *j, range alpha) {
  range rest = round_range(range_of(1.0 - alpha.high, 1.0 - alpha.v, 1.0 - alpha.low));
  double product = j->d->model->is_setup_in_float ? ORACLE_FLOAT_UNIT * alpha.high : 0.0;
  rest.low -= product;
  rest.high += product;
  return rest;
}

/* The numbers that a Gaussian's weight multiplies. */
static void values_at_meeting(const oracle_meeting *m, range values[N_SUMS]) {
  const oracle_uncertain *g = m->g;
  for (int c = 0; c < 3; c++) {
    values[SUM_RGB + c] = range_of(bounded_low(g->color[c]), g->color[c].v, bounded_high(g->color[c]));
    values[SUM_NORMAL + c] = range_of(bounded_low(g->normal[c]), g->normal[c].v, bounded_high(g->normal[c]));
  }
  values[SUM_Z] = range_of(m->z[0], m->z_v, m->z[1]);
  values[SUM_INVERSE_Z] = round_range(range_of(1.0 / m->z[1], 1.0 / m->z_v, m->z[0] > 0.0 ? 1.0 / m->z[0] : INFINITY));
}

/* One id more that is admissible. */
static void admit_id(uint32_t *ids, int *n, uint32_t id) {
  for (int k = 0; k < *n && k < CONIC_MAX_BOUND_IDS; k++)
    if (ids[k] == id)
      return;
  if (*n < CONIC_MAX_BOUND_IDS)
    ids[*n] = id;
  if (*n <= CONIC_MAX_BOUND_IDS)
    ++*n;
}

/* Those that may be the heaviest of the path, and the last. */
static void admit_path(const fork_job *j, const fork_state *s) {
  conic_gaussian_bound *b = j->bound;
  double heaviest = 0.0;
  int is_sure = 0;
  for (size_t i = 0; i < s->n_steps; i++)
    if (j->steps[i].is_sure)
      heaviest = oracle_max(heaviest, j->steps[i].weight[0]);
  for (size_t i = 0; i < s->n_steps; i++)
    if (j->steps[i].weight[1] >= heaviest && j->steps[i].weight[1] > 0.0)
      admit_id(b->id, &b->n_id, j->steps[i].meeting->g->index);
  for (size_t i = j->surface ? 0 : s->n_steps; i-- > 0 && !is_sure;) {
    admit_id(b->last, &b->n_last, j->steps[i].meeting->g->index);
    is_sure = j->steps[i].is_sure && !j->steps[i].may_be_before;
  }
  if (!(heaviest > 0.0))
    admit_id(b->id, &b->n_id, CONIC_NO_ID);
  if (!j->surface && !is_sure && !(s->count[0] > 0.0))
    admit_id(b->last, &b->n_last, CONIC_NO_ID);
}

/* A pixel's range in a channel: of the path that the double run takes, or of another. */
static void admit_channel(const fork_job *j, const fork_state *s, int channel, range value, double slack) {
  conic_gaussian_bound *b = j->bound;
  if (s->is_central) {
    b->value[channel] = value.v;
    b->low[channel] = value.low;
    b->high[channel] = value.high;
  }
  b->least[channel] = oracle_min(b->least[channel], value.low - slack);
  b->most[channel] = oracle_max(b->most[channel], value.high + slack);
}

/* What Σ w·z is divided by: Σ w, or by others also 1 − T, which is off from that by all roundings on the way. */
static range divisor_of_depth(const fork_job *j, const fork_state *s, double *rounded) {
  range by = s->weight;
  *rounded = (2.0 * s->count[1] + 1.0) * ORACLE_FLOAT_UNIT;
  if (!j->d->model->is_setup_in_float)
    return by;
  range rest = round_range(range_of(1.0 - s->T.high, 1.0 - s->T.v, 1.0 - s->T.low));
  double least = oracle_max(rest.low, j->d->limits.alpha_least * (1.0 - 1e-6)); /* where anything is composited */
  *rounded += least > 0.0 ? (3.0 * s->count[1] + 2.0) * ORACLE_FLOAT_UNIT / least : INFINITY;
  return range_of(oracle_min(by.low, rest.low), by.v, oracle_max(by.high, rest.high));
}

/* Σ w·z / Σ w lies between the least and the greatest z, but for a rounding a product and two a sum. */
static range mean_depth(const fork_job *j, const fork_state *s, double slack) {
  if (!(s->count[1] > 0.0))
    return range_of(0.0, 0.0, 0.0);
  double rounded;
  const range by = divisor_of_depth(j, s, &rounded);
  range z = {s->weight.v > 0.0 ? s->sums[SUM_Z].v / s->weight.v : 0.0, oracle_max(s->nearest_z * (1.0 - rounded), 0.0),
             s->farthest_z * (1.0 + rounded)};
  if (by.low > 0.0) {
    z.low =
        oracle_max(z.low, oracle_min((s->sums[SUM_Z].low - slack) / by.high, (s->sums[SUM_Z].low - slack) / by.low));
    z.high = oracle_min(z.high, (s->sums[SUM_Z].high + slack) / by.low);
  }
  z = round_range(z);
  if (!(s->count[0] > 0.0))
    z.low = oracle_min(z.low, 0.0);
  return z;
}

/* --- a surface behind them --- */

/* Joins the z of the Gaussians, whose mean is nearer than the surface's: z + T·(that − z) grows with z and with T. */
static range join_depth(const oracle_surface *surface, range T, range z) {
  const double off = 8.0 * ORACLE_FLOAT_UNIT * surface->z;
  range joined = {z.v + T.v * (surface->z - z.v), z.low + T.low * (surface->z - z.low),
                  z.high + T.high * (surface->z - z.high)};
  if (!(T.v < 1.0))
    joined.v = surface->z;
  joined.high = oracle_max(joined.high, T.high < 1.0 ? 0.0 : surface->z);
  return range_of(joined.low - off, joined.v, joined.high + off);
}

/* All that is left of the light is the surface's. Returns the light that comes from it, by channel. */
static void join_surface(const fork_job *j, fork_state *s, range light[3], range *z, range *loose_z) {
  const oracle_surface *surface = j->surface;
  const range T = s->T;
  for (int c = 0; c < 3; c++) {
    const double color = surface->color[c], off = surface->color_off[c], n = surface->normal[c];
    light[c] = multiply_ranges(T, range_of(color - off, color, color + off));
    s->sums[SUM_NORMAL + c] = add_ranges(s->sums[SUM_NORMAL + c], multiply_ranges(T, range_of(n, n, n)));
  }
  *z = join_depth(surface, T, *z);
  *loose_z = join_depth(surface, T, *loose_z);
  const double inverse = 1.0 / surface->z;
  s->sums[SUM_INVERSE_Z] =
      add_ranges(s->sums[SUM_INVERSE_Z], multiply_ranges(T, round_range(range_of(inverse, inverse, inverse))));
  if (T.low > 0.5)
    s->median = range_of(surface->z, surface->z, surface->z);
  else if (T.high > 0.5)
    s->median = range_of(oracle_min(s->median.low, surface->z), T.v > 0.5 ? surface->z : s->median.v, surface->z);
  s->count[0] += 1.0;
  s->count[1] += 1.0;
  s->count_v += 1.0;
}

/* The surface's where more than half of the light is its own. */
static void admit_surface(const fork_job *j, const fork_state *s) {
  conic_gaussian_bound *b = j->bound;
  const double off = 2.0 * ORACLE_FLOAT_UNIT;
  admit_id(b->last, &b->n_last, j->surface->id);
  if (s->T.high > 0.5 - off)
    admit_id(b->id, &b->n_id, j->surface->id);
}

static void end_path(const fork_job *j, const fork_state *at) {
  fork_state with = *at, *s = &with;
  s->T.low = oracle_min(s->T.low, s->ended.low);
  s->T.high = oracle_max(s->T.high, s->ended.high);
  range z = mean_depth(j, s, 0.0), loose_z = mean_depth(j, s, s->slack[SUM_Z]), all_light[3];
  for (int c = 0; c < 3; c++) {
    double behind = (double)j->background[c];
    all_light[c] = multiply_ranges(s->T, range_of(behind, behind, behind));
  }
  if (j->surface)
    join_surface(j, s, all_light, &z, &loose_z);
  for (int c = 0; c < 3; c++) {
    const range light = all_light[c];
    admit_channel(j, s, CONIC_BOUND_RGB + c, add_ranges(s->sums[SUM_RGB + c], light), s->slack[SUM_RGB + c]);
    admit_channel(j, s, CONIC_BOUND_NORMAL + c, s->sums[SUM_NORMAL + c], s->slack[SUM_NORMAL + c]);
  }
  admit_channel(j, s, CONIC_BOUND_T, j->surface ? range_of(0.0, 0.0, 0.0) : s->T, 0.0);
  double slack = oracle_max(loose_z.low < z.low ? z.low - loose_z.low : 0.0, /* which may be infinite */
                            loose_z.high > z.high ? loose_z.high - z.high : 0.0);
  admit_channel(j, s, CONIC_BOUND_Z, z, slack);
  admit_channel(j, s, CONIC_BOUND_MEDIAN_Z, s->median, 0.0);
  admit_channel(j, s, CONIC_BOUND_INVERSE_Z, s->sums[SUM_INVERSE_Z], s->slack[SUM_INVERSE_Z]);
  admit_channel(j, s, CONIC_BOUND_COUNT, range_of(s->count[0], s->count_v, s->count[1]), 0.0);
  if (j->surface)
    admit_surface(j, s);
  if (!j->surface || !(s->T.low > 0.5 + 2.0 * ORACLE_FLOAT_UNIT))
    admit_path(j, s);
}

/* The Gaussian with which T comes to ½, or before which it last was above. */
static void take_median(const fork_job *j, const oracle_meeting *m, range before, range after, int is_sure, int does,
                        fork_state *s) {
  int is_late = j->d->limits.disc_near > 0.0;
  int may_be = before.high > 0.5 && (is_late || after.low <= 0.5);
  int must_be = is_sure && before.low > 0.5 && (is_late || after.high <= 0.5);
  double v = does && before.v > 0.5 && (is_late || after.v <= 0.5) ? m->z_v : s->median.v;
  if (must_be)
    s->median = range_of(m->z[0], v, m->z[1]);
  else if (may_be)
    s->median = range_of(oracle_min(s->median.low, m->z[0]), v, oracle_max(s->median.high, m->z[1]));
}

/* T after Gaussian i, and after all that may come in any order with it. */
static double least_of_group(const fork_job *j, size_t i, double T) {
  for (T *= 1.0 - j->meetings[i].alpha[1]; ++i < j->n && !j->meetings[i].is_cut;)
    T *= 1.0 - j->meetings[i].alpha[1];
  return T * (1.0 - 1e-5);
}

static int stands_alone(const fork_job *j, size_t i) {
  return j->meetings[i].is_cut && (i + 1 == j->n || j->meetings[i + 1].is_cut);
}

/* A profile that never ends may be drawn by blending, whose target holds A: what is added to it is rounded twice, and
 * the sum as a number up to 1, however little T is. */
static range keep_as_cover(const fork_job *j, range after, double alpha) {
  double off = ORACLE_FLOAT_UNIT * (1.0 + 2.0 * alpha);
  if (!j->d->model->is_setup_in_float || j->d->limits.stop > 0.0)
    return after;
  return range_of(after.low - off, after.v, oracle_min(after.high + off, 1.0));
}

/* Adds the Gaussian, where it is not sure to be there, perhaps; `does`: the double run does. */
static void composite_meeting(const fork_job *j, size_t i, int is_sure, int does, fork_state *s) {
  const oracle_meeting *m = &j->meetings[i];
  const range alpha = range_of(m->alpha[0], does ? m->alpha_v : 0.0, m->alpha[1]), before = s->T;
  range rest = rest_of_light(j, alpha);
  range weight = multiply_ranges(alpha, before), after = multiply_ranges(before, rest), values[N_SUMS];
  int counts = is_sure && !s->may_have_ended;
  after = keep_as_cover(j, after, alpha.high);
  after.low = oracle_max(after.low, 0.0);
  values_at_meeting(m, values);
  if (!is_sure)
    after.high = before.high;
  if (!counts)
    weight.low = 0.0;
  range early = before, late = after;
  if (!stands_alone(j, i)) {
    early.high = s->group_T;
    late.low = least_of_group(j, i, before.low);
  }
  take_median(j, m, early, late, counts && stands_alone(j, i), does, s);
  for (int k = 0; k < N_SUMS; k++)
    s->sums[k] = add_ranges(s->sums[k], multiply_ranges(weight, values[k]));
  s->weight = add_ranges(s->weight, weight);
  s->T = after;
  s->nearest_z = oracle_min(s->nearest_z, m->z[0]);
  s->farthest_z = oracle_max(s->farthest_z, m->z[1]);
  s->count[0] += counts;
  s->count[1] += 1.0;
  s->count_v += does;
  j->steps[s->n_steps++] = (oracle_step){m, {weight.low, weight.high}, counts, !m->is_cut};
}

/* What exchanging this one with those before it, as far as their order is in doubt, may change; called when it is the
 * last step. */
static void add_slack(const fork_job *j, size_t i, fork_state *s) {
  oracle_meeting *m = &j->meetings[i];
  oracle_step *own_step = &j->steps[s->n_steps - 1];
  range own[N_SUMS], other[N_SUMS];
  size_t first = i;
  while (first > 0 && !j->meetings[first].is_cut)
    first--;
  for (size_t k = s->n_steps - 1; k-- > 0 && j->steps[k].meeting >= &j->meetings[first];) {
    const oracle_meeting *before = j->steps[k].meeting;
    if (conic_oracle_is_before(before, m))
      continue;
    m->noted |= 1u << CONIC_DOUBT_ORDER;
    double both = s->group_T * before->alpha[1] * m->alpha[1] * (1.0 + 1e-6);
    values_at_meeting(m, own);
    values_at_meeting(before, other);
    for (int n = 0; n < N_SUMS; n++)
      s->slack[n] += both * oracle_max(own[n].high - other[n].low, other[n].high - own[n].low);
    j->steps[k].weight[0] *= 1.0 - m->alpha[1];
    own_step->weight[1] = s->group_T * m->alpha[1] * (1.0 + 1e-6);
  }
}

/* What may become of a Gaussian. */
typedef struct outcomes {
  int skips, ends, goes; /* may; */
  int skipped, ended;    /* does, in the double run */
} outcomes;

static outcomes foresee(const fork_job *j, size_t i, const fork_state *s) {
  const oracle_meeting *m = &j->meetings[i];
  const double stop = j->d->limits.stop;
  const int at = j->d->view->rules->is_beyond_stop;
  range rest = rest_of_light(j, range_of(m->alpha[0], m->alpha_v, m->alpha[1]));
  range after = multiply_ranges(s->T, rest);
  outcomes o = {.skips = (m->doubts & ~(1u << CONIC_DOUBT_MOST)) != 0, .skipped = !m->covers || s->has_ended};
  o.ends = stop > 0.0 && (after.low < stop || (at && after.low == stop));
  o.goes = !(stop > 0.0) || !(after.high < stop || (at && after.high == stop));
  o.ended = !o.skipped && stop > 0.0 && (after.v < stop || (at && after.v == stop));
  if (!stands_alone(j, i) && stop > 0.0) { /* another of those in whatever order may come here, with a greater T */
    after.high = s->group_T * (1.0 - m->alpha[0]) * (1.0 + 1e-6);
    o.goes = !(after.high < stop);
    o.ends |= least_of_group(j, i, s->T.low) <= stop;
  }
  return o;
}

/* All outcomes in one range. */
static void merge_outcomes(const fork_job *j, size_t i, outcomes o, fork_state *s) {
  if (o.ends) {
    s->ended.low = oracle_min(s->ended.low, s->T.low);
    s->ended.high = oracle_max(s->ended.high, oracle_max(s->T.high, stands_alone(j, i) ? 0.0 : s->group_T));
    s->may_have_ended = 1;
  }
  s->has_ended |= o.ended;
  if (!o.goes)
    return;
  composite_meeting(j, i, !o.skips, !o.skipped && !o.ended, s);
  add_slack(j, i, s);
}

static void follow(const fork_job *j, size_t i, fork_state s);

/* Follows each outcome but the last by itself; that one, in *s. Returns 0 where that ends, too. */
static int fork_outcomes(const fork_job *j, size_t i, outcomes o, fork_state *s) {
  s->n_forks += o.skips + o.ends + o.goes - 1;
  if (o.skips) {
    fork_state without = *s;
    without.is_central &= o.skipped;
    follow(j, i + 1, without);
  }
  if (o.ends) {
    fork_state ended = *s;
    ended.is_central &= o.ended;
    end_path(j, &ended);
  }
  s->is_central &= !o.skipped && !o.ended;
  if (!o.goes)
    return 0;
  composite_meeting(j, i, 1, 1, s);
  add_slack(j, i, s);
  return 1;
}

static void follow(const fork_job *j, size_t i, fork_state s) {
  for (; i < j->n; i++) {
    oracle_meeting *m = &j->meetings[i];
    if (m->is_cut)
      s.group_T = s.T.high;
    outcomes o = foresee(j, i, &s);
    int n = o.skips + o.ends + o.goes;
    double weight = m->alpha[1] * s.T.high;
    m->noted |= m->doubts;
    if (o.ends && (o.goes || !stands_alone(j, i)))
      m->noted |= 1u << CONIC_DOUBT_END;
    if (o.ends && n == 1 && stands_alone(j, i)) {
      s.has_ended = 1;
      break;
    }
    int is_followed = n > 1 && stands_alone(j, i) && !s.may_have_ended && s.n_forks + n - 1 <= j->most_forks &&
                      (weight > negligible_weight || o.ends);
    if (n > 1 && !is_followed && weight > negligible_weight)
      j->bound->is_wide |= s.n_forks + n - 1 > j->most_forks;
    if (!is_followed)
      merge_outcomes(j, i, o, &s);
    else if (!fork_outcomes(j, i, o, &s))
      return;
  }
  end_path(j, &s);
}

/* Where nothing before may come after anything behind. */
static void cut_groups(oracle_meeting *meetings, size_t n) {
  const oracle_meeting *latest = NULL, *earliest = NULL;
  for (size_t i = 0; i < n; i++) {
    meetings[i].latest_before = latest;
    if (!latest || meetings[i].key_high > latest->key_high ||
        (meetings[i].key_high == latest->key_high && meetings[i].g->index > latest->g->index))
      latest = &meetings[i];
  }
  for (size_t i = n; i-- > 0;) {
    if (!earliest || meetings[i].key_low < earliest->key_low ||
        (meetings[i].key_low == earliest->key_low && meetings[i].g->index < earliest->g->index))
      earliest = &meetings[i];
    meetings[i].is_cut = !meetings[i].latest_before || conic_oracle_is_before(meetings[i].latest_before, earliest);
  }
}

static int count_doubtful(const oracle_meeting *meetings, size_t n) {
  int n_doubtful = 0;
  for (size_t i = 0; i < n; i++)
    n_doubtful += (meetings[i].doubts & ~(1u << CONIC_DOUBT_MOST)) != 0 && meetings[i].alpha[1] > negligible_weight;
  return n_doubtful;
}

int conic_oracle_is_before_surface(const oracle_surface *surface, oracle_meeting *m) {
  if (m->covers && !((float)m->z_v < surface->z)) {
    m->covers = 0;
    m->part = CONIC_PART_BEHIND;
  }
  if (m->z[1] >= surface->z)
    m->doubts |= 1u << CONIC_DOUBT_SURFACE;
  return m->z[0] < surface->z;
}

/* Leaves out what is behind the surface for sure; what may be is in doubt. Returns how many are left. */
static size_t leave_hidden(const oracle_surface *surface, oracle_meeting *meetings, size_t n) {
  size_t left = 0;
  for (size_t i = 0; i < n; i++)
    if (conic_oracle_is_before_surface(surface, &meetings[i]))
      meetings[left++] = meetings[i];
  return left;
}

void conic_oracle_composite(const oracle_doubting *d, oracle_meeting *meetings, size_t n, const float background[3],
                            const oracle_surface *surface, oracle_step *steps, conic_gaussian_bound *bound) {
  n = surface ? leave_hidden(surface, meetings, n) : n;
  fork_job j = {d, meetings, n, 0, background, surface, steps, bound};
  fork_state s = {.T = {1.0, 1.0, 1.0}, .ended = {0.0, INFINITY, -INFINITY}, .is_central = 1, .nearest_z = INFINITY};
  memset(bound, 0, sizeof *bound);
  for (int c = 0; c < CONIC_N_BOUNDS; c++) {
    bound->least[c] = INFINITY;
    bound->most[c] = -INFINITY;
  }
  cut_groups(meetings, n);
  j.most_forks = count_doubtful(meetings, n) > MOST_FORKS ? FEW_FORKS : MOST_FORKS;
  follow(&j, 0, s);
  for (size_t i = 0; i < n; i++) {
    bound->kinds |= meetings[i].noted;
    for (int kind = 0; kind < CONIC_N_GAUSSIAN_DOUBTS; kind++)
      bound->doubts += meetings[i].noted >> kind & 1;
  }
}
