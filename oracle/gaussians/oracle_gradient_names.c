/* Which mistake a wrong gradient looks like. Each reading says what the numbers would be if its author had made it. A
 * reading is a name only where it rights nine of ten wrong Gaussians and spoils none of the right ones. */
#include "oracle/gaussians/oracle_gradient_job.h"

enum {
  MEAN = 1 << CONIC_GRADIENT_MEAN,
  SCALE = 1 << CONIC_GRADIENT_SCALE,
  ROTATION = 1 << CONIC_GRADIENT_ROTATION,
  OPACITY = 1 << CONIC_GRADIENT_OPACITY,
  SH = 1 << CONIC_GRADIENT_SH,
  PLACE = 1 << CONIC_GRADIENT_PLACE,
  ALL = (1 << CONIC_N_GRADIENT_KINDS) - 1
};

/* So much of a difference may be left, and a right number is spoilt by so many of its bounds. */
static const double most_left = 0.01, n_bounds_spoil = 3.0;

/* A Gaussian's right numbers, and what they are made of. */
typedef struct named_gaussian {
  const oracle_gradient_job *j;
  const conic_gaussian_gradient *drawn; /* with the reading; null for those that need none */
  size_t i, n;
  double found[ORACLE_MOST_NUMBERS], right[ORACLE_MOST_NUMBERS], other[ORACLE_MOST_NUMBERS];
  double room[ORACLE_MOST_NUMBERS], slack[ORACLE_MOST_NUMBERS];
  double parts[N_BY_ELLIPSE][ORACLE_MOST_NUMBERS]; /* by what is summed up over pixels */
  double turn[4], length;
  int is_open;
} named_gaussian;

typedef struct gradient_reading gradient_reading;
struct gradient_reading { /* NOLINT(clang-analyzer-optin.performance.Padding): in the order of the table */
  const char *name;
  unsigned kinds;
  double (*number)(const named_gaussian *g, const gradient_reading *r, size_t at);
  double factor;
  int first, last; /* sums */
  int is_whole;    /* what it spoils of one kind speaks against it in each */
};

static double multiplied(const named_gaussian *g, const gradient_reading *r, size_t at) {
  return r->factor * g->right[at];
}

static double with_sums_multiplied(const named_gaussian *g, const gradient_reading *r, size_t at) {
  double number = g->right[at];
  for (int k = r->first; k <= r->last; k++)
    number += (r->factor - 1.0) * g->parts[k][at];
  return number;
}

/* By the stored value in place of the activated one, and the other way round. */
static double by_other_value(const named_gaussian *g, const gradient_reading *r, size_t at) {
  const conic_gaussians *set = g->j->set;
  const double o = (double)set->opacity[g->i];
  const double slope = r->kinds == OPACITY ? o * (1.0 - o) : (double)set->scale[at - 3][g->i];
  return g->j->gradient->is_raw ? g->right[at] / slope : g->right[at] * slope;
}

static double by_free_quaternion(const named_gaussian *g, const gradient_reading *r, size_t at) {
  return g->turn[conic_oracle_place_in_kind(at)] / (r->factor == 0.0 ? g->length : 1.0);
}

static double by_unit_quaternion(const named_gaussian *g, const gradient_reading *r, size_t at) {
  return g->right[at] * (r->kinds ? g->length : 1.0);
}

static double with_w_last(const named_gaussian *g, const gradient_reading *r, size_t at) {
  const size_t k = conic_oracle_place_in_kind(at);
  return g->right[at - k + (k + (size_t)r->first) % 4];
}

static double with_channels_swapped(const named_gaussian *g, const gradient_reading *r, size_t at) {
  const size_t k = conic_oracle_place_in_kind(at), c = k % 3;
  return g->right[at - c + (size_t)r->last - c];
}

static double in_camera_space(const named_gaussian *g, const gradient_reading *r, size_t at) {
  return oracle_dot(g->j->view.camera->cam_from_world[at], g->right) * r->factor;
}

static double without_sign(const named_gaussian *g, const gradient_reading *r, size_t at) {
  return g->j->judging->totals[g->i].size[BY_PLACE + conic_oracle_place_in_kind(at)] * r->factor;
}

/* From −1 to 1 across the picture. */
static double by_picture(const named_gaussian *g, const gradient_reading *r, size_t at) {
  const conic_camera *camera = g->j->view.camera;
  return g->right[at] * r->factor * (conic_oracle_place_in_kind(at) ? camera->height : camera->width);
}

static double as_drawn(const named_gaussian *g, const gradient_reading *r, size_t at) {
  return conic_oracle_number_in(g->drawn, g->i, at) * r->factor;
}

static const gradient_reading readings[] = {
    {"zero", ALL, multiplied, .factor = 0.0},
    {"sign", ALL, multiplied, .factor = -1.0},
    {"twice", ALL, multiplied, .factor = 2.0},
    {"half", ALL, multiplied, .factor = 0.5},
    {"scale-log", SCALE, by_other_value},
    {"opacity-logit", OPACITY, by_other_value},
    {"quaternion-not-normalised", ROTATION, by_free_quaternion, .factor = 1.0},
    {"quaternion-not-normalised", ROTATION, by_free_quaternion, .factor = 0.0},
    {"quaternion-length", ROTATION, by_unit_quaternion},
    {"quaternion-xyzw", ROTATION, with_w_last, .first = 1},
    {"sh-direction", MEAN, with_sums_multiplied, 0.0, BY_COLOR, BY_COLOR + 2},
    {"jacobian", MEAN, with_sums_multiplied, 0.0, BY_FORM, BY_FORM + 2},
    {"place", MEAN, with_sums_multiplied, 0.0, BY_PLACE, BY_PLACE + 1},
    {"depth", MEAN, with_sums_multiplied, 0.0, BY_Z, BY_Z},
    {"compensation", MEAN | SCALE | ROTATION, with_sums_multiplied, 0.0, BY_OPACITY, BY_OPACITY, 1},
    {"conic-cross-half", MEAN | SCALE | ROTATION, with_sums_multiplied, 0.5, BY_FORM + 1, BY_FORM + 1, 1},
    {"conic-cross-twice", MEAN | SCALE | ROTATION, with_sums_multiplied, 2.0, BY_FORM + 1, BY_FORM + 1, 1},
    {"camera-space", MEAN, in_camera_space, .factor = 1.0},
    {"bgr", SH, with_channels_swapped, .last = 2},
    {"absgrad", PLACE, without_sign, .factor = 1.0},
    {"place-ndc", PLACE, by_picture, .factor = 0.5},
};

/* Those whose sums over pixels are others. */
static const gradient_reading drawn_readings[] = {
    {"stop-ignored", ALL, as_drawn, 1.0, .is_whole = 1},  {"background-ignored", ALL, as_drawn, 1.0, .is_whole = 1},
    {"alpha-ignored", ALL, as_drawn, 1.0, .is_whole = 1}, {"depth-ignored", ALL, as_drawn, 1.0, .is_whole = 1},
    {"clamp-passed", ALL, as_drawn, 1.0, .is_whole = 1},
};

enum { N_READINGS = sizeof readings / sizeof *readings, N_DRAWN = sizeof drawn_readings / sizeof *drawn_readings };

typedef struct reading_count {
  size_t righted, spoilt;
  double left; /* the sum of the shares of wrong Gaussians' differences that are left */
} reading_count;

typedef reading_count reading_counts[N_READINGS][CONIC_N_GRADIENT_KINDS];

typedef struct naming_job {
  const oracle_gradient_job *j;
  const conic_gaussian_gradient *theirs, *drawn;
  const gradient_reading *readings;
  size_t n_readings;
  reading_counts *runs;
} naming_job;

/* --- one Gaussian --- */

static void take_gaussian(const naming_job *job, size_t i, named_gaussian *g) {
  const oracle_gradient_job *j = job->j;
  oracle_camera_gradient camera = {.focal = {0.0}};
  oracle_parameters p;
  double q[4];
  g->j = j;
  g->i = i;
  g->n = ORACLE_FIXED_NUMBERS + 3 * (size_t)(j->set->sh_degree + 1) * (size_t)(j->set->sh_degree + 1);
  g->drawn = job->drawn;
  g->is_open = conic_oracle_is_open(j, i);
  conic_oracle_bound_numbers(j, i, g->n, g->room, g->slack);
  for (size_t at = 0; at < g->n; at++) {
    const double factor = conic_oracle_raw_factor(j, i, at);
    g->found[at] = conic_oracle_number_in(job->theirs, i, at);
    g->right[at] = conic_oracle_number_in(j->gradient, i, at);
    g->room[at] *= factor;
    g->slack[at] *= factor;
  }
  memset(g->parts, 0, sizeof g->parts);
  memset(g->turn, 0, sizeof g->turn);
  g->length = conic_oracle_quaternion(j->view.rules, j->set, i, q);
  if (!j->is_shown[i] || g->drawn)
    return;
  for (int k = 0; k < N_BY_ELLIPSE; k++) {
    double one[N_BY_SCREEN] = {0.0};
    one[k] = j->totals[i][k];
    conic_oracle_gradient_chain(&j->view, &j->eye, j->set, i, NULL, NULL, one, &p, &camera);
    for (size_t at = 0; at < g->n; at++)
      g->parts[k][at] = conic_oracle_number_of(&p, one, at) * conic_oracle_raw_factor(j, i, at);
    for (int axis = 0; axis < 4; axis++)
      g->turn[axis] += p.turn[axis];
  }
}

static void try_reading(named_gaussian *g, const gradient_reading *r, conic_gradient_kind kind, int is_wrong,
                        reading_count *count) {
  double before = 0.0, after = 0.0, size = 0.0, other = 0.0;
  int fits = 1, spoils = 0;
  for (size_t at = 0; at < g->n; at++) {
    if (conic_oracle_number_kind(at) != kind || (kind == CONIC_GRADIENT_SCALE && !g->j->set->scale[at - 3]))
      continue;
    g->other[at] = r->number(g, r, at);
    size += fabs(g->right[at]);
    other += fabs(g->other[at]);
  }
  const double larger = size > 0.0 ? oracle_max(1.0, other / size) : 1.0;
  for (size_t at = 0; at < g->n; at++) {
    if (conic_oracle_number_kind(at) != kind || (kind == CONIC_GRADIENT_SCALE && !g->j->set->scale[at - 3]))
      continue;
    const double was = fabs(g->found[at] - g->right[at]), is = fabs(g->found[at] - g->other[at]);
    const double room = larger * g->room[at] + 1e-37;
    fits &= is <= most_left * was + room;
    spoils |= !(is <= n_bounds_spoil * room + larger * g->slack[at]) && !(is <= was);
    before += was;
    after += is;
  }
  if (!is_wrong)
    count->spoilt += (size_t)(spoils && !g->is_open);
  else {
    count->righted += (size_t)fits;
    count->left += before > 0.0 && oracle_is_finite(before) ? oracle_min(after / before, 1.0) : 1.0;
  }
}

static void try_run_of_gaussians(void *data, size_t i_run) {
  const naming_job *job = data;
  named_gaussian g;
  for (size_t i = i_run * ORACLE_GRADIENT_RUN; i < (i_run + 1) * ORACLE_GRADIENT_RUN && i < job->j->set->count; i++) {
    take_gaussian(job, i, &g);
    for (size_t r = 0; r < job->n_readings; r++)
      for (int kind = 0; kind < CONIC_N_GRADIENT_KINDS; kind++)
        if (job->readings[r].kinds >> kind & 1 && !(job->theirs->lacks >> kind & 1))
          try_reading(&g, &job->readings[r], (conic_gradient_kind)kind, job->j->wrong_kinds[i] >> kind & 1,
                      &job->runs[i_run][r][kind]);
  }
}

/* --- all of them --- */

/* Takes over what explains a kind better than what stands there. */
static void consider_reading(const char *name, const reading_count *count, size_t wrong, double *left,
                             conic_gradient_mistake *best) {
  conic_gradient_mistake own = {name, count->righted, count->spoilt, 0};
  own.is_named = 10 * own.righted >= 9 * wrong && own.spoilt == 0;
  if (2 * own.righted < wrong || own.is_named < best->is_named)
    return;
  if (best->name && own.is_named == best->is_named &&
      (own.righted < best->righted || (own.righted == best->righted && !(count->left < *left))))
    return;
  *best = own;
  *left = count->left;
}

static conic_status try_readings(naming_job *job, double *left, conic_gradient_verdict *v) {
  const size_t n_runs = (job->j->set->count + ORACLE_GRADIENT_RUN - 1) / ORACLE_GRADIENT_RUN;
  job->runs = conic_memory_allocate_zeroed(job->j->context, n_runs, sizeof *job->runs);
  if (!job->runs)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(job->j->context, n_runs, try_run_of_gaussians, job);
  for (size_t r = 0; r < job->n_readings; r++) {
    reading_count counts[CONIC_N_GRADIENT_KINDS] = {{0}};
    size_t spoilt = 0;
    for (int kind = 0; kind < CONIC_N_GRADIENT_KINDS; kind++) {
      for (size_t run = 0; run < n_runs; run++) {
        counts[kind].righted += job->runs[run][r][kind].righted;
        counts[kind].spoilt += job->runs[run][r][kind].spoilt;
        counts[kind].left += job->runs[run][r][kind].left;
      }
      spoilt += counts[kind].spoilt;
    }
    for (int kind = 0; kind < CONIC_N_GRADIENT_KINDS; kind++) {
      counts[kind].spoilt = job->readings[r].is_whole ? spoilt : counts[kind].spoilt;
      if (v->wrong[kind] && counts[kind].righted)
        consider_reading(job->readings[r].name, &counts[kind], v->wrong[kind], &left[kind], &v->mistakes[kind]);
    }
  }
  conic_memory_release(job->j->context, job->runs);
  return CONIC_OK;
}

/* The gradient as it is where an author forgot something that the pixels need. */
static conic_status draw_reading(naming_job *job, size_t which, double *left, conic_gradient_verdict *v) {
  static const float black[3] = {0.0f, 0.0f, 0.0f};
  const oracle_gradient_job *right = job->j;
  conic_profile_row rules = *right->view.rules;
  conic_gaussian_weights weights = *right->weights;
  conic_gaussian_gradient drawn;
  oracle_gradient_job j = {.context = right->context,
                           .set = right->set,
                           .weights = &weights,
                           .background = which == 1 ? black : right->background,
                           .view = right->view,
                           .eye = right->eye,
                           .gradient = &drawn,
                           .passes_most = which == 4};
  j.view.rules = &rules;
  rules.stop = which == 0 ? 0.0 : rules.stop;
  weights.alpha = which == 2 ? NULL : weights.alpha;
  weights.z = which == 3 ? NULL : weights.z;
  conic_status status =
      conic_oracle_gradient_room(j.context, j.set->count, j.set->sh_degree, j.set->scale[2] != NULL, &drawn);
  if (status != CONIC_OK)
    return status;
  drawn.is_raw = right->gradient->is_raw;
  status = conic_oracle_differentiate(&j);
  if (status == CONIC_OK)
    status = conic_oracle_gradient_chain_all(&j);
  job->drawn = &drawn;
  job->readings = &drawn_readings[which];
  job->n_readings = 1;
  if (status == CONIC_OK)
    status = try_readings(job, left, v);
  conic_oracle_gradient_end(&j);
  conic_gaussian_gradient_release(j.context, &drawn);
  return status;
}

conic_status conic_oracle_name_mistakes(const oracle_gradient_job *j, const conic_gaussian_gradient *theirs,
                                        conic_gradient_verdict *v) {
  naming_job job = {.j = j, .theirs = theirs, .readings = readings, .n_readings = N_READINGS};
  double left[CONIC_N_GRADIENT_KINDS] = {0.0};
  conic_status status = try_readings(&job, left, v);
  for (size_t which = 0; which < N_DRAWN && status == CONIC_OK; which++) {
    int is_unnamed = 0;
    for (int kind = 0; kind < CONIC_N_GRADIENT_KINDS; kind++)
      is_unnamed |= v->wrong[kind] && !v->mistakes[kind].is_named;
    if (is_unnamed)
      status = draw_reading(&job, which, left, v);
  }
  return status;
}
