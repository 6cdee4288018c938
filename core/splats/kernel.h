/* Reconstruction kernels, as functions of q = r², r in standard deviations: unit peak at 0, falling to the cutoff.
 * The same bits everywhere: + − × ÷ √ and integer operations only. */
#ifndef CONIC_KERNEL_H
#define CONIC_KERNEL_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "conic/render.h"

/* eˣ for x ≤ 0, clamped below at e⁻⁸⁰; NaN gives e⁻⁸⁰. Error at most 1.1 ulp (tests/core/splats/test_kernel.c). */
static inline float conic_exp_negative(float x) {
  x = x > -80.0f ? x : -80.0f;
  /* x = k·ln 2 + r with |r| ≤ ½·ln 2; truncation rounds to nearest here, since x ≤ 0. The first part of ln 2 has few
   * bits, so that k·ln 2 is exact in it. */
  int32_t k = (int32_t)(x * 0x1.715476p+0f - 0.5f);
  float r = (x - (float)k * 0x1.63p-1f) + (float)k * 0x1.bd0106p-13f;
  float p = 0x1.6a23cap-10f;
  p = p * r + 0x1.123a20p-7f;
  p = p * r + 0x1.5558f2p-5f;
  p = p * r + 0x1.555492p-3f;
  p = p * r + 0x1.fffffcp-2f;
  p = (p * (r * r) + r) + 1.0f;
  int32_t bits;
  memcpy(&bits, &p, sizeof bits);
  bits += k * (1 << 23);
  memcpy(&p, &bits, sizeof bits);
  return p;
}

/* Up to here, the square of a cutoff of 1.5, the Gaussian has a polynomial of its own. */
#define CONIC_NARROW_SUPPORT 2.25f

/* e^(-q/2) for 0 ≤ q ≤ 2.25: the minimax polynomial about the middle. Its sum is shallow, a third of the exponential's
 * depth, because what a pixel waits for is this. Relative error at most 2.4e-7; exactly 1 at 0
 * (tests/core/splats/test_kernel.c).
 */
static inline float conic_gauss_narrow(float q) {
  float t = q - 1.125f, t2 = t * t, t4 = t2 * t2;
  float a = 0x1.23ba94p-1f + -0x1.23ba94p-2f * t, b = 0x1.23ba98p-4f + -0x1.84f89ap-7f * t;
  float c = 0x1.84f19cp-10f + -0x1.373c6ep-13f * t, d = 0x1.a3885cp-17f + -0x1.d6063cp-21f * t;
  return (a + t2 * b) + t4 * (c + t2 * d);
}

/* Confetti Eq. 10, corrected: exp(-a (r/b)ⁿ / (1 - (r/b)ⁿ)) for q < b². */
static inline float conic_kernel_confetti(const conic_kernel *kernel, float q) {
  float r = sqrtf(q) / kernel->b, power = r;
  for (int i = 1; i < kernel->n; i++)
    power *= r;
  float rest = 1.0f - power;
  return rest > 0.0f ? conic_exp_negative(-kernel->a * power / rest) : 0.0f;
}

static inline int conic_kernel_is_narrow(const conic_kernel *kernel) {
  return kernel->type == CONIC_KERNEL_GAUSS && kernel->cutoff * kernel->cutoff <= CONIC_NARROW_SUPPORT;
}

/* The kernel at q, 0 ≤ q < conic_kernel_support. */
static inline float conic_kernel_value(const conic_kernel *kernel, float q) {
  switch (kernel->type) {
  case CONIC_KERNEL_CONFETTI:
    return conic_kernel_confetti(kernel, q);
  case CONIC_KERNEL_HAT:
    return 1.0f - sqrtf(q) / kernel->cutoff;
  case CONIC_KERNEL_BOX:
    return 1.0f;
  default:
    return conic_kernel_is_narrow(kernel) ? conic_gauss_narrow(q) : conic_exp_negative(-0.5f * q);
  }
}

/* A pixel is covered where q is below this: the square of the cutoff, or of Confetti's b where that is smaller. */
static inline float conic_kernel_support(const conic_kernel *kernel) {
  float support = kernel->cutoff;
  if (kernel->type == CONIC_KERNEL_CONFETTI && kernel->b < support)
    support = kernel->b;
  return support * support;
}

#endif
