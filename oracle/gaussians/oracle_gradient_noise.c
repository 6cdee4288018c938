/* What roundings do to a derivative, by trying it: the derivative once more with what the set-up and each pixel compute
 * off by chance, as much as single roundings are. Errors that depend on each other, and such as cancel, do so here,
 * too.
 */

#include "core/base/random.h"
#include "oracle/gaussians/oracle_gradient_job.h"

#define UNIT ORACLE_FLOAT_UNIT

/* Of deviation 1. */
static double chance(uint64_t seed, uint64_t index, uint64_t dimension) {
  return 3.4641 * (conic_random_uniform(seed, index, dimension) - 0.5);
}

/* Covariances are off by the sizes of their terms, and their determinant by that of its own. */
void conic_oracle_disturb_form(const oracle_gradient_judging *noise, uint64_t seed, size_t i, double form[3]) {
  const oracle_shown_off *off = &noise->offs[i];
  const double x = off->spread[0], y = off->spread[1], a = form[0], b = form[1], c = form[2];
  const double alone = x > 0.0 ? 0.0 : 0.125; /* a covariance in double, rounded */
  double n[4];
  for (int k = 0; k < 4; k++)
    n[k] = chance(seed, i, (uint64_t)k);
  const double by[3] = {UNIT * x * x * n[0], UNIT * x * y * n[1], UNIT * y * y * n[2]};
  const double det = UNIT * n[3] * (a * c + b * b) / (a * c - b * b);
  form[0] += a * det - (a * a * by[0] + 2.0 * a * b * by[1] + b * b * by[2]) + alone * off->form[0] * n[1];
  form[1] += b * det - (a * b * by[0] + (a * c + b * b) * by[1] + b * c * by[2]) + alone * off->form[1] * n[2];
  form[2] += c * det - (b * b * by[0] + 2.0 * b * c * by[1] + c * c * by[2]) + alone * off->form[2] * n[0];
}

void conic_oracle_disturb_shown(const oracle_gradient_judging *noise, uint64_t seed, oracle_shown *s) {
  const oracle_shown_off *off = &noise->offs[s->index];
  double *const numbers[] = {&s->place[0], &s->place[1], &s->opacity, &s->color[0], &s->color[1], &s->color[2], &s->z};
  const double offs[] = {off->place[0], off->place[1], off->opacity, off->color[0],
                         off->color[1], off->color[2], off->z};
  for (size_t k = 0; k < sizeof offs / sizeof *offs; k++)
    *numbers[k] += offs[k] / ORACLE_SETUP_UNITS * chance(seed, s->index, 8 + k);
  conic_oracle_disturb_form(noise, seed, s->index, s->form);
}

/* Exponents, their terms, and products of α. */
void conic_oracle_disturb_met(const oracle_gradient_job *j, const oracle_shown *s, double x, double y, oracle_met *m) {
  const conic_float_model *model = j->noise->model;
  const double dx = fabs(s->place[0] - x), dy = fabs(s->place[1] - y);
  const double terms = 0.5 * (s->form[0] * dx * dx + s->form[2] * dy * dy) + fabs(s->form[1]) * dx * dy;
  const double nearness = m->response > 0.0 ? -conic_oracle_log(m->response) : 0.0;
  const double share =
      (model->n_form_roundings * terms + 2.0) * UNIT + model->exp_relative + model->exp_by_argument * nearness;
  const uint64_t pixel = (uint64_t)y << 32 | (uint64_t)x;
  const double off = 0.25 * share * chance(j->seed, pixel, 8 * (uint64_t)s->index);
  m->response *= 1.0 + off;
  m->alpha *= m->is_most ? 1.0 : 1.0 + off;
}

/* T, and the light from behind, go on with the roundings of all that was added to them. */
void conic_oracle_disturbed_back(const oracle_gradient_job *j, const oracle_gradient_pixel *pixel,
                                 const oracle_shown *const *shown, oracle_met *met, size_t n, double behind,
                                 double (*sums)[N_BY_SCREEN]) {
  const double *w = pixel->weights;
  double size = fabs(w[3]), share = 0.0;
  for (int c = 0; c < 3; c++)
    size += fabs(w[c] * (double)pixel->background[c]);
  for (size_t i = n; i-- > 0;) {
    oracle_met *m = &met[i];
    const uint64_t at = (uint64_t)pixel->y << 32 | (uint64_t)pixel->x, own_seed = 8 * (uint64_t)m->index;
    const double weight = m->alpha * m->before;
    double own = weight > 0.0 ? 2.0 * fabs(m->by_z * m->z) / weight : 0.0;
    for (int c = 0; c < 3; c++)
      own += fabs(w[c] * shown[m->entry]->color[c]);
    share += UNIT * chance(j->seed, at, own_seed + 1);
    m->before *= 1.0 + share;
    m->by_weight += 2.0 * UNIT * own * chance(j->seed, at, own_seed + 2);
    behind += UNIT * size * chance(j->seed, at, own_seed + 3);
    conic_oracle_gradient_back(&j->view, pixel, shown[m->entry], m, m->before * (m->by_weight - behind),
                               sums[m->entry]);
    behind = m->alpha * m->by_weight + (1.0 - m->alpha) * behind;
    size = m->alpha * own + (1.0 - m->alpha) * size;
  }
}

/* The totals of each sample. */
conic_status conic_oracle_sample_roundings(const oracle_gradient_job *right) {
  oracle_gradient_judging *g = right->judging;
  const size_t n = right->set->count;
  conic_gaussian_gradient none = {.count = 0};
  conic_status status =
      conic_memory_allocate_these(right->context, CONIC_ZEROED(g->samples, ORACLE_ROUNDING_SAMPLES * n));
  for (uint64_t s = 0; s < ORACLE_ROUNDING_SAMPLES && status == CONIC_OK; s++) {
    oracle_gradient_job j = {.context = right->context,
                             .set = right->set,
                             .weights = right->weights,
                             .background = right->background,
                             .view = right->view,
                             .gradient = &none,
                             .noise = g,
                             .seed = s + 1};
    status = conic_oracle_differentiate(&j);
    for (size_t i = 0; i < n && status == CONIC_OK; i++)
      memcpy(g->samples[s * n + i], j.totals[i], sizeof *g->samples);
    conic_oracle_gradient_end(&j);
  }
  return status;
}
