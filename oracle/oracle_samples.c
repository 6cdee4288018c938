/* The oracle's pixel of N × N samples: docs/reference/picture.md, "Samples". */

#include "oracle/oracle_bounds.h"

/* A mean normal shorter than this makes more of the samples' rounding than the bound of a normal allows. */
static const double shortest_mean = 0.1;

/* How far sample i is from the centre, in half samples, squared. */
static double distance(int i, int n) {
  const int row = i / n;
  double dx = 2 * (i % n) + 1 - n, dy = 2 * row + 1 - n;
  return dx * dx + dy * dy;
}

static int is_averaged(int channel) {
  return channel < ORACLE_AT_Z || (channel >= ORACLE_AT_ALBEDO && channel <= ORACLE_AT_WEIGHT);
}

/* Means of rgba, albedo and weight, the greatest count, and Z and id of the sample in the middle. */
static void reduce_values(const oracle_sample *samples, int n, int middle, oracle_sample *pixel) {
  for (int c = 0; c < CONIC_N_ALTERNATIVE_VALUES; c++) {
    double sum = 0.0, greatest = 0.0;
    for (int i = 0; i < n * n; i++) {
      sum += samples[i].values[c];
      greatest = oracle_max(greatest, samples[i].values[c]);
    }
    if (is_averaged(c))
      pixel->values[c] = sum / (double)(n * n);
    else
      pixel->values[c] = c == ORACLE_AT_COUNT ? greatest : samples[middle].values[c];
  }
  pixel->id = samples[middle].id;
}

/* The normalised mean over what is covered; the reasons why it is in doubt. */
static unsigned reduce_normal(const oracle_sample *samples, int n, double normal[3]) {
  double sum[3] = {0.0, 0.0, 0.0}, n_covered = 0.0;
  const oracle_sample *central = NULL;
  for (int i = 0; i < n * n; i++) {
    if (samples[i].values[ORACLE_AT_COUNT] == 0.0)
      continue;
    if (!central || distance(i, n) < distance((int)(central - samples), n))
      central = &samples[i];
    for (int axis = 0; axis < 3; axis++)
      sum[axis] += samples[i].values[ORACLE_AT_NORMAL + axis];
    n_covered += 1.0;
  }
  double length = oracle_length(sum);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = length > 0.0 ? sum[axis] / length : central ? central->values[ORACLE_AT_NORMAL + axis] : 0.0;
  return length < shortest_mean * n_covered ? 1u << CONIC_UNSTABLE_PRECISION : 0u;
}

/* All that a sample's alternatives allow together. */
static void take_together(const oracle_sample *sample, const oracle_doubts *from, conic_alternative *range) {
  memcpy(range->low, sample->values, sizeof range->low);
  memcpy(range->high, sample->values, sizeof range->high);
  for (size_t i = 0; i < sample->n_alternatives; i++)
    for (int c = 0; c < CONIC_N_ALTERNATIVE_VALUES; c++) {
      const conic_alternative *next = &from->alternatives[sample->first_alternative + i];
      range->low[c] = i ? oracle_min(range->low[c], next->low[c]) : next->low[c];
      range->high[c] = i ? oracle_max(range->high[c], next->high[c]) : next->high[c];
    }
}

/* Adds a sample to the sums that reduce_values and reduce_normal make of samples; each of its normals' components may
 * be off by its bound. */
static void add_sample_range(const conic_alternative *sample, int n, conic_alternative *sum) {
  for (int c = 0; c < CONIC_N_ALTERNATIVE_VALUES; c++) {
    int is_normal = c >= ORACLE_AT_NORMAL && c<ORACLE_AT_ALBEDO, is_covered = sample->high[ORACLE_AT_COUNT]> 0.0;
    double share = is_averaged(c) ? 1.0 / (double)(n * n) : 1.0;
    double error = is_normal && is_covered ? ORACLE_NORMAL_BOUND : 0.0;
    if (c == ORACLE_AT_COUNT) {
      sum->low[c] = oracle_max(sum->low[c], sample->low[c]);
      sum->high[c] = oracle_max(sum->high[c], sample->high[c]);
    } else if (c != ORACLE_AT_Z) {
      sum->low[c] += share * sample->low[c] - error;
      sum->high[c] += share * sample->high[c] + error;
    }
  }
}

/* The pixel's alternative for one of the middle sample's. */
static conic_status add_alternative(const conic_alternative *others, const conic_alternative *middle, int n,
                                    uint32_t number, oracle_doubts *to) {
  conic_alternative pixel = *others;
  double box[2][3];
  add_sample_range(middle, n, &pixel);
  pixel.pixel = number;
  pixel.low[ORACLE_AT_Z] = middle->low[ORACLE_AT_Z];
  pixel.high[ORACLE_AT_Z] = middle->high[ORACLE_AT_Z];
  memcpy(box[0], pixel.low + ORACLE_AT_NORMAL, sizeof box[0]);
  memcpy(box[1], pixel.high + ORACLE_AT_NORMAL, sizeof box[1]);
  if (pixel.high[ORACLE_AT_COUNT] > 0.0)
    conic_oracle_direction_range((const double(*)[3])box, pixel.low + ORACLE_AT_NORMAL, pixel.high + ORACLE_AT_NORMAL);
  return conic_oracle_doubts_add(to, &pixel);
}

/* One alternative for each of the middle sample's: of the others, all that they may be goes into the sums. */
static conic_status reduce_doubts(const oracle_sample *samples, int n, int middle, const oracle_doubts *from,
                                  uint32_t number, oracle_doubts *to) {
  conic_alternative others = {.pixel = number}, one;
  const oracle_sample *central = &samples[middle];
  conic_status status = CONIC_OK;
  for (int i = 0; i < n * n; i++) {
    if (i == middle)
      continue;
    take_together(&samples[i], from, &one);
    add_sample_range(&one, n, &others);
  }
  if (!central->n_alternatives) {
    take_together(central, from, &one);
    return add_alternative(&others, &one, n, number, to);
  }
  for (size_t i = 0; i < central->n_alternatives && status == CONIC_OK; i++)
    status = add_alternative(&others, &from->alternatives[central->first_alternative + i], n, number, to);
  return status;
}

conic_status conic_oracle_reduce(const oracle_sample *samples, int n, const oracle_doubts *from, uint32_t number,
                                 oracle_doubts *to, oracle_sample *pixel) {
  int middle = (n - 1) / 2 * n + (n - 1) / 2, has_alternatives = 0;
  conic_status status = CONIC_OK;
  memset(pixel, 0, sizeof *pixel);
  reduce_values(samples, n, middle, pixel);
  if (n > 1)
    pixel->doubt = reduce_normal(samples, n, pixel->values + ORACLE_AT_NORMAL);
  for (int i = 0; i < n * n; i++) {
    pixel->doubt |= samples[i].doubt;
    pixel->is_unbounded |= samples[i].is_unbounded;
    has_alternatives |= samples[i].n_alternatives > 0;
  }
  pixel->first_alternative = to->n;
  pixel->first_id = to->n_ids;
  if (n == 1)
    for (size_t i = 0; i < samples->n_alternatives && status == CONIC_OK; i++) {
      conic_alternative one = from->alternatives[samples->first_alternative + i];
      one.pixel = number;
      status = conic_oracle_doubts_add(to, &one);
    }
  else if (has_alternatives || pixel->doubt)
    status = reduce_doubts(samples, n, middle, from, number, to);
  if (to->n > pixel->first_alternative && !samples[middle].n_alternatives && status == CONIC_OK)
    status = conic_oracle_doubts_admit(to, pixel->first_id, number, pixel->id);
  for (size_t i = 0; i < samples[middle].n_ids && status == CONIC_OK; i++)
    status = conic_oracle_doubts_admit(to, pixel->first_id, number, from->ids[samples[middle].first_id + i].id);
  pixel->n_alternatives = to->n - pixel->first_alternative;
  pixel->n_ids = to->n_ids - pixel->first_id;
  return status;
}
