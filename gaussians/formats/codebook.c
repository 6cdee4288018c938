#include "gaussians/formats/codebook.h"

#include "core/base/power.h"

enum { BINS = 65536, ROUNDS = 12 };

/* How many numbers lie in each of equal steps, and what they add up to. */
typedef struct histogram {
  double counts[BINS], sums[BINS];
} histogram;

/* Whether there are no more than 256 values; then these, ascending, the last repeated. */
static int find_all_values(const void *numbers, conic_number_at *number_at, size_t n, float codebook[CONIC_CODES]) {
  int n_found = 0;
  for (size_t i = 0; i < n; i++) {
    float value = number_at(numbers, i);
    int low = 0, high = n_found;
    if (value - value != 0.0f)
      continue;
    while (low < high) {
      int middle = (low + high) / 2;
      if (codebook[middle] < value)
        low = middle + 1;
      else
        high = middle;
    }
    if (low < n_found && codebook[low] == value)
      continue;
    if (n_found == CONIC_CODES)
      return 0;
    memmove(codebook + low + 1, codebook + low, (size_t)(n_found - low) * sizeof *codebook);
    codebook[low] = value;
    n_found++;
  }
  for (int i = n_found; i < CONIC_CODES; i++)
    codebook[i] = n_found ? codebook[n_found - 1] : 0.0f;
  return 1;
}

/* As many values where numbers are as their density's cube root asks for: what loses least where steps are small. */
static void place_first(const histogram *found, float codebook[CONIC_CODES]) {
  double all = 0.0, passed = 0.0;
  int code = 0;
  for (int bin = 0; bin < BINS; bin++)
    all += found->counts[bin] > 0.0 ? conic_cube_root(found->counts[bin]) : 0.0;
  for (int bin = 0; bin < BINS && code < CONIC_CODES; bin++) {
    passed += found->counts[bin] > 0.0 ? conic_cube_root(found->counts[bin]) : 0.0;
    while (code < CONIC_CODES && passed >= all * ((double)code + 0.5) / CONIC_CODES)
      codebook[code++] = (float)(found->sums[bin] / (found->counts[bin] > 0.0 ? found->counts[bin] : 1.0));
  }
  for (; code < CONIC_CODES; code++)
    codebook[code] = codebook[code - 1];
}

/* Lloyd's round: each value becomes the mean of the numbers that are nearest to it. */
static void improve_codes(const histogram *found, float codebook[CONIC_CODES]) {
  double sum = 0.0, count = 0.0;
  int code = 0;
  for (int bin = 0; bin < BINS; bin++) {
    double mean = found->counts[bin] > 0.0 ? found->sums[bin] / found->counts[bin] : 0.0;
    if (found->counts[bin] == 0.0)
      continue;
    while (code < CONIC_CODES - 1 && mean > 0.5 * ((double)codebook[code] + (double)codebook[code + 1])) {
      if (count > 0.0)
        codebook[code] = (float)(sum / count);
      code++;
      sum = count = 0.0;
    }
    sum += found->sums[bin];
    count += found->counts[bin];
  }
  if (count > 0.0)
    codebook[code] = (float)(sum / count);
}

conic_status conic_codebook_make(conic_context *context, const void *numbers, conic_number_at *number_at, size_t n,
                                 float codebook[CONIC_CODES]) {
  double low = 0.0, high = 0.0;
  int is_begun = 0;
  if (find_all_values(numbers, number_at, n, codebook))
    return CONIC_OK;
  histogram *found = conic_memory_allocate_zeroed(context, 1, sizeof *found);
  if (!found)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++) {
    double value = (double)number_at(numbers, i);
    if (!conic_is_finite(value))
      continue;
    low = !is_begun || value < low ? value : low;
    high = !is_begun || value > high ? value : high;
    is_begun = 1;
  }
  for (size_t i = 0; i < n; i++) {
    double value = (double)number_at(numbers, i);
    if (!conic_is_finite(value))
      continue;
    int bin = (int)((value - low) / (high - low) * (BINS - 1));
    found->counts[bin]++;
    found->sums[bin] += value;
  }
  place_first(found, codebook);
  for (int i = 0; i < ROUNDS; i++)
    improve_codes(found, codebook);
  conic_memory_release(context, found);
  return CONIC_OK;
}

unsigned char conic_codebook_find(const float codebook[CONIC_CODES], float value) {
  int low = 0, high = CONIC_CODES - 1;
  while (low < high) {
    int middle = (low + high) / 2;
    if (codebook[middle] < value)
      low = middle + 1;
    else
      high = middle;
  }
  if (low > 0 && value - codebook[low - 1] < codebook[low] - value)
    low--;
  return (unsigned char)low;
}
