#include "core/base/rank.h"

#include "core/base/base.h"

/* Digits are found from the highest down; at each, only numbers that share the higher digits count. */
enum { RANK_DIGIT_BITS = 11, N_RANK_DIGITS = 1 << RANK_DIGIT_BITS };

/* Bits in the order of the floats. */
static uint32_t order_float(uint32_t bits) {
  return bits >> 31 ? ~bits : bits | UINT32_C(0x80000000);
}

float conic_float_of_rank(const float *values, size_t n, size_t rank) {
  uint32_t prefix = 0;
  for (int shift = 32 - RANK_DIGIT_BITS, above = 32; above > 0; above = shift, shift -= RANK_DIGIT_BITS) {
    size_t counts[N_RANK_DIGITS] = {0};
    shift = shift > 0 ? shift : 0;
    for (size_t i = 0; i < n; i++) {
      uint32_t key = order_float(conic_bits_of_float(values[i]));
      if ((uint64_t)key >> above == prefix)
        counts[key >> shift & ((UINT32_C(1) << (above - shift)) - 1)]++;
    }
    uint32_t digit = 0;
    while (rank >= counts[digit])
      rank -= counts[digit++];
    prefix = prefix << (above - shift) | digit;
  }
  return conic_float_of_bits(prefix >> 31 ? prefix & UINT32_C(0x7fffffff) : ~prefix);
}
