#include "core/base/trigonometry.h"

#include <math.h>

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

/* Halves the angle until the series of the arc sine is short. */
double conic_angle(double y, double x) {
  double length = sqrt(x * x + y * y), cosine = x / length, sine = fabs(y) / length, sum = 0.0, term;
  if (!(length > 0.0))
    return 0.0;
  for (int i = 0; i < 5; i++) {
    double larger = sqrt(0.5 * (1.0 + fabs(cosine))), lesser = 0.5 * sine / larger;
    sine = cosine > 0.0 ? lesser : larger;
    cosine = cosine > 0.0 ? larger : lesser;
  }
  term = 32.0 * sine;
  for (int n = 1; n < 16; n += 2) {
    sum += term / (double)n;
    term *= sine * sine * (double)n / (double)(n + 1);
  }
  return y < 0.0 ? -sum : sum;
}
