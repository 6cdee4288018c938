#include "core/coloring/value_limits.h"

uint64_t conic_value_stride(uint64_t n, uint64_t most) {
  uint64_t stride = 1;
  while (n > most * stride)
    stride *= 2;
  return stride;
}

void conic_value_sample_add(conic_value_sample *sample, double value) {
  if (!(value - value == 0.0))
    return;
  if (sample->stride == 0)
    sample->stride = 1;
  if (sample->n_seen++ % sample->stride)
    return;
  if (sample->n == CONIC_MOST_VALUES) { /* from now on only every other value is kept; this one is at an even place */
    for (size_t i = 0; i < CONIC_MOST_VALUES / 2; i++)
      sample->values[i] = sample->values[2 * i];
    sample->n /= 2;
    sample->stride *= 2;
  }
  sample->values[sample->n++] = value + 0.0; /* no negative zero */
}

void conic_value_sample_limits(conic_value_sample *sample, double *minimum, double *maximum) {
  *minimum = *maximum = 0.0;
  if (sample->n == 0)
    return;
  size_t last = sample->n - 1, low = last / 50;
  qsort(sample->values, sample->n, sizeof *sample->values, conic_compare_doubles);
  *minimum = sample->values[low];
  *maximum = sample->values[last - low];
  if (*minimum == *maximum) {
    *minimum = sample->values[0];
    *maximum = sample->values[last];
  }
}
