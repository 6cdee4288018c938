/* What decisions in doubt may change in a pixel's part of the derivative: each is followed the other way by itself, and
 * what that changes is added up. α's and T's roundings, which put them in doubt, are of first order. */

#include "core/base/real.h"
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

/* --- decisions the other way --- */

/* Returns how many of the list are composited. */
static size_t run_variant(const pixel_bound *p, size_t n, int goes_on, double (*sums)[N_BY_ELLIPSE]) {
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
  return n;
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
  n_met = run_variant(&p, n_met, 0, p.v->base);
  for (size_t i = 0; i < n_met; i++) {
    oracle_sum_bound *b = &bounds[p.v->list[i].entry];
    b->n++;
    for (int k = 0; k < N_BY_ELLIPSE; k++)
      b->size[k] += fabs(p.v->base[p.v->list[i].entry][k]);
  }
  follow_end(&p, n_met);
  for (size_t i = 0; i < p.n_all; i++)
    follow_least_and_most(&p, i);
  follow_order(&p);
  for (size_t i = 0; i < p.n_all; i++)
    bounds[p.v->all[i].met.entry].is_open |= p.n_variants > MOST_VARIANTS || j->judging->is_open_pixel[at];
}

void conic_oracle_add_gradient_bound(oracle_sum_bound *to, const oracle_sum_bound *from) {
  for (int k = 0; k < N_BY_ELLIPSE; k++) {
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
  conic_status status =
      conic_memory_allocate_these(j->context, CONIC_ROOM(g->bounds, j->most_in_band),
                                  CONIC_ZEROED(g->totals, j->set->count), CONIC_ZEROED(g->of_threads, threads));
  for (size_t k = 0; status == CONIC_OK && k < threads; k++) {
    gradient_variants *v = &g->of_threads[k];
    status = conic_memory_allocate_these(j->context, CONIC_ROOM(v->all, n), CONIC_ROOM(v->list, n),
                                         CONIC_ROOM(v->errors, n), CONIC_ROOM(v->base, n), CONIC_ROOM(v->other, n));
  }
  return status;
}

void conic_oracle_judging_end(oracle_gradient_job *j) {
  oracle_gradient_judging *g = j->judging;
  for (int k = 0; g->of_threads && k < conic_context_threads(j->context); k++) {
    conic_memory_release_these(j->context, g->of_threads[k].all, g->of_threads[k].list, g->of_threads[k].errors,
                               g->of_threads[k].base, g->of_threads[k].other);
  }
  conic_memory_release_these(j->context, g->offs, g->bounds, g->totals, g->is_open_pixel, g->of_threads, g->samples);
}
