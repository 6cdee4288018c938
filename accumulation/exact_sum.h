/* Sums of floats without rounding: fixed-point numbers of 128 bits, half of them behind the point. Adding integers is
 * associative, so the order of a sum does not matter. A float of magnitude 2⁻⁴⁰ to 2³⁸ is held exactly; bits below 2⁻⁶⁴
 * are cut off towards 0. There is room for 2²⁴ summands of up to 2³⁸. */
#pragma once

#include <stdint.h>

#define CONIC_EXACT_SUM_MOST 0x1p38

/* whole + part·2⁻⁶⁴ */
typedef struct conic_exact_sum {
  uint64_t whole; /* two's complement */
  uint64_t part;
} conic_exact_sum;

static inline void conic_exact_merge(conic_exact_sum *sum, conic_exact_sum other) {
  sum->part += other.part;
  sum->whole += other.whole + (sum->part < other.part);
}

static inline conic_exact_sum conic_exact_negative(conic_exact_sum sum) {
  return (conic_exact_sum){~sum.whole + (sum.part == 0), ~sum.part + 1};
}

static inline void conic_exact_add(conic_exact_sum *sum, double summand) {
  double size = summand < 0.0 ? -summand : summand;
  if (!(size > 0.0)) /* NaN, too */
    return;
  if (size > CONIC_EXACT_SUM_MOST)
    size = CONIC_EXACT_SUM_MOST;
  /* Through signed integers, which need no branch for what is above 2⁶³: it would be half of all parts. */
  int64_t whole = (int64_t)size;
  double rest = (size - (double)whole) * 0x1p32;
  int64_t high = (int64_t)rest, low = (int64_t)((rest - (double)high) * 0x1p32);
  conic_exact_sum fixed = {(uint64_t)whole, (uint64_t)high << 32 | (uint64_t)low};
  conic_exact_merge(sum, summand < 0.0 ? conic_exact_negative(fixed) : fixed);
}

static inline double conic_exact_value(conic_exact_sum sum) {
  int is_negative = (sum.whole >> 63) != 0;
  conic_exact_sum size = is_negative ? conic_exact_negative(sum) : sum;
  double value = (double)size.whole + (double)size.part * 0x1p-64;
  return is_negative ? -value : value;
}
