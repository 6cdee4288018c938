/* A splat at a pixel, and how far off single precision may be there. */
#include "oracle/oracle_pixel.h"

/* Segments are set up in double precision, as are rays that reach near: nothing disturbs those. Nor does a point know
 * of its axes. */
static int is_set_up_in_float(const oracle_view *view, const oracle_splat *splat) {
  if (view->floats.is_setup_in_float)
    return 1;
  switch (splat->formula) {
  case ORACLE_CONIC:
  case ORACLE_AFFINE:
  case ORACLE_LAPLACE:
  case ORACLE_DISC:
    return 1;
  case ORACLE_RAY:
    return conic_oracle_is_before_near(view, &splat->placed);
  case ORACLE_SEGMENT:
  case ORACLE_POINT:
  case ORACLE_NOT_DRAWN:
    break;
  }
  return 0;
}

void conic_oracle_candidate(const oracle_view *view, const oracle_splat *splat, oracle_candidate *candidate) {
  candidate->splat = splat;
  candidate->is_drawn =
      splat->formula != ORACLE_NOT_DRAWN && conic_oracle_shape(view, &splat->placed, splat->formula, &candidate->shape);
  candidate->n_disturbed = is_set_up_in_float(view, splat) ? conic_oracle_n_inputs(view) : 0;
  for (int i = 0; i < candidate->n_disturbed; i++) {
    oracle_placed moved = conic_oracle_disturb(view, &splat->placed, i);
    candidate->is_disturbed[i] =
        candidate->is_drawn && conic_oracle_shape(view, &moved, splat->formula, &candidate->disturbed[i]);
    if (candidate->is_disturbed[i] && candidate->shape.change < INFINITY)
      candidate->shape.change_error += fabs(candidate->disturbed[i].change - candidate->shape.change);
  }
}

/* What the inputs' rounding and the evaluation's own may add up to: every disturbed splat the worst way at once. For
 * the weight also `spread`, what they come to where they are independent. */
static void find_fragment_errors(const oracle_view *view, const oracle_candidate *candidate, double x, double y,
                                 const double values[ORACLE_N_VALUES], double errors[ORACLE_N_VALUES], double *spread) {
  conic_oracle_rounding(view, &candidate->shape, x, y, values, errors);
  double squares = errors[ORACLE_WEIGHT] * errors[ORACLE_WEIGHT];
  for (int i = 0; i < candidate->n_disturbed; i++) {
    double disturbed[ORACLE_N_VALUES];
    if (candidate->is_disturbed[i])
      conic_oracle_evaluate(view, &candidate->disturbed[i], x, y, disturbed);
    for (int j = 0; j < ORACLE_N_VALUES; j++)
      errors[j] += candidate->is_disturbed[i] ? fabs(disturbed[j] - values[j]) : INFINITY;
    double step = candidate->is_disturbed[i] ? disturbed[ORACLE_WEIGHT] - values[ORACLE_WEIGHT] : INFINITY;
    squares += step * step;
  }
  *spread = sqrt(squares);
  for (int j = 0; j < ORACLE_N_VALUES; j++)
    if (!oracle_is_finite(errors[j]))
      errors[j] = INFINITY;
}

/* Whether a margin may be positive, or fail to be. */
static unsigned doubt_coverage(const double values[ORACLE_N_VALUES], const double errors[ORACLE_N_VALUES]) {
  unsigned doubt = 0;
  for (int i = 0; i < ORACLE_N_MARGINS; i++) {
    if (values[i] < -errors[i])
      return 0; /* surely not covered, whatever the others say */
    if (!(values[i] > errors[i]))
      doubt |= 1u << (i == ORACLE_MARGIN_Q ? CONIC_UNSTABLE_CUTOFF : CONIC_UNSTABLE_CLIP);
  }
  return doubt;
}

static oracle_interval around(double value, double error) {
  return (oracle_interval){value - error, value, value + error};
}

/* What lies ε behind iz on the ray, as wide splats have it: others have one factor for all of their pixels. */
static double behind_here(const oracle_splat *splat, double iz, double ray_length) {
  double before_eye = oracle_max(iz, 0.0);
  return before_eye / (1.0 + splat->epsilon * before_eye / ray_length);
}

/* The lesser of both depths, moved back. */
static oracle_interval find_hiding(const oracle_splat *splat, const oracle_shape *shape, oracle_interval iz,
                                   double ray_length, double slack) {
  const double excess = shape->change - ORACLE_NARROW_CHANGE;
  oracle_interval all = {splat->behind * iz.low, splat->behind * iz.value, splat->behind * iz.high};
  oracle_interval here = {behind_here(splat, iz.low, ray_length), behind_here(splat, iz.value, ray_length),
                          behind_here(splat, iz.high, ray_length)};
  oracle_interval hides = excess > 0.0 ? here : all;
  if (!(fabs(excess) > shape->change_error)) {
    hides.low = oracle_min(here.low, all.low);
    hides.high = oracle_max(here.high, all.high);
  }
  hides.low *= 1.0 - slack;
  hides.high *= 1.0 + slack;
  return hides;
}

/* The greater of both depths is what a splat is seen by, the lesser, moved back, what it hides by. */
static void set_depths(const oracle_splat *splat, const oracle_shape *shape, const double values[ORACLE_N_VALUES],
                       const double errors[ORACLE_N_VALUES], double slack, oracle_fragment *fragment) {
  oracle_interval iz = around(values[ORACLE_IZ], errors[ORACLE_IZ]);
  oracle_interval plane = around(values[ORACLE_IZ_PLANE], errors[ORACLE_IZ_PLANE]);
  iz.low = oracle_max(iz.low, shape->range[0] * (1.0 - slack));
  iz.high = oracle_min(iz.high, shape->range[1] * (1.0 + slack));
  fragment->seen.low = oracle_max(iz.low, plane.low);
  fragment->seen.value = oracle_max(iz.value, plane.value);
  fragment->seen.high = oracle_max(iz.high, plane.high);
  const oracle_interval lesser = {oracle_min(iz.low, plane.low), oracle_min(iz.value, plane.value),
                                  oracle_min(iz.high, plane.high)};
  fragment->hides = find_hiding(splat, shape, lesser, values[ORACLE_RAY_LENGTH], slack);
  fragment->iz = iz.value;
  fragment->iz_error = oracle_max(iz.value - iz.low, iz.high - iz.value);
  double clamped = oracle_min(oracle_max(plane.value, shape->range[0]), shape->range[1]);
  double low = oracle_min(oracle_max(plane.low, shape->range[0]), shape->range[1]);
  double high = oracle_min(oracle_max(plane.high, shape->range[0]), shape->range[1]);
  fragment->z = 1.0 / clamped;
  fragment->z_error = oracle_max(1.0 / low - fragment->z, fragment->z - 1.0 / high) + slack * fragment->z;
}

static void set_weight(const oracle_splat *splat, double weight, double error, double spread,
                       oracle_fragment *fragment) {
  const double floor_weight = 0x1p-60;
  fragment->weight = oracle_max(weight * splat->opacity, floor_weight);
  fragment->weight_error = error * fabs(splat->opacity);
  fragment->weight_spread = spread * fabs(splat->opacity);
}

/* What weight, iz and z may be of the formula itself. No splat weighs four times its opacity. */
static void set_ranges(const oracle_splat *splat, const oracle_shape *shape, double slack, oracle_fragment *f) {
  const double floor_weight = 0x1p-60;
  double most = oracle_max(4.0 * splat->opacity, floor_weight);
  f->weights = around(f->weight, f->weight_error);
  f->weights.low = oracle_min(oracle_max(f->weights.low, floor_weight), most);
  f->weights.high = oracle_min(oracle_max(f->weights.high, floor_weight), most);
  f->nearness = around(f->iz, f->iz_error);
  f->depths = around(f->z, f->z_error);
  f->depths.low = oracle_max(f->depths.low, (1.0 - slack) / shape->range[1]);
  f->depths.high = oracle_min(f->depths.high, (1.0 + slack) / shape->range[0]);
}

static void include(oracle_interval *range, const oracle_interval *other) {
  range->low = oracle_min(range->low, other->low);
  range->high = oracle_max(range->high, other->high);
}

/* The splat at the pixel by its own formula; 0 where it surely does not cover. */
static int look_at_formula(const oracle_view *view, const oracle_candidate *candidate, double x, double y,
                           oracle_fragment *fragment) {
  double errors[ORACLE_N_VALUES], spread = 0.0;
  fragment->covers = 0;
  fragment->doubt = 0;
  if (!candidate->is_drawn)
    return 0;
  conic_oracle_evaluate(view, &candidate->shape, x, y, fragment->values);
  /* Twice the cutoff's square away nothing is in doubt. */
  if (!(fragment->values[ORACLE_MARGIN_Q] > -view->support))
    return 0;
  fragment->covers = conic_oracle_covers(fragment->values);
  find_fragment_errors(view, candidate, x, y, fragment->values, errors, &spread);
  fragment->doubt = doubt_coverage(fragment->values, errors);
  if (!fragment->covers && !fragment->doubt)
    return 0;
  fragment->may_miss = fragment->doubt != 0;
  /* A range in depth is that of the disc, which is off by what its centre is. */
  const double slack =
      view->floats.unit + candidate->splat->placed.p_error[2] / oracle_max(fabs(candidate->splat->placed.p[2]), 1e-300);
  set_depths(candidate->splat, &candidate->shape, fragment->values, errors, slack, fragment);
  set_weight(candidate->splat, fragment->values[ORACLE_WEIGHT], errors[ORACLE_WEIGHT], spread, fragment);
  set_ranges(candidate->splat, &candidate->shape, slack, fragment);
  return 1;
}

/* What other formulas would make of the pixel: if one covers it, the splat's coverage, weight and depth are in doubt.
 * Returns whether one may. */
static int doubt_formula(const oracle_view *view, const oracle_candidate *candidate, double x, double y, int may_cover,
                         oracle_fragment *fragment) {
  int may_other = 0, may_miss = !may_cover;
  for (int i = 0; i < candidate->splat->n_others; i++) {
    oracle_splat as_other = *candidate->splat;
    oracle_candidate set_up;
    oracle_fragment other;
    as_other.formula = as_other.others[i];
    conic_oracle_candidate(view, &as_other, &set_up);
    if (!look_at_formula(view, &set_up, x, y, &other)) {
      may_miss = 1;
      continue;
    }
    may_miss |= other.may_miss;
    may_other = 1;
    if (!may_cover) {
      *fragment = other;
      fragment->covers = 0; /* of its own formula */
      may_cover = 1;
      continue;
    }
    include(&fragment->seen, &other.seen);
    include(&fragment->hides, &other.hides);
    include(&fragment->weights, &other.weights);
    include(&fragment->nearness, &other.nearness);
    include(&fragment->depths, &other.depths);
  }
  if (may_other)
    fragment->may_miss |= may_miss;
  return may_other;
}

int conic_oracle_fragment(const oracle_view *view, const oracle_candidate *candidate, double x, double y,
                          oracle_fragment *fragment) {
  const oracle_splat *splat = candidate->splat;
  double clip_error, reach_px = (splat->box[1][0] - splat->box[0][0]) + (splat->box[1][1] - splat->box[0][1]);
  if (!splat->is_anywhere &&
      (x < splat->box[0][0] || x > splat->box[1][0] || y < splat->box[0][1] || y > splat->box[1][1]))
    return 0;
  double kept = conic_oracle_clip_margin(&splat->clip, x, y, reach_px, &clip_error);
  if (kept < -clip_error)
    return 0;
  int may_cover = look_at_formula(view, candidate, x, y, fragment);
  unsigned doubt = fragment->doubt;
  if (splat->n_others) {
    int may_other = doubt_formula(view, candidate, x, y, may_cover, fragment);
    if (may_other || fragment->covers)
      doubt |= 1u << CONIC_UNSTABLE_FORMULA;
    if (!may_other) /* drawn by this formula or not at all */
      fragment->may_miss = 1;
    may_cover |= may_other;
  }
  if (may_cover && !(kept > clip_error)) {
    doubt |= 1u << CONIC_UNSTABLE_CLIP;
    fragment->may_miss = 1;
  }
  fragment->covers = fragment->covers && kept >= 0.0;
  fragment->doubt = doubt;
  fragment->candidate = candidate;
  fragment->is_visible = 0;
  return may_cover;
}
