#include "core/base/gaussian.h"

#include "core/base/base.h"
#include "core/base/color.h"
#include "core/base/vectors.h"

/* ln 2 in two parts; the first has zeros in its last bits, so that k·ln2_high is exact. */
static const double ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33;

double conic_gaussian_exp(double x) {
  if (x != x)
    return x;
  if (x > 709.8)
    return conic_power_of_two(1023) * 2.0;
  if (x < -745.2)
    return 0.0;
  int k = (int)(x * (1.0 / (ln2_high + ln2_low)) + (x < 0.0 ? -0.5 : 0.5));
  double rest = (x - (double)k * ln2_high) - (double)k * ln2_low, sum = 1.0;
  for (int n = 14; n >= 2; n--) /* Taylor's series; |rest| < 0.35, the first term left out is below 1e-18 */
    sum = 1.0 + sum * rest / (double)n;
  sum = 1.0 + sum * rest;
  int half = k / 2; /* in two steps, as 2^k alone may be no normal number */
  return sum * conic_power_of_two(half) * conic_power_of_two(k - half);
}

double conic_gaussian_opacity(double logit) {
  return 1.0 / (1.0 + conic_gaussian_exp(-logit));
}

double conic_gaussian_color(double harmonic) {
  double encoded = 0.5 + 0.28209479177387814 * harmonic;
  return encoded > 0.0 ? conic_srgb_decode(encoded) : 0.0;
}

void conic_gaussian_axes(const double log_scales[3], int n_scales, const double rotation[4], double tangent_u[3],
                         double tangent_v[3]) {
  double q[4], rows[3][3], length2 = 0.0;
  int i_normal = 2;
  for (int i = 0; i < 4; i++)
    length2 += rotation[i] * rotation[i];
  double scale = length2 > 0.0 && length2 - length2 == 0.0 ? 1.0 / sqrt(length2) : 0.0;
  for (int i = 0; i < 4; i++)
    q[i] = rotation[i] * scale;
  if (n_scales == 3)
    for (int i = i_normal = 0; i < 3; i++)
      if (log_scales[i] < log_scales[i_normal])
        i_normal = i;
  int i_u = (i_normal + 1) % 3, i_v = (i_normal + 2) % 3; /* t_u × t_v is the normal */
  conic_rotation_of(q, rows);
  double size_u = scale > 0.0 ? conic_gaussian_exp(log_scales[i_u]) : 0.0;
  double size_v = scale > 0.0 ? conic_gaussian_exp(log_scales[i_v]) : 0.0;
  for (int axis = 0; axis < 3; axis++) {
    tangent_u[axis] = rows[axis][i_u] * size_u;
    tangent_v[axis] = rows[axis][i_v] * size_v;
  }
}
