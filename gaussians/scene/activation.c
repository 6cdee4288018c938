#include "gaussians/scene/activation.h"

#include "core/base/base.h"
#include "core/base/power.h"

/* e^x, to a few units of double's last place, without a branch, so that compilers do several at a time. Beyond ±150 all
 * floats are 0 or infinite. */
static double exponential(double x) {
  const double ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33, to_integer = 0x1.8p52;
  x = x < -150.0 ? -150.0 : x;
  x = x > 150.0 ? 150.0 : x;
  double shifted = x * 1.44269504088896340736 + to_integer, k = shifted - to_integer;
  double r = (x - k * ln2_high) - k * ln2_low, sum = 1.0 / 6227020800.0;
  sum = sum * r + 1.0 / 479001600.0;
  sum = sum * r + 1.0 / 39916800.0;
  sum = sum * r + 1.0 / 3628800.0;
  sum = sum * r + 1.0 / 362880.0;
  sum = sum * r + 1.0 / 40320.0;
  sum = sum * r + 1.0 / 5040.0;
  sum = sum * r + 1.0 / 720.0;
  sum = sum * r + 1.0 / 120.0;
  sum = sum * r + 1.0 / 24.0;
  sum = sum * r + 1.0 / 6.0;
  sum = sum * r + 0.5;
  sum = sum * r + 1.0;
  sum = sum * r + 1.0;
  return sum * conic_double_of_bits((conic_bits_of_double(shifted) + 1023) << 52); /* k stands in the last bits */
}

float conic_scale_of_log(float log_scale) {
  return (float)exponential((double)log_scale);
}

float conic_opacity_of_logit(float logit) {
  return (float)(1.0 / (1.0 + exponential(-(double)logit)));
}

static float no_number(void) {
  return conic_float_of_bits(0x7fc00000);
}

float conic_log_of_scale(float scale) {
  if (scale == 0.0f)
    return -110.0f; /* rounds to 0 */
  if (!(scale > 0.0f))
    return scale - scale == 0.0f ? no_number() : scale;
  return scale - scale == 0.0f ? (float)conic_logarithm((double)scale) : 100.0f;
}

float conic_logit_of_opacity(float opacity) {
  if (opacity == 0.0f)
    return -110.0f;
  if (opacity == 1.0f)
    return 20.0f; /* rounds to 1 */
  if (!(opacity > 0.0f && opacity < 1.0f))
    return no_number();
  return (float)(conic_logarithm((double)opacity) - conic_logarithm(1.0 - (double)opacity));
}

void conic_gaussians_activate(conic_gaussians *gaussians, size_t first, size_t n) {
  for (int axis = 0; axis < 3; axis++) {
    float *scale = gaussians->scale[axis] ? gaussians->scale[axis] + first : NULL;
    if (scale && gaussians->log_scale[axis])
      memcpy(gaussians->log_scale[axis] + first, scale, n * sizeof *scale);
    for (size_t i = 0; scale && i < n; i++)
      scale[i] = (float)exponential((double)scale[i]);
  }
  float *opacity = gaussians->opacity + first;
  if (gaussians->logit_opacity)
    memcpy(gaussians->logit_opacity + first, opacity, n * sizeof *opacity);
  for (size_t i = 0; i < n; i++)
    opacity[i] = (float)(1.0 / (1.0 + exponential(-(double)opacity[i])));
}
