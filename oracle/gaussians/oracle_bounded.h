/* Arithmetic with bounds: a number in double, and how far off a renderer may have it.
 *
 * Every operation carries the bounds of its operands by their exact worst case, and adds what its own rounding may do:
 * `unit` of the largest value that it may round. So a bound holds whatever each rounding does, and also where there is
 * none, as in a fused product. (Wilkinson's running error analysis.) */
#pragma once

#include "oracle/oracle_math.h"

/* The unit roundoff of float, with room for the roundings of these doubles; and what underflow may do. */
#define ORACLE_FLOAT_UNIT (0x1p-24 * (1.0 + 1e-6))
#define ORACLE_UNDERFLOW 1e-44

typedef struct bounded {
  double v, off;
} bounded;

static inline bounded bounded_of(double v) {
  return (bounded){v, 0.0};
}
/* Rounded n times. */
static inline bounded bounded_rounded(bounded a, double unit) {
  return (bounded){a.v, a.off + unit * (fabs(a.v) + a.off) + ORACLE_UNDERFLOW};
}
static inline bounded bounded_add(bounded a, bounded b, double unit) {
  return bounded_rounded((bounded){a.v + b.v, a.off + b.off}, unit);
}
static inline bounded bounded_subtract(bounded a, bounded b, double unit) {
  return bounded_rounded((bounded){a.v - b.v, a.off + b.off}, unit);
}
static inline bounded bounded_multiply(bounded a, bounded b, double unit) {
  return bounded_rounded((bounded){a.v * b.v, fabs(a.v) * b.off + fabs(b.v) * a.off + a.off * b.off}, unit);
}
static inline bounded bounded_scale(double a, bounded b, double unit) {
  return bounded_rounded((bounded){a * b.v, fabs(a) * b.off}, unit);
}
/* Unbounded where the divisor may be zero. */
static inline bounded bounded_divide(bounded a, bounded b, double unit) {
  double least = fabs(b.v) - b.off;
  if (!(least > 0.0))
    return (bounded){b.v != 0.0 ? a.v / b.v : 0.0, INFINITY};
  return bounded_rounded((bounded){a.v / b.v, (a.off + fabs(a.v / b.v) * b.off) / least}, unit);
}
static inline bounded bounded_root(bounded a, double unit) {
  double v = sqrt(oracle_max(a.v, 0.0)), low = sqrt(oracle_max(a.v - a.off, 0.0)),
         high = sqrt(oracle_max(a.v, 0.0) + a.off);
  return bounded_rounded((bounded){v, oracle_max(v - low, high - v)}, unit);
}
static inline bounded bounded_dot(const bounded a[3], const bounded b[3], double unit) {
  bounded sum = bounded_add(bounded_multiply(a[0], b[0], unit), bounded_multiply(a[1], b[1], unit), unit);
  return bounded_add(sum, bounded_multiply(a[2], b[2], unit), unit);
}
static inline void bounded_cross(const bounded a[3], const bounded b[3], double unit, bounded result[3]) {
  for (int k = 0; k < 3; k++) {
    int l = (k + 1) % 3, m = (k + 2) % 3;
    result[k] = bounded_subtract(bounded_multiply(a[l], b[m], unit), bounded_multiply(a[m], b[l], unit), unit);
  }
}
static inline double bounded_low(bounded a) {
  return a.v - a.off;
}
static inline double bounded_high(bounded a) {
  return a.v + a.off;
}
static inline int bounded_is_finite(bounded a) {
  return oracle_is_finite(a.v) && oracle_is_finite(a.off);
}
/* The nearest place from low to high. */
static inline bounded bounded_within(bounded a, double low, double high) {
  const double v = oracle_min(oracle_max(a.v, low), high), down = oracle_min(oracle_max(bounded_low(a), low), high);
  const double up = oracle_min(oracle_max(bounded_high(a), low), high);
  return (bounded){v, oracle_max(v - down, up - v)};
}
