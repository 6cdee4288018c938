/* The exponentials of core/splats/kernel.h in every lane, with the same operations in the same order. C and OpenCL C
 * share this text. */
#pragma once

#include "core/lanes/lanes.h"

/* conic_exp_negative of n ≤ 2 at a time, in step, as each waits for its own chain of operations. */
CONIC_INLINE void lanes_exp_negatives(int n, const lanes *x, lanes *falls) {
  int_lanes k[2];
  lanes r[2], p[2];
  for (int i = 0; i < n; i++) {
    lanes least = lanes_max(x[i], lanes_of(-80.0f));
    k[i] = lanes_to_ints(least * 0x1.715476p+0f - 0.5f);
    lanes k_float = lanes_of_ints(k[i]);
    r[i] = (least - k_float * 0x1.63p-1f) + k_float * 0x1.bd0106p-13f;
  }
  for (int i = 0; i < n; i++)
    p[i] = lanes_of(0x1.6a23cap-10f) * r[i] + 0x1.123a20p-7f;
  for (int i = 0; i < n; i++)
    p[i] = p[i] * r[i] + 0x1.5558f2p-5f;
  for (int i = 0; i < n; i++)
    p[i] = p[i] * r[i] + 0x1.555492p-3f;
  for (int i = 0; i < n; i++)
    p[i] = p[i] * r[i] + 0x1.fffffcp-2f;
  for (int i = 0; i < n; i++)
    p[i] = (p[i] * (r[i] * r[i]) + r[i]) + 1.0f;
  for (int i = 0; i < n; i++)
    falls[i] = lanes_of_bits(lanes_to_bits(p[i]) + indices_of_ints(k[i] * (1 << 23)));
}

CONIC_INLINE lanes lanes_exp_negative(lanes x) {
  lanes fall;
  lanes_exp_negatives(1, &x, &fall);
  return fall;
}

/* conic_gauss_narrow */
CONIC_INLINE lanes lanes_gauss_narrow(lanes q) {
  lanes t = q - 1.125f, t2 = t * t, t4 = t2 * t2;
  lanes a = 0x1.23ba94p-1f + -0x1.23ba94p-2f * t, b = 0x1.23ba98p-4f + -0x1.84f89ap-7f * t;
  lanes c = 0x1.84f19cp-10f + -0x1.373c6ep-13f * t, d = 0x1.a3885cp-17f + -0x1.d6063cp-21f * t;
  return (a + t2 * b) + t4 * (c + t2 * d);
}
