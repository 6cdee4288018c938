/* How far off a program of floats may be in a pixel's part of the derivative.
 *
 * Roundings: an error of first order is carried from what the pixel sees of each Gaussian to α, from there to T and to
 * the light from behind, and from these to every term. Other programs begin with the T that is left in the end. They
 * divide it by the 1 − α that they have multiplied by, so that only roundings come anew. Errors of different Gaussians
 * are independent and add in squares. Errors of different pixels may depend on each other and add up.
 *
 * Decisions in doubt: each is followed the other way by itself, and what that changes is added up. */

#include "core/base/radix.h"
#include "oracle/gaussians/oracle_gradient_job.h"

#define UNIT ORACLE_FLOAT_UNIT

enum { MOST_VARIANTS = 24 };

/* The shares of themselves by which α, and T before and after, may be off. */
typedef struct met_error {
  double rho, tau, tau_after;
} met_error;

/* A Gaussian that may cover the pixel. */
typedef struct bounded_met {
  oracle_met met;
  met_error error;
  int covers;
} bounded_met;

typedef struct gradient_variants {
  bounded_met *all;
  oracle_met *list;
  met_error *errors;                                    /* of the list */
  double (*base)[N_BY_ELLIPSE], (*other)[N_BY_ELLIPSE]; /* by entry of the cell */
} gradient_variants;

typedef struct pixel_bound {
  const oracle_gradient_job *j;
  const gradient_worker *w;
  gradient_variants *v;
  oracle_gradient_pixel pixel;
  oracle_sum_bound *bounds;
  size_t n_all; /* of v->all */
  double tau;   /* by which share of itself T may be off in the end */
  int n_variants;
} pixel_bound;

/* --- the roundings --- */

static double share_of_alpha(const pixel_bound *p, const oracle_shown *s, const oracle_met *m) {
  const conic_float_model *model = p->j->judging->model;
  const oracle_shown_off *off = &p->j->judging->offs[s->index];
  const double d[2] = {fabs(s->place[0] - p->pixel.x), fabs(s->place[1] - p->pixel.y)};
  const double f[3] = {fabs(s->form[0]), fabs(s->form[1]), fabs(s->form[2])};
  const double terms = 0.5 * (f[0] * d[0] * d[0] + f[2] * d[1] * d[1]) + f[1] * d[0] * d[1];
  double q = model->n_form_roundings * UNIT * terms;
  q += 0.5 * (off->form[0] * d[0] * d[0] + off->form[2] * d[1] * d[1]) + off->form[1] * d[0] * d[1];
  q += off->place[0] * (f[0] * d[0] + f[1] * d[1]) + off->place[1] * (f[2] * d[1] + f[1] * d[0]);
  const double nearness = m->response > 0.0 ? -conic_oracle_log(m->response) : 0.0;
  return 1.05 * q + off->opacity / fabs(s->opacity) + model->exp_relative + model->exp_by_argument * nearness +
         2.0 * UNIT;
}

/* One term each, and how far it may be off; by_alpha: dL/dα, and its error. */
static void bound_terms(const pixel_bound *p, const oracle_met *m, const met_error *of, double by_alpha,
                        double off_alpha) {
  const oracle_shown *s = p->w->shown[m->entry];
  const oracle_shown_off *off = &p->j->judging->offs[s->index];
  oracle_sum_bound *b = &p->bounds[m->entry];
  const double w = m->alpha * m->before, *weights = p->pixel.weights, u = 4.0 * UNIT, rho = of->rho;
  double term[N_BY_ELLIPSE] = {0.0}, error[N_BY_ELLIPSE] = {0.0};
  for (int c = 0; c < 3; c++) {
    term[BY_COLOR + c] = weights[c] * w;
    error[BY_COLOR + c] = fabs(weights[c] * w) * (of->tau + rho + u);
  }
  term[BY_Z] = m->by_z;
  error[BY_Z] = fabs(m->by_z) * (of->tau + p->tau + rho + u);
  if (!m->is_most) {
    const double d[2] = {s->place[0] - p->pixel.x, s->place[1] - p->pixel.y};
    const double by_q = -0.5 * m->alpha * by_alpha;
    const double off_q = 0.5 * m->alpha * (off_alpha + fabs(by_alpha) * (rho + u));
    term[BY_OPACITY] = by_alpha * m->response;
    error[BY_OPACITY] = m->response * (off_alpha + fabs(by_alpha) * (rho + u));
    for (int a = 0; a < 2; a++) {
      const double f = s->form[2 * a], g = s->form[1], size = fabs(f * d[a]) + fabs(g * d[1 - a]);
      const double shift = off->form[2 * a] * fabs(d[a]) + off->form[1] * fabs(d[1 - a]) + fabs(f) * off->place[a] +
                           fabs(g) * off->place[1 - a] + u * size;
      term[BY_PLACE + a] = 2.0 * by_q * (f * d[a] + g * d[1 - a]);
      error[BY_PLACE + a] = 2.0 * (off_q * size + fabs(by_q) * shift);
    }
    for (int k = 0; k < 3; k++) {
      const int i = k == 2, l = k > 0;
      const double share = k == 1 ? 2.0 : 1.0, square = d[i] * d[l];
      const double shift = off->place[i] * fabs(d[l]) + off->place[l] * fabs(d[i]) + u * fabs(square);
      term[BY_FORM + k] = share * by_q * square;
      error[BY_FORM + k] = share * (off_q * fabs(square) + fabs(by_q) * shift);
    }
  }
  b->n++;
  for (int k = 0; k < N_BY_ELLIPSE; k++) {
    b->off[k] += error[k];
    b->size[k] += fabs(term[k]);
  }
}

static double length_of_errors(const double e[4]) {
  return sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
}

/* Z, and how far the depths are from it in the mean: so much it moves where weights do. */
static double spread_of_depths(const pixel_bound *p, size_t n, double *z) {
  double sum = 0.0, apart = 0.0;
  *z = 0.0;
  for (size_t i = 0; i < n; i++) {
    sum += p->v->list[i].alpha * p->v->list[i].before;
    *z += p->v->list[i].alpha * p->v->list[i].before * p->v->list[i].z;
  }
  *z = sum > 0.0 ? *z / sum : 0.0;
  for (size_t i = 0; i < n; i++)
    apart += p->v->list[i].alpha * p->v->list[i].before * fabs(p->v->list[i].z - *z);
  return sum > 0.0 ? apart / sum : 0.0;
}

/* The light behind, without regard to sign, and its error, go from back to front with the rest. */
static void bound_roundings(const pixel_bound *p, size_t n, double behind) {
  const double *w = p->pixel.weights;
  double size = fabs(w[3]), error = 0.0;
  for (int c = 0; c < 3; c++)
    size += fabs(w[c] * (double)p->pixel.background[c]);
  double z, spread = spread_of_depths(p, n, &z);
  for (size_t i = n; i-- > 0;) {
    const oracle_met *m = &p->v->list[i];
    const met_error *of = &p->v->errors[i];
    const oracle_shown *s = p->w->shown[m->entry];
    const oracle_shown_off *off = &p->j->judging->offs[s->index];
    double own = 0.0, own_error = fabs(m->by_weight) * 4.0 * UNIT;
    for (int c = 0; c < 3; c++) {
      own += fabs(w[c] * s->color[c]);
      own_error += fabs(w[c]) * (off->color[c] + 4.0 * UNIT * fabs(s->color[c]));
    }
    if (m->by_z != 0.0) { /* (z − Z)/A */
      double share = fabs(m->by_z) / (m->alpha * m->before);
      own += share * 2.0 * fabs(m->z);
      own_error += share * (off->z + fabs(m->z) * ((double)n + 8.0) * UNIT + 2.0 * p->tau * (spread + fabs(m->z - z)));
    }
    const double apart = fabs(m->by_weight - behind), left = oracle_max(1.0 - m->alpha, UNIT);
    const double rounded = (2.0 * (double)(n - i) + 4.0 + 2.0 / left) * UNIT;
    const double parts[4] = {apart * of->tau, own_error, error, (own + size) * rounded};
    bound_terms(p, m, of, m->before * (m->by_weight - behind), m->before * length_of_errors(parts));
    const double carried[4] = {m->alpha * apart * of->rho, m->alpha * own_error, (1.0 - m->alpha) * error, 0.0};
    error = length_of_errors(carried);
    size = m->alpha * own + (1.0 - m->alpha) * size;
    behind = m->alpha * m->by_weight + (1.0 - m->alpha) * behind;
  }
}

/* --- decisions the other way --- */

static void run_variant(const pixel_bound *p, size_t n, int goes_on, double (*sums)[N_BY_ELLIPSE]) {
  oracle_gradient_pixel pixel = p->pixel;
  double behind;
  pixel.goes_on = goes_on;
  for (size_t i = 0; i < p->n_all; i++)
    memset(sums[p->v->all[i].met.entry], 0, sizeof *sums);
  conic_oracle_gradient_forth(&p->j->view, &pixel, p->w->shown, p->v->list, &n, &behind);
  for (size_t i = n; i-- > 0;) {
    const oracle_met *m = &p->v->list[i];
    conic_oracle_gradient_back(&p->j->view, &pixel, p->w->shown[m->entry], m, m->before * (m->by_weight - behind),
                               sums[m->entry]);
    behind = m->alpha * m->by_weight + (1.0 - m->alpha) * behind;
  }
}

/* What the list makes other than it is. */
static void admit_variant(pixel_bound *p, size_t n, int goes_on) {
  if (++p->n_variants > MOST_VARIANTS)
    return;
  run_variant(p, n, goes_on, p->v->other);
  for (size_t i = 0; i < p->n_all; i++) {
    const uint32_t entry = p->v->all[i].met.entry;
    for (int k = 0; k < N_BY_ELLIPSE; k++)
      p->bounds[entry].slack[k] += fabs(p->v->other[entry][k] - p->v->base[entry][k]);
  }
}

/* Lists the Gaussians that cover the pixel. The one that is asked about counts the other way: it is listed where it
 * does not cover, and left out where it does. */
static size_t list_covering(const pixel_bound *p, size_t asked) {
  size_t n = 0;
  for (size_t i = 0; i < p->n_all; i++)
    if (p->v->all[i].covers != (i == asked)) {
      p->v->errors[n] = p->v->all[i].error;
      p->v->list[n++] = p->v->all[i].met;
    }
  return n;
}

static void follow_least_and_most(pixel_bound *p, size_t i) {
  const conic_profile_row *rules = p->j->view.rules;
  const bounded_met *b = &p->v->all[i];
  const oracle_shown *s = p->w->shown[b->met.entry];
  const double alpha = s->opacity * b->met.response, off = b->error.rho * alpha + UNIT * rules->alpha_least;
  if (rules->alpha_least > 0.0 && fabs(alpha - rules->alpha_least) <= off)
    admit_variant(p, list_covering(p, i), 0);
  if (fabs(alpha - rules->alpha_most) > b->error.rho * alpha + UNIT || !b->covers)
    return;
  size_t n = list_covering(p, (size_t)-1);
  for (size_t k = 0; k < n; k++)
    if (p->v->list[k].entry == b->met.entry) {
      p->v->list[k].is_most ^= 1;
      p->v->list[k].alpha = p->v->list[k].is_most ? rules->alpha_most : alpha;
    }
  admit_variant(p, n, 0);
}

/* Neighbours whose keys floats may exchange. */
static void follow_order(pixel_bound *p) {
  const oracle_shown_off *offs = p->j->judging->offs;
  const size_t n = list_covering(p, (size_t)-1);
  for (size_t i = 0; i < n; i++)
    for (size_t k = i + 1; k < n; k++) {
      const oracle_met *a = &p->v->list[i], *b = &p->v->list[k];
      if ((double)b->key - (double)a->key > offs[a->index].key + offs[b->index].key)
        break;
      const oracle_met kept = *a;
      list_covering(p, (size_t)-1);
      memmove(p->v->list + i, p->v->list + i + 1, (k - i) * sizeof kept);
      p->v->list[k] = kept;
      admit_variant(p, n, 0);
      list_covering(p, (size_t)-1);
    }
}

/* Where T is at its end but for roundings: without the one before that, or with the one behind. */
static void follow_end(pixel_bound *p, size_t n) {
  const conic_profile_row *rules = p->j->view.rules;
  const size_t n_covering = list_covering(p, (size_t)-1);
  double T = 1.0;
  for (size_t i = 0; i < n_covering && rules->stop > 0.0; i++) {
    T *= 1.0 - p->v->list[i].alpha;
    if (fabs(T - rules->stop) <= T * (p->v->errors[i].tau_after + 4.0 * UNIT)) {
      admit_variant(p, i < n ? i : i + 1, 1);
      list_covering(p, (size_t)-1);
    }
    if (T < 0.5 * rules->stop)
      break;
  }
}

CONIC_DEFINE_ORDER_BY_TWO(compare_bounded, bounded_met, met.key, met.index)

/* All that may cover the pixel before compositing ends for sure. */
static void meet_all_that_may(pixel_bound *p, size_t n, size_t x, size_t y) {
  const double stop = p->j->view.rules->stop;
  double T = 1.0;
  for (size_t i = 0; i < n && !(T < 0.01 * stop); i++) {
    const oracle_shown *s = p->w->shown[i];
    bounded_met *b = &p->v->all[p->n_all];
    if (x < s->first[0] || x > s->last[0] || y < s->first[1] || y > s->last[1])
      continue;
    int how = conic_oracle_meet_shown(&p->j->view, s, p->pixel.x, p->pixel.y, &b->met);
    if (!how)
      continue;
    b->met.entry = (uint32_t)i;
    b->covers = how == ORACLE_COVERS;
    b->error = (met_error){share_of_alpha(p, s, &b->met), p->tau, p->tau};
    if (!b->covers && b->error.rho * b->met.alpha + b->met.alpha < p->j->view.rules->alpha_least * (1.0 - UNIT))
      continue;
    p->n_all++;
    if (!b->covers)
      continue;
    T *= 1.0 - b->met.alpha;
    const double own = (b->error.rho * b->met.alpha + 2.0 * UNIT) / oracle_max(1.0 - b->met.alpha, UNIT);
    b->error.tau_after = sqrt(p->tau * p->tau + own * own);
    if (T >= 0.5 * stop)
      p->tau = b->error.tau_after;
  }
  qsort(p->v->all, p->n_all, sizeof *p->v->all, compare_bounded);
}

void conic_oracle_bound_pixel_gradient(const oracle_gradient_job *j, const gradient_worker *w, size_t n, size_t x,
                                       size_t y, int i_thread, oracle_sum_bound *bounds) {
  const size_t at = y * (size_t)j->weights->width + x;
  pixel_bound p = {.j = j, .w = w, .v = &j->judging->of_threads[i_thread], .bounds = bounds};
  p.pixel = (oracle_gradient_pixel){.x = (double)x + 0.5, .y = (double)y + 0.5, .background = j->background};
  if (!conic_oracle_pixel_weights(j->weights, at, p.pixel.weights))
    return;
  meet_all_that_may(&p, n, x, y);
  size_t n_met = list_covering(&p, (size_t)-1);
  double behind;
  run_variant(&p, n_met, 0, p.v->base);
  conic_oracle_gradient_forth(&j->view, &p.pixel, w->shown, p.v->list, &n_met, &behind);
  bound_roundings(&p, n_met, behind);
  follow_end(&p, n_met);
  for (size_t i = 0; i < p.n_all; i++)
    follow_least_and_most(&p, i);
  follow_order(&p);
  for (size_t i = 0; i < p.n_all; i++)
    bounds[p.v->all[i].met.entry].is_open |= p.n_variants > MOST_VARIANTS || j->judging->is_open_pixel[at];
}

void conic_oracle_add_gradient_bound(oracle_sum_bound *to, const oracle_sum_bound *from) {
  for (int k = 0; k < N_BY_ELLIPSE; k++) {
    to->off[k] += from->off[k];
    to->size[k] += from->size[k];
    to->slack[k] += from->slack[k];
  }
  to->n += from->n;
  to->is_open |= from->is_open;
}

/* --- room --- */

conic_status conic_oracle_judging_room(oracle_gradient_job *j) {
  oracle_gradient_judging *g = j->judging;
  const size_t threads = (size_t)conic_context_threads(j->context), n = j->most_entries + 1;
  int is_done = (g->bounds = conic_memory_allocate(j->context, j->most_in_band, sizeof *g->bounds)) != NULL;
  is_done &= (g->totals = conic_memory_allocate_zeroed(j->context, j->set->count, sizeof *g->totals)) != NULL;
  is_done &= (g->of_threads = conic_memory_allocate_zeroed(j->context, threads, sizeof *g->of_threads)) != NULL;
  for (size_t k = 0; is_done && k < threads; k++) {
    gradient_variants *v = &g->of_threads[k];
    is_done =
        conic_memory_allocate_these(j->context, CONIC_ROOM(v->all, n), CONIC_ROOM(v->list, n), CONIC_ROOM(v->errors, n),
                                    CONIC_ROOM(v->base, n), CONIC_ROOM(v->other, n)) == CONIC_OK;
  }
  return is_done ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void conic_oracle_judging_end(oracle_gradient_job *j) {
  oracle_gradient_judging *g = j->judging;
  for (int k = 0; g->of_threads && k < conic_context_threads(j->context); k++) {
    conic_memory_release_these(j->context, g->of_threads[k].all, g->of_threads[k].list, g->of_threads[k].errors,
                               g->of_threads[k].base, g->of_threads[k].other);
  }
  conic_memory_release_these(j->context, g->offs, g->bounds, g->totals, g->is_open_pixel, g->of_threads);
}
