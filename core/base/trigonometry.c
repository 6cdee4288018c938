#include "core/base/trigonometry.h"

/* π/2 in three parts; the first two have zeros in their last 20 bits or more, so that k·part is exact for |k| < 2²⁰. */
static const double half_pi_1 = 0x1.921fb544p+0;
static const double half_pi_2 = 0x1.0b4611a6p-34;
static const double half_pi_3 = 0x1.3198a2e037073p-69;

/* Taylor polynomials on [-π/4, π/4]: the first term left out is below 1e-19. */
static double sin_near_zero(double x) {
  double s = x * x, sum = 0.0;
  for (int n = 17; n >= 3; n -= 2)
    sum = (1.0 - sum) * (s / (double)(n * (n - 1)));
  return x - x * sum;
}

static double cos_near_zero(double x) {
  double s = x * x, sum = 0.0;
  for (int n = 18; n >= 2; n -= 2)
    sum = (1.0 - sum) * (s / (double)(n * (n - 1)));
  return 1.0 - sum;
}

/* x = quarter·π/2 + rest, |rest| ≤ π/4; the quarter modulo 4. */
static int reduce_angle(double x, double *rest) {
  double k = x * (2.0 / CONIC_PI);
  if (!(k > -1e15 && k < 1e15)) {
    *rest = (x - x) / (x - x);
    return 0;
  }
  long long quarter = (long long)(k < 0.0 ? k - 0.5 : k + 0.5);
  k = (double)quarter;
  *rest = ((x - k * half_pi_1) - k * half_pi_2) - k * half_pi_3;
  return (int)(quarter & 3);
}

double conic_sin(double x_rad) {
  double rest;
  switch (reduce_angle(x_rad, &rest)) {
  case 0:
    return sin_near_zero(rest);
  case 1:
    return cos_near_zero(rest);
  case 2:
    return -sin_near_zero(rest);
  default:
    return -cos_near_zero(rest);
  }
}

double conic_cos(double x_rad) {
  double rest;
  switch (reduce_angle(x_rad, &rest)) {
  case 0:
    return cos_near_zero(rest);
  case 1:
    return -sin_near_zero(rest);
  case 2:
    return -cos_near_zero(rest);
  default:
    return sin_near_zero(rest);
  }
}

double conic_tan(double x_rad) {
  return conic_sin(x_rad) / conic_cos(x_rad);
}
