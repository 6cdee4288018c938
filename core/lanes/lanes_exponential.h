/* The exponentials of core/splats/kernel.h in every lane, with the same operations in the same order. C and OpenCL C
 * share this text. */
#pragma once

#include "core/lanes/lanes.h"

/* conic_exp_negative */
CONIC_INLINE lanes lanes_exp_negative(lanes x) {
  x = lanes_max(x, lanes_of(-80.0f));
  int_lanes k = lanes_to_ints(x * 0x1.715476p+0f - 0.5f);
  lanes k_float = lanes_of_ints(k);
  lanes r = (x - k_float * 0x1.63p-1f) + k_float * 0x1.bd0106p-13f;
  lanes p = lanes_of(0x1.6a23cap-10f);
  p = p * r + 0x1.123a20p-7f;
  p = p * r + 0x1.5558f2p-5f;
  p = p * r + 0x1.555492p-3f;
  p = p * r + 0x1.fffffcp-2f;
  p = (p * (r * r) + r) + 1.0f;
  return lanes_of_bits(lanes_to_bits(p) + indices_of_ints(k * (1 << 23)));
}

/* conic_gauss_narrow */
CONIC_INLINE lanes lanes_gauss_narrow(lanes q) {
  lanes t = q - 1.125f, t2 = t * t, t4 = t2 * t2;
  lanes a = 0x1.23ba94p-1f + -0x1.23ba94p-2f * t, b = 0x1.23ba98p-4f + -0x1.84f89ap-7f * t;
  lanes c = 0x1.84f19cp-10f + -0x1.373c6ep-13f * t, d = 0x1.a3885cp-17f + -0x1.d6063cp-21f * t;
  return (a + t2 * b) + t4 * (c + t2 * d);
}
