/* Somebody's gradient held against the one in double precision, within what floats and decisions in doubt may do. */
#include "oracle/gaussians/oracle_gradient_job.h"

enum { RUN = ORACLE_GRADIENT_RUN };

/* What the set-up in float, and the chain back, are off by, in units of the sum of their terms' sizes. Roundings of 0.4
 * units' deviation, fifty of a term, are within 13 units at 4.7 standard deviations; few of them are of whole terms. */
static const double n_setup_units = ORACLE_SETUP_UNITS, n_chain_units = 16.0;
/* A sum of n terms in whatever order is off by √n units of the terms' sizes, 8 times at most: roundings are as good as
 * independent. */
static const double n_sum_deviations = 5.0;
/* Where the compensation's square is off by more, a difference of nearly equal numbers leaves nothing of it. */
static const double most_compensation = 0.1;
/* Of the deviation of samples, which are few. */
static const double n_sample_deviations = 8.0;
/* Two decisions at once may change more than each by itself, by as much as a Gaussian at its least hides. */
static const double crossed = 1.1;

typedef struct judge_run {
  size_t classes[CONIC_N_GAUSSIAN_CLASSES], wrong[CONIC_N_GRADIENT_KINDS];
  double max_abs[CONIC_N_GRADIENT_KINDS], share[CONIC_N_GRADIENT_KINDS];
  conic_gradient_fault worst[CONIC_MAX_FAULTS];
  int n_worst;
} judge_run;

typedef struct gradient_judge_job {
  oracle_gradient_job *j;
  const conic_gaussian_gradient *theirs;
  double greatest[CONIC_N_GRADIENT_KINDS];
  uint8_t *classes;
  judge_run *runs;
} gradient_judge_job;

/* --- a Gaussian's numbers --- */

conic_gradient_kind conic_oracle_number_kind(size_t at) {
  return at < 3                      ? CONIC_GRADIENT_MEAN
         : at < 6                    ? CONIC_GRADIENT_SCALE
         : at < 10                   ? CONIC_GRADIENT_ROTATION
         : at < 11                   ? CONIC_GRADIENT_OPACITY
         : at < ORACLE_FIXED_NUMBERS ? CONIC_GRADIENT_PLACE
                                     : CONIC_GRADIENT_SH;
}

size_t conic_oracle_place_in_kind(size_t at) {
  static const size_t begin[CONIC_N_GRADIENT_KINDS] = {0, 3, 6, 10, ORACLE_FIXED_NUMBERS, 11};
  return at - begin[conic_oracle_number_kind(at)];
}

double conic_oracle_number_in(const conic_gaussian_gradient *g, size_t i, size_t at) {
  const size_t n_sh = 3 * (size_t)(g->sh_degree + 1) * (size_t)(g->sh_degree + 1), k = conic_oracle_place_in_kind(at);
  const conic_gradient_kind kind = conic_oracle_number_kind(at);
  double *const *const columns[CONIC_N_GRADIENT_KINDS] = {g->mean, g->scale, g->rotation, &g->opacity, NULL, g->place};
  if (kind == CONIC_GRADIENT_SH)
    return k < n_sh ? g->sh[i * n_sh + k] : 0.0;
  return columns[kind][k] ? columns[kind][k][i] : 0.0;
}

double conic_oracle_number_of(const oracle_parameters *p, const double *sums, size_t at) {
  const double *const of_kinds[CONIC_N_GRADIENT_KINDS] = {p->mean,     p->scale, p->rotation,
                                                          &p->opacity, p->sh,    sums + BY_PLACE};
  return of_kinds[conic_oracle_number_kind(at)][conic_oracle_place_in_kind(at)];
}

double conic_oracle_raw_factor(const oracle_gradient_job *j, size_t i, size_t at) {
  const double o = (double)j->set->opacity[i];
  if (!j->gradient->is_raw || (conic_oracle_number_kind(at) != CONIC_GRADIENT_SCALE && at != 10))
    return 1.0;
  return at == 10 ? fabs(o * (1.0 - o)) : j->set->scale[at - 3] ? fabs((double)j->set->scale[at - 3][i]) : 0.0;
}

/* --- its bounds --- */

/* By how much samples of roundings move the numbers, in the mean of squares. A sample of few may be small by chance,
 * which the numbers of the same kind make up for. */
static void spread_of_samples(const oracle_gradient_job *j, size_t i, size_t n, double *spread) {
  double of_kinds[CONIC_N_GRADIENT_KINDS] = {0.0};
  size_t n_of_kinds[CONIC_N_GRADIENT_KINDS] = {0};
  oracle_camera_gradient camera = {.focal = {0.0}};
  oracle_parameters right, p;
  conic_oracle_gradient_chain(&j->view, &j->eye, j->set, i, NULL, NULL, j->totals[i], &right, &camera);
  memset(spread, 0, n * sizeof *spread);
  for (uint64_t s = 0; s < ORACLE_ROUNDING_SAMPLES; s++) {
    const double *sums = j->judging->samples[s * j->set->count + i];
    double form[3];
    memcpy(form, j->shown[i].form, sizeof form);
    conic_oracle_disturb_form(j->judging, s + 1, i, form);
    conic_oracle_gradient_chain(&j->view, &j->eye, j->set, i, NULL, form, sums, &p, &camera);
    for (size_t at = 0; at < n; at++) {
      const double off = conic_oracle_number_of(&p, sums, at) - conic_oracle_number_of(&right, j->totals[i], at);
      spread[at] += off * off / ORACLE_ROUNDING_SAMPLES;
    }
  }
  for (size_t at = 0; at < n; at++) {
    of_kinds[conic_oracle_number_kind(at)] += spread[at];
    n_of_kinds[conic_oracle_number_kind(at)]++;
  }
  for (size_t at = 0; at < n; at++) {
    const conic_gradient_kind kind = conic_oracle_number_kind(at);
    spread[at] = sqrt(spread[at] + 0.25 * of_kinds[kind] / (double)n_of_kinds[kind]);
  }
}

void conic_oracle_bound_numbers(const oracle_gradient_job *j, size_t i, size_t n, double *bound, double *slack) {
  const oracle_sum_bound *b = &j->judging->totals[i];
  double sizes[N_BY_SCREEN] = {0.0}, spread[ORACLE_MOST_NUMBERS];
  oracle_parameters p;
  memset(bound, 0, n * sizeof *bound);
  memset(slack, 0, n * sizeof *slack);
  int is_met = j->is_shown[i] != 0;
  for (int k = 0; k < N_BY_ELLIPSE; k++)
    is_met |= b->slack[k] > 0.0;
  if (!is_met)
    return;
  for (int k = 0; k < N_BY_ELLIPSE; k++) {
    double one[N_BY_SCREEN] = {0.0};
    oracle_camera_gradient camera = {.focal = {0.0}};
    const double off = n_sum_deviations * sqrt((double)b->n) * ORACLE_FLOAT_UNIT * b->size[k];
    sizes[k] = fabs(j->totals[i][k]) + off;
    if (!(off + b->slack[k] > 0.0))
      continue;
    one[k] = 1.0;
    conic_oracle_gradient_chain(&j->view, &j->eye, j->set, i, NULL, NULL, one, &p, &camera);
    const double more = k == BY_OPACITY ? j->judging->offs[i].compensation * fabs(j->totals[i][k]) : 0.0;
    for (size_t at = 0; at < n; at++) {
      bound[at] += fabs(conic_oracle_number_of(&p, one, at)) * (off + more);
      slack[at] += crossed * fabs(conic_oracle_number_of(&p, one, at)) * b->slack[k];
    }
  }
  spread_of_samples(j, i, n, spread);
  conic_oracle_gradient_sizes(&j->view, j->set, i, sizes, &p);
  for (size_t at = 0; at < n; at++) {
    const double size = fabs(conic_oracle_number_of(&p, sizes, at));
    bound[at] += n_chain_units * ORACLE_FLOAT_UNIT * size + n_sample_deviations * spread[at];
  }
}

/* --- the verdict --- */

static double fault_severity(const gradient_judge_job *job, const conic_gradient_fault *f) {
  double out = f->found < f->low ? f->low - f->found : f->found > f->high ? f->found - f->high : INFINITY;
  return out / oracle_max(job->greatest[f->kind], 1e-300);
}

static void put_gradient_fault(const gradient_judge_job *job, const conic_gradient_fault *fault,
                               conic_gradient_fault *worst, int *n) {
  const double own = fault_severity(job, fault);
  int at = *n;
  while (at > 0 && own > fault_severity(job, &worst[at - 1]))
    at--;
  if (at == CONIC_MAX_FAULTS)
    return;
  *n += *n < CONIC_MAX_FAULTS;
  for (int k = *n - 1; k > at; k--)
    worst[k] = worst[k - 1];
  worst[at] = *fault;
}

static conic_gaussian_class class_of_number(double found, double value, double bound, double slack, int is_open) {
  const double nothing = 1e-37, off = fabs(found - value); /* what underflow may leave */
  if ((float)found == (float)value)
    return CONIC_PIXEL_EQUAL;
  if (off <= bound + nothing)
    return CONIC_PIXEL_ROUNDED;
  return off <= bound + slack + nothing || (is_open && oracle_is_finite(found)) ? CONIC_PIXEL_EXPLAINED
                                                                                : CONIC_PIXEL_WRONG;
}

int conic_oracle_is_open(const oracle_gradient_job *j, size_t i) {
  const uint32_t followed =
      1u << CONIC_DOUBT_LEAST | 1u << CONIC_DOUBT_ORDER | 1u << CONIC_DOUBT_END | 1u << CONIC_DOUBT_MOST;
  return j->judging->totals[i].is_open || j->judging->offs[i].compensation > most_compensation ||
         j->gradient->doubt[i] & ~followed;
}

static void judge_gaussian(const gradient_judge_job *job, size_t i, judge_run *run) {
  const oracle_gradient_job *j = job->j;
  const size_t n = ORACLE_FIXED_NUMBERS + 3 * (size_t)(j->set->sh_degree + 1) * (size_t)(j->set->sh_degree + 1);
  const int is_open = conic_oracle_is_open(j, i);
  double bound[ORACLE_MOST_NUMBERS] = {0.0}, slack[ORACLE_MOST_NUMBERS] = {0.0}, worst = -1.0;
  conic_gaussian_class class = CONIC_PIXEL_EQUAL;
  conic_gradient_fault fault = {.gaussian = i};
  unsigned wrong = 0;
  conic_oracle_bound_numbers(j, i, n, bound, slack);
  for (size_t at = 0; at < n; at++) {
    const conic_gradient_kind kind = conic_oracle_number_kind(at);
    if (job->theirs->lacks >> kind & 1 || (kind == CONIC_GRADIENT_SCALE && !j->set->scale[at - 3]))
      continue;
    const double found = conic_oracle_number_in(job->theirs, i, at), value = conic_oracle_number_in(j->gradient, i, at);
    const double factor = conic_oracle_raw_factor(j, i, at), room = factor * bound[at], more = factor * slack[at];
    const conic_gaussian_class own = class_of_number(found, value, room, more, is_open);
    const double off = oracle_is_finite(found) ? fabs(found - value) : INFINITY;
    class = own > class ? own : class;
    run->max_abs[kind] = oracle_max(run->max_abs[kind], off);
    if (own == CONIC_PIXEL_ROUNDED && room > 0.0)
      run->share[kind] = oracle_max(run->share[kind], off / room);
    if (own != CONIC_PIXEL_WRONG)
      continue;
    wrong |= 1u << kind;
    conic_gradient_fault f = {
        i, (int)kind, (int)conic_oracle_place_in_kind(at), found, value, value - room - more, value + room + more};
    if (fault_severity(job, &f) > worst) {
      worst = fault_severity(job, &f);
      fault = f;
    }
  }
  for (int kind = 0; kind < CONIC_N_GRADIENT_KINDS; kind++)
    run->wrong[kind] += wrong >> kind & 1;
  run->classes[class]++;
  if (job->classes)
    job->classes[i] = (uint8_t) class;
  j->wrong_kinds[i] = (uint8_t)wrong;
  if (wrong)
    put_gradient_fault(job, &fault, run->worst, &run->n_worst);
}

static void judge_run_of_gaussians(void *data, size_t i_run) {
  const gradient_judge_job *job = data;
  for (size_t i = i_run * RUN; i < (i_run + 1) * RUN && i < job->j->set->count; i++)
    judge_gaussian(job, i, &job->runs[i_run]);
}

static void add_runs(const gradient_judge_job *job, size_t n_runs, conic_gradient_verdict *v) {
  for (size_t r = 0; r < n_runs; r++) {
    const judge_run *run = &job->runs[r];
    for (int k = 0; k < CONIC_N_GAUSSIAN_CLASSES; k++)
      v->gaussians[k] += run->classes[k];
    for (int k = 0; k < CONIC_N_GRADIENT_KINDS; k++) {
      v->wrong[k] += run->wrong[k];
      v->max_abs[k] = oracle_max(v->max_abs[k], run->max_abs[k]);
      v->share_of_bound[k] = oracle_max(v->share_of_bound[k], run->share[k]);
    }
    for (int k = 0; k < run->n_worst; k++)
      put_gradient_fault(job, &run->worst[k], v->worst, &v->n_worst);
  }
  memcpy(v->greatest, job->greatest, sizeof v->greatest);
  v->pass = v->gaussians[CONIC_PIXEL_WRONG] == 0;
}

static conic_status judge_all_gaussians(gradient_judge_job *job, conic_gradient_verdict *verdict) {
  const size_t n = job->j->set->count, n_runs = (n + RUN - 1) / RUN;
  const size_t n_numbers =
      ORACLE_FIXED_NUMBERS + 3 * (size_t)(job->j->set->sh_degree + 1) * (size_t)(job->j->set->sh_degree + 1);
  for (size_t i = 0; i < n; i++)
    for (size_t at = 0; at < n_numbers; at++) {
      double *greatest = &job->greatest[conic_oracle_number_kind(at)];
      *greatest = oracle_max(*greatest, fabs(conic_oracle_number_in(job->j->gradient, i, at)));
    }
  job->runs = conic_memory_allocate_zeroed(job->j->context, n_runs, sizeof *job->runs);
  if (!job->runs)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_parallel_told(job->j->context, "judge", 0.0, 1.0, n_runs, judge_run_of_gaussians, job);
  if (status == CONIC_OK)
    add_runs(job, n_runs, verdict);
  conic_memory_release(job->j->context, job->runs);
  return status;
}

/* --- the entry --- */

typedef struct offs_job {
  const oracle_doubting *d, *in_double; /* of the model; and as if set up in double */
  oracle_shown_off *offs;
} offs_job;

/* What forming covariances in space does to those on the screen, a unit of the terms' sizes each, and to their inverse;
 * and the means. The bounds of oracle_uncertain.c hold whatever each rounding does, which is a thousand times as much
 * as a sum over pixels ever meets. */
static void add_setup_in_float(const oracle_doubting *d, size_t i, const oracle_uncertain *g, oracle_shown_off *to) {
  const conic_camera *camera = d->view->camera;
  const double unit = n_setup_units * ORACLE_FLOAT_UNIT, size = camera->width + camera->height;
  oracle_gaussian placed;
  row_sizes s = {0};
  conic_oracle_gaussian_place(d->view, d->set, i, &placed);
  conic_oracle_row_sizes(d->view, &placed, &s);
  const double x = sqrt(oracle_dot(s.rows[0], s.rows[0]) + d->view->rules->dilation);
  const double y = sqrt(oracle_dot(s.rows[1], s.rows[1]) + d->view->rules->dilation);
  const double a = fabs(placed.form[0]) * x + fabs(placed.form[1]) * y;
  const double b = fabs(placed.form[1]) * x + fabs(placed.form[2]) * y;
  to->form[0] += unit * a * a;
  to->form[1] += unit * a * b;
  to->form[2] += unit * b * b;
  to->spread[0] = x;
  to->spread[1] = y;
  double fars[3], far;
  for (int row = 0; row < 3; row++) {
    fars[row] = fabs(camera->cam_from_world[row][3]);
    for (int axis = 0; axis < 3; axis++)
      fars[row] += fabs(camera->cam_from_world[row][axis] * (d->set->origin[axis] + (double)d->set->position[axis][i]));
  }
  far = fars[2];
  to->z += unit * far;
  to->key += unit * (d->view->rules->orders_by_distance ? oracle_length(placed.mean) + far : far);
  for (int axis = 0; axis < 2; axis++)
    to->place[axis] += unit * (fabs(placed.place_px[axis]) + size +
                               s.focal[axis] / oracle_max(placed.mean[2], 1e-30) * (fars[axis] + s.slope[axis] * far));
  const double least = d->view->rules->compensation_least, o = fabs((double)d->set->opacity[i]);
  const double after = 1.0 / (placed.form[0] * placed.form[2] - placed.form[1] * placed.form[1]);
  if (least >= 0.0 && o > 0.0) { /* a share of the square root of a difference */
    const double share = fabs(g->opacity.v) / o, off = unit * x * x * y * y / after;
    const double square = oracle_dot(s.rows[0], s.rows[0]) * oracle_dot(s.rows[1], s.rows[1]) / after;
    to->compensation = share * share > least ? unit * square / (share * share) : share > 0.0 ? 0.0 : INFINITY;
    to->opacity += o * (share > 0.0 ? oracle_min(off / share, sqrt(off)) : sqrt(off));
  }
}

static void find_offs(void *data, size_t i_run) {
  const offs_job *job = data;
  for (size_t i = i_run * RUN; i < (i_run + 1) * RUN && i < job->d->set->count; i++) {
    oracle_uncertain g, colored;
    oracle_shown_off *to = &job->offs[i];
    if (!conic_oracle_uncertain_place(job->in_double, i, &g))
      continue;
    colored = g;
    if (!conic_oracle_uncertain_color(job->d, &colored))
      continue;
    *to = (oracle_shown_off){.opacity = g.opacity.off, .z = g.z.off, .key = g.key.off};
    for (int k = 0; k < 3; k++) {
      to->form[k] = g.form[k].off;
      to->color[k] = colored.color[k].off;
    }
    to->place[0] = g.offset[0].off;
    to->place[1] = g.offset[1].off;
    if (job->d->model->is_setup_in_float)
      add_setup_in_float(job->d, i, &g, to);
  }
}

static conic_status prepare_judging(oracle_gradient_job *j, oracle_entry *e) {
  oracle_gradient_judging *g = j->judging;
  const size_t n = j->set->count;
  if (conic_memory_allocate_these(j->context, CONIC_ZEROED(g->offs, n),
                                  CONIC_ZEROED(g->is_open_pixel, e->bounding.n_pixels)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  conic_float_model own;
  oracle_doubting in_double = e->bounding.doubting;
  conic_float_model_init(&own, CONIC_FLOATS_OWN);
  in_double.model = &own;
  offs_job offs = {&e->bounding.doubting, &in_double, g->offs};
  conic_parallel_for(j->context, (n + RUN - 1) / RUN, find_offs, &offs);
  return conic_oracle_gradient_doubts(j, e);
}

static conic_status check_theirs(conic_context *context, const conic_gaussians *set, const conic_gaussian_options *own,
                                 const conic_gaussian_gradient *theirs) {
  if (conic_profile_row_of(own->profile)->shape != CONIC_SHAPE_ELLIPSE)
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "judge: gradients of the profile %s are not judged",
                      conic_gaussian_profile_name(own->profile));
  if (theirs->count != set->count)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: the gradient is of %zu Gaussians, and the scene has %zu",
                      theirs->count, set->count);
  if (theirs->sh_degree < set->sh_degree && !(theirs->lacks >> CONIC_GRADIENT_SH & 1))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: the gradient has harmonics of degree %d, and the scene %d",
                      theirs->sh_degree, set->sh_degree);
  return CONIC_OK;
}

conic_status conic_gaussian_gradient_judge(conic_context *context, const conic_gaussians *set,
                                           const conic_camera *camera, const conic_gaussian_options *options,
                                           const conic_gaussian_weights *weights, const conic_gradient_options *how,
                                           /* NOLINTNEXTLINE(readability-non-const-parameter): filled in */
                                           const conic_gaussian_gradient *theirs, uint8_t *classes,
                                           conic_gradient_verdict *verdict) {
  conic_gaussian_gradient gradient;
  uint8_t *own_kinds = NULL;
  oracle_gradient_judging judging = {.model = NULL};
  oracle_entry e;
  oracle_gradient_job j;
  memset(verdict, 0, sizeof *verdict);
  conic_status status =
      conic_oracle_gradient_begin(context, set, camera, options, weights, how, CONIC_FLOATS_FAST, &gradient, &e, &j);
  if (status != CONIC_OK)
    return status;
  j.model = judging.model = &e.model;
  j.judging = &judging;
  status = check_theirs(context, set, &e.options, theirs);
  if (status == CONIC_OK && !j.wrong_kinds) {
    j.wrong_kinds = own_kinds = conic_memory_allocate(context, set->count, 1);
    status = own_kinds ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK)
    status = prepare_judging(&j, &e);
  if (status == CONIC_OK)
    status = conic_oracle_differentiate(&j);
  if (status == CONIC_OK)
    status = conic_oracle_gradient_chain_all(&j);
  if (status == CONIC_OK)
    status = conic_oracle_sample_roundings(&j);
  if (status == CONIC_OK) {
    gradient_judge_job job = {.j = &j, .theirs = theirs, .classes = classes};
    status = judge_all_gaussians(&job, verdict);
    if (status == CONIC_OK && !verdict->pass)
      status = conic_oracle_name_mistakes(&j, theirs, verdict);
  }
  conic_memory_release(context, own_kinds);
  conic_oracle_judging_end(&j);
  conic_oracle_gradient_end(&j);
  conic_gaussian_gradient_release(context, &gradient);
  return status;
}
