/* Two dimensions of a sequence that fills the square evenly: the first two of Sobol's. */
#ifndef CONIC_SEQUENCE_H
#define CONIC_SEQUENCE_H

#include <stdint.h>

static inline double conic_lighting_sequence(uint64_t i, int dimension) {
  uint64_t bits = 0, column = UINT64_C(1) << 63;
  for (; i; i >>= 1) {
    if (i & 1)
      bits ^= column;
    column = dimension ? column ^ column >> 1 : column >> 1;
  }
  return (double)(bits >> 11) * 0x1p-53;
}

#endif
