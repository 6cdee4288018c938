/* Whether a mistake explains all of a picture, and not only the samples by which it was found. */
#include <math.h>

#include "core/base/base.h"
#include "judge/diagnosis_samples.h"

/* A wrong pixel becomes right if less than a tenth of its difference is left, or half where roundings may leave that.
 */
static const double most_left = 0.1, most_in_doubt = 0.5, noise = 2e-5;
/* A right pixel is spoilt by more than this. */
static const double least_spoilt = 1e-4;

typedef struct check_run {
  conic_trials *trials;
  conic_diagnosis_samples samples;
  conic_channels *ours, *drawn;
} check_run;

static conic_status draw_finished(check_run *r, const conic_planted *planted, conic_channels *values) {
  conic_status status = r->trials->draw(r->trials->world, planted, &r->samples, values);
  if (status == CONIC_OK)
    conic_planted_finish(planted, r->samples.n, values);
  return status;
}

/* Until the end, `share` is what is left, and *whole the difference. */
static void compare_samples(const check_run *r, conic_counter_check *check, double *whole) {
  const conic_judged_picture *picture = r->trials->picture;
  for (size_t i = 0; i < r->samples.n; i++) {
    const double before = conic_diagnosis_distance_at(&r->samples, i, r->ours[i]);
    const double after = conic_diagnosis_distance_at(&r->samples, i, r->drawn[i]);
    const uint16_t *at = r->samples.places[i];
    const size_t pixel = (size_t)at[1] * (size_t)r->samples.width + at[0];
    const double range = picture->ranges ? (double)picture->ranges[pixel] : 0.0;
    if (picture->classes[pixel] == CONIC_PIXEL_WRONG) {
      const int is_righted =
          after <= most_left * before || (after <= most_in_doubt * before && after <= fmax(noise, range));
      if (!is_righted && range > most_in_doubt * before)
        continue;
      check->wrong++;
      check->righted += (size_t)is_righted;
    } else if (picture->classes[pixel] < CONIC_PIXEL_EXPLAINED) {
      check->right++;
      check->spoilt += after > least_spoilt && after > 3.0 * before && after > range;
    } else
      continue;
    check->share += after;
    *whole += before;
  }
}

static conic_status check_samples(check_run *r, size_t n, conic_counter_check *checks, double *wholes) {
  conic_context *context = r->trials->context;
  conic_status status =
      conic_memory_allocate_these(context, CONIC_ROOM(r->ours, r->samples.n), CONIC_ROOM(r->drawn, r->samples.n));
  if (status == CONIC_OK)
    status = draw_finished(r, r->trials->right, r->ours);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    status = draw_finished(r, &checks[i].planted, r->drawn);
    if (status == CONIC_OK)
      compare_samples(r, &checks[i], &wholes[i]);
  }
  conic_memory_release_these(context, r->ours, r->drawn);
  return status;
}

conic_status conic_counter_check_all(conic_trials *trials, size_t n, conic_counter_check *checks) {
  check_run r = {.trials = trials};
  double wholes[CONIC_MOST_DIAGNOSES] = {0.0};
  size_t next = 0;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n; i++)
    checks[i] = (conic_counter_check){.planted = checks[i].planted, .is_rough = checks[i].is_rough};
  for (int is_more = n > 0; is_more && status == CONIC_OK;) {
    status = conic_diagnosis_samples_take(trials->context, trials->picture, &next, &r.samples);
    is_more = r.samples.n > 0;
    if (status == CONIC_OK && is_more)
      status = check_samples(&r, n, checks, wholes);
    conic_diagnosis_samples_release(&r.samples);
  }
  for (size_t i = 0; i < n; i++)
    checks[i].share = wholes[i] > 0.0 ? 1.0 - checks[i].share / wholes[i] : 0.0;
  return status;
}

int conic_counter_check_is_passed(const conic_counter_check *check) {
  const size_t noise_px = 2 + check->wrong / 50 + check->right / 1000;
  const double least_share = check->is_rough ? 0.5 : 0.9;
  return check->spoilt <= noise_px && check->share >= least_share && check->righted > 0 &&
         (check->is_rough || 10 * check->righted >= 8 * check->wrong);
}
