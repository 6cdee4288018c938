/* The reference of a mean: of two pixels, made by hand. */

#include "tests/support/check.h"

enum { N_PIXELS = 3, AT_ALBEDO = 8, AT_WEIGHT = 11 };

typedef struct made {
  conic_reference reference;
  double rgba[4 * N_PIXELS], z[N_PIXELS], normal[3 * N_PIXELS], albedo[3 * N_PIXELS], weight[N_PIXELS], count[N_PIXELS],
      id[N_PIXELS];
  uint8_t unstable[N_PIXELS];
  conic_alternative alternatives[2];
} made;

/* Every value of pixel i is `value` + i; pixel 1 may be any of two ranges. */
static void make_reference(made *m, double value, int is_in_doubt) {
  memset(m, 0, sizeof *m);
  conic_reference *r = &m->reference;
  double *const planes[] = {m->rgba, m->z, m->normal, m->albedo, m->weight, m->count, m->id};
  r->width = N_PIXELS;
  r->height = r->samples = 1;
  r->white = 1.0;
  r->n_pixels = N_PIXELS;
  r->unstable = m->unstable;
  for (int k = 0; k < 7; k++) {
    int n = conic_plane_describe((conic_plane)k)->n_channels;
    r->planes[k] = planes[k];
    for (int i = 0; i < n * N_PIXELS; i++)
      planes[k][i] = value + (double)(i / n);
  }
  if (!is_in_doubt)
    return;
  m->unstable[1] = 1u << CONIC_UNSTABLE_CUTOFF;
  m->unstable[2] = 1u << CONIC_UNSTABLE_PRECISION; /* of which nothing is known */
  r->alternatives = m->alternatives;
  r->n_alternatives = 2;
  for (int a = 0; a < 2; a++) {
    m->alternatives[a].pixel = 1;
    for (int c = 0; c < CONIC_N_ALTERNATIVE_VALUES; c++) {
      m->alternatives[a].low[c] = a ? 1.0 : 4.0;
      m->alternatives[a].high[c] = a ? 2.0 : 6.0;
    }
  }
}

static int is_right(conic_context *context, const conic_reference *mean, const float rgba[4 * N_PIXELS]) {
  conic_oracle_verdict verdict;
  conic_image image = {.width = N_PIXELS, .height = 1};
  float values[4 * N_PIXELS];
  memcpy(values, rgba, sizeof values);
  image.planes[CONIC_PLANE_RGBA] = values;
  CHECK(conic_oracle_compare(context, mean, &image, &verdict) == CONIC_OK);
  return verdict.wrong_pixels == 0;
}

static void check_mean(conic_context *context) {
  made samples[4];
  conic_reference mean;
  const double values[4] = {0.0, 2.0, 4.0, 8.0}; /* their mean is 3.5 */
  for (int i = 0; i < 4; i++) {
    make_reference(&samples[i], values[i], i == 1);
    CHECK(conic_reference_average(context, &samples[i].reference, (uint64_t)i, &mean) == CONIC_OK);
  }
  CHECK(mean.n_pixels == N_PIXELS && mean.covered_pixels == N_PIXELS && mean.unstable_pixels == 2);
  CHECK(mean.unstable_by_reason[CONIC_UNSTABLE_CUTOFF] == 1 && mean.unstable_by_reason[CONIC_UNSTABLE_PRECISION] == 1);
  for (int i = 0; i < N_PIXELS; i++) {
    CHECK(fabs(mean.planes[CONIC_PLANE_RGBA][4 * i + 3] - (3.5 + i)) < 1e-12);
    CHECK(fabs(mean.planes[CONIC_PLANE_ALBEDO][3 * i + 2] - (3.5 + i)) < 1e-12);
    CHECK(fabs(mean.planes[CONIC_PLANE_WEIGHT][i] - (3.5 + i)) < 1e-12);
  }
  /* Pixel 1 is 1 + 5 + 9 and from 1 to 6, the mean of which is 4 to 5.25. */
  CHECK(fabs(mean.alternatives[1].low[AT_ALBEDO] - 4.0) < 1e-12);
  CHECK(fabs(mean.alternatives[1].high[AT_WEIGHT] - 5.25) < 1e-12);
  CHECK(is_right(context, &mean, (const float[]){3.5f, 3.5f, 3.5f, 3.5f, 4, 4.5f, 5, 5.25f, 0, -7, 1e9f, 3}));
  CHECK(!is_right(context, &mean, (const float[]){3.5f, 3.501f, 3.5f, 3.5f, 4, 4.5f, 5, 5.25f, 0, 0, 0, 0}));
  CHECK(!is_right(context, &mean, (const float[]){3.5f, 3.5f, 3.5f, 3.5f, 3.99f, 4.5f, 5, 5.25f, 0, 0, 0, 0}));
  CHECK(!is_right(context, &mean, (const float[]){3.5f, 3.5f, 3.5f, 3.5f, 4, 4.5f, 5, 5.26f, 0, 0, 0, 0}));
  conic_reference_release(context, &mean);
}

static void check_refusals(conic_context *context) {
  made one, other;
  conic_reference mean;
  make_reference(&one, 1.0, 0);
  make_reference(&other, 1.0, 0);
  CHECK(conic_reference_average(context, &one.reference, 0, &mean) == CONIC_OK);
  other.reference.n_pixels = 2;
  CHECK(conic_reference_average(context, &other.reference, 1, &mean) == CONIC_ERROR_ARGUMENT);
  other.reference.n_pixels = N_PIXELS;
  other.reference.question = CONIC_ORACLE_EXACT;
  CHECK(conic_reference_average(context, &other.reference, 1, &mean) == CONIC_ERROR_ARGUMENT);
  conic_reference_release(context, &mean);
}

int main(void) {
  conic_context *context = check_context(1);
  check_mean(context);
  check_refusals(context);
  conic_context_destroy(context);
  return check_result();
}
