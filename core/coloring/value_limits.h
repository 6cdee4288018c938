/* Between which values most of a scan's lie, found in one pass and little memory. */
#ifndef CONIC_VALUE_LIMITS_H
#define CONIC_VALUE_LIMITS_H

#include <stddef.h>
#include <stdint.h>

enum { CONIC_MOST_VALUES = 1 << 16 };

/* Every stride-th of the finite values that came. Zeroed: none came. */
typedef struct conic_value_sample {
  uint64_t n_seen, stride; /* stride 0 is 1 */
  size_t n;
  double values[CONIC_MOST_VALUES];
} conic_value_sample;

/* Of n in a row every how many-th are taken, where that doubles whenever there are more than `most`. */
uint64_t conic_value_stride(uint64_t n, uint64_t most);

void conic_value_sample_add(conic_value_sample *sample, double value);

/* The 2nd and the 98th percentile of the sample, or its least and largest value where those are the same; both 0 where
 * there is none. Sorts the sample: nothing is added afterwards. */
void conic_value_sample_limits(conic_value_sample *sample, double *minimum, double *maximum);

#endif
