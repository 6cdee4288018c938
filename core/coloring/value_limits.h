/* The range that most of a scan's values lie in, found in one pass and little memory. */
#pragma once

#include "core/base/base.h"

enum { CONIC_MOST_VALUES = 1 << 16 };

/* Every stride-th finite value so far. Zeroed: no value yet. */
typedef struct conic_value_sample {
  uint64_t n_seen, stride; /* stride 0 is 1 */
  size_t n;
  double values[CONIC_MOST_VALUES];
} conic_value_sample;

/* The stride at which of n values in a row at most `most` are kept: it doubles whenever there are more. */
uint64_t conic_value_stride(uint64_t n, uint64_t most);

void conic_value_sample_add(conic_value_sample *sample, double value);

/* The 2nd and the 98th percentile of the sample; its least and largest value where these are equal; both 0 for an empty
 * sample. Sorts the sample: nothing may be added afterwards. */
void conic_value_sample_limits(conic_value_sample *sample, double *minimum, double *maximum);
