/* Reconstruction kernels, as functions of q = r², r in standard deviations: unit peak at 0, falling to the cutoff.
 * The same bits everywhere: + − × ÷ √ and integer operations only. */
#pragma once

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

/* What kernels differ in besides their values. */
#define CONIC_IS_GAUSSIAN 1u    /* blurred by the prefilter it is one again: it needs no profile */
#define CONIC_HAS_PARAMETERS 2u /* a, b and n count, and it ends at b */
#define CONIC_IS_FLAT 4u        /* no lower at its rim: its profile is known from there inwards */

/* All kernels: DO with the constant, the option's word, and that. */
#define CONIC_FOR_KERNELS(DO)                                                                                          \
  DO(CONIC_KERNEL_GAUSS, "gauss", CONIC_IS_GAUSSIAN)                                                                   \
  DO(CONIC_KERNEL_CONFETTI, "confetti", CONIC_HAS_PARAMETERS)                                                          \
  DO(CONIC_KERNEL_HAT, "hat", 0u)                                                                                      \
  DO(CONIC_KERNEL_BOX, "box", CONIC_IS_FLAT)

#define CONIC_COUNT_KERNEL(type, word, traits) +1 /* NOLINT(bugprone-macro-parentheses): a sum of them */
_Static_assert(CONIC_N_KERNELS == CONIC_FOR_KERNELS(CONIC_COUNT_KERNEL), "CONIC_N_KERNELS is not how many there are");

static inline unsigned conic_kernel_traits(const conic_kernel *kernel) {
#define CONIC_TRAITS_OF_KERNEL(type, word, traits)                                                                     \
  case type:                                                                                                           \
    return traits;
  switch (kernel->type) { CONIC_FOR_KERNELS(CONIC_TRAITS_OF_KERNEL) }
  return 0u;
}

static inline int conic_kernel_is_narrow(const conic_kernel *kernel) {
  return (conic_kernel_traits(kernel) & CONIC_IS_GAUSSIAN) && kernel->cutoff * kernel->cutoff <= CONIC_NARROW_SUPPORT;
}

#define KERNEL_VALUE conic_kernel_value
#define KERNEL_INLINE static inline
#define KERNEL_NUMBER float
#define KERNEL_REAL float
#define KERNEL_OF(x) (x)
#define KERNEL_SQRT(x) sqrtf(x)
#define KERNEL_EXP(x) conic_exp_negative(x)
#define KERNEL_ABOVE_0(x, y) ((x) > 0.0f ? (y) : 0.0f)
#define KERNEL_GAUSS_OF(kernel, q)                                                                                     \
  (conic_kernel_is_narrow(kernel) ? conic_gauss_narrow(q) : conic_exp_negative(-0.5f * (q)))
#include "core/splats/kernel_body.h"

/* A pixel is covered where q is below this: the square of the cutoff, or of b where a kernel has that and it is
 * smaller. */
static inline float conic_kernel_support(const conic_kernel *kernel) {
  float support = kernel->cutoff;
  if ((conic_kernel_traits(kernel) & CONIC_HAS_PARAMETERS) && kernel->b < support)
    support = kernel->b;
  return support * support;
}
