/* The reference of a picture that is the mean of several: what each of them may be, averaged. */

#include "oracle/oracle_pixel.h"

/* The planes whose means are means, and where their channels stand in an alternative. */
static const struct {
  conic_plane plane;
  int at, n;
} averaged[] = {{CONIC_PLANE_RGBA, ORACLE_AT_RGBA, 4},
                {CONIC_PLANE_ALBEDO, ORACLE_AT_ALBEDO, 3},
                {CONIC_PLANE_WEIGHT, ORACLE_AT_WEIGHT, 1}};
enum { N_AVERAGED = 3 };

/* Room for a mean of pictures such as `sample`, of none of them yet: one range a pixel. */
static conic_status begin_mean(conic_context *context, const conic_reference *sample, conic_reference *mean) {
  size_t n = sample->n_pixels;
  memset(mean, 0, sizeof *mean);
  mean->width = sample->width;
  mean->height = sample->height;
  mean->samples = sample->samples;
  mean->white = sample->white;
  mean->n_pixels = mean->n_alternatives = n;
  conic_status status =
      conic_memory_allocate_these(context, CONIC_ZEROED(mean->unstable, n), CONIC_ZEROED(mean->alternatives, n));
  for (int i = 0; i < CONIC_N_DRAWN_PLANES && status == CONIC_OK; i++) {
    size_t n_channels = (size_t)conic_plane_describe((conic_plane)i)->n_channels;
    status = conic_memory_allocate_these(context, CONIC_ZEROED(mean->planes[i], n_channels * n));
  }
  if (status == CONIC_OK && sample->pixels)
    status = conic_memory_allocate_these(context, CONIC_ROOM(mean->pixels, n));
  if (mean->pixels)
    memcpy(mean->pixels, sample->pixels, n * sizeof *mean->pixels);
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    mean->alternatives[i].pixel = (uint32_t)i;
  return status;
}

/* What a channel of a pixel may be: all that its alternatives allow, which are from `first` to before `end`. */
static void sample_range(const conic_reference *sample, size_t i, int k, int c, size_t first, size_t end, double *low,
                         double *high) {
  int at = averaged[k].at + c;
  *low = *high = sample->planes[averaged[k].plane][(size_t)averaged[k].n * i + (size_t)c];
  if (sample->unstable[i] && first == end) { /* nobody knows */
    *low = -INFINITY;
    *high = INFINITY;
  }
  for (size_t a = first; a < end; a++) {
    const conic_alternative *alternative = &sample->alternatives[a];
    *low = a == first ? alternative->low[at] : oracle_min(*low, alternative->low[at]);
    *high = a == first ? alternative->high[at] : oracle_max(*high, alternative->high[at]);
  }
}

static void average_pixel(conic_reference *mean, double n_before, const conic_reference *sample, size_t i, size_t first,
                          size_t end) {
  conic_alternative *ranges = &mean->alternatives[i];
  double part = 1.0 / (n_before + 1.0), rest = n_before * part;
  for (int k = 0; k < N_AVERAGED; k++)
    for (int c = 0; c < averaged[k].n; c++) {
      int at = averaged[k].at + c;
      double low, high, *value = &mean->planes[averaged[k].plane][(size_t)averaged[k].n * i + (size_t)c];
      sample_range(sample, i, k, c, first, end, &low, &high);
      *value = rest * *value + part * sample->planes[averaged[k].plane][(size_t)averaged[k].n * i + (size_t)c];
      ranges->low[at] = rest * ranges->low[at] + part * low; /* infinite it stays */
      ranges->high[at] = rest * ranges->high[at] + part * high;
    }
  double *count = &mean->planes[CONIC_PLANE_COUNT][i];
  *count = oracle_max(*count, sample->planes[CONIC_PLANE_COUNT][i]);
  mean->unstable[i] |= sample->unstable[i];
}

static void count_pixels(conic_reference *mean) {
  mean->covered_pixels = mean->unstable_pixels = 0;
  memset(mean->unstable_by_reason, 0, sizeof mean->unstable_by_reason);
  for (size_t i = 0; i < mean->n_pixels; i++) {
    mean->covered_pixels += mean->planes[CONIC_PLANE_COUNT][i] > 0.0;
    mean->unstable_pixels += mean->unstable[i] != 0;
    for (int k = 0; k < CONIC_N_UNSTABLE_REASONS; k++)
      mean->unstable_by_reason[k] += mean->unstable[i] >> k & 1;
  }
}

conic_status conic_reference_average(conic_context *context, const conic_reference *sample, uint64_t n_before,
                                     conic_reference *mean) {
  if (sample->question != CONIC_ORACLE_METHOD ||
      (n_before && (sample->n_pixels != mean->n_pixels || sample->width != mean->width)))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the oracle: no mean of these: other pixels, or not the method");
  if (!n_before) {
    conic_status status = begin_mean(context, sample, mean);
    if (status != CONIC_OK) {
      conic_reference_release(context, mean);
      return status;
    }
  }
  size_t first = 0;
  for (size_t i = 0; i < sample->n_pixels; i++) {
    size_t end = first;
    while (end < sample->n_alternatives && sample->alternatives[end].pixel == i)
      end++;
    average_pixel(mean, (double)n_before, sample, i, first, end);
    first = end;
  }
  mean->unbounded_pixels =
      mean->unbounded_pixels < sample->unbounded_pixels ? sample->unbounded_pixels : mean->unbounded_pixels;
  count_pixels(mean);
  return CONIC_OK;
}
