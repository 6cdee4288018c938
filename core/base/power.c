#include "core/base/power.h"

#include "core/base/base.h"
#include "core/base/gaussian.h"

/* v = m·2^e, m in [½, 1), exact. */
static double split_number(double v, int *exponent) {
  uint64_t bits;
  if (v < 0x1p-1022)
    return frexp(v, exponent);
  memcpy(&bits, &v, sizeof bits);
  *exponent = (int)(bits >> 52) - 1022;
  bits = (bits & UINT64_C(0xfffffffffffff)) | UINT64_C(1022) << 52;
  memcpy(&v, &bits, sizeof v);
  return v;
}

/* By the series of artanh((m − 1)/(m + 1)) with v = m·2^e. */
double conic_logarithm(double v) {
  int exponent;
  double m = split_number(v, &exponent);
  if (m < 0.70710678118654752) {
    m *= 2.0;
    exponent--;
  }
  double t = (m - 1.0) / (m + 1.0), t_squared = t * t, sum = 0.0;
  for (int k = 23; k >= 1; k -= 2) /* |t| < 0.172: the first term left out is under 1e-20 */
    sum = sum * t_squared + 1.0 / (double)k;
  return (double)exponent * 0.69314718055994530942 + 2.0 * t * sum;
}

double conic_power(double base, double exponent) {
  return base > 0.0 ? conic_gaussian_exp(exponent * conic_logarithm(base)) : 0.0;
}

double conic_root_guess(double v, int n) {
  uint64_t bits, one = UINT64_C(0x3ff0000000000000);
  memcpy(&bits, &v, sizeof bits);
  int64_t log_scaled = ((int64_t)bits - (int64_t)one) / n;
  bits = (uint64_t)((int64_t)one + log_scaled);
  memcpy(&v, &bits, sizeof bits);
  return v;
}

double conic_cube_root(double v) {
  double r = conic_root_guess(v, 3);
  for (int i = 0; i < 5; i++)
    r = r - (r - v / (r * r)) / 3.0;
  return r;
}
