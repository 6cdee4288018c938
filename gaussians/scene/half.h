/* Numbers of 16 bits, as IEEE 754's binary16 has them. */
#pragma once

#include "core/base/base.h"

static inline float conic_float_of_half(uint16_t half) {
  uint32_t sign = (uint32_t)(half & 0x8000) << 16, magnitude = half & 0x7fff;
  if (magnitude >= 0x7c00)
    return conic_float_of_bits(sign | 0x7f800000 | (magnitude & 0x3ff) << 13);
  float value = conic_float_of_bits(magnitude << 13) * 0x1p112f; /* denormal halfs become normal so */
  return conic_float_of_bits(sign | conic_bits_of_float(value));
}

/* Rounded to nearest, ties to even; what is too large is infinite. */
static inline uint16_t conic_half_of_float(float value) {
  uint32_t bits = conic_bits_of_float(value), sign = bits >> 16 & 0x8000, magnitude = bits & 0x7fffffff;
  if (magnitude > 0x7f800000)
    return (uint16_t)(sign | 0x7e00);
  if (magnitude >= 0x477ff000)
    return (uint16_t)(sign | 0x7c00);
  if (magnitude < 0x38800000) { /* adding 2^-1 shifts what is a denormal half to the last bits, rounded */
    float shifted = conic_float_of_bits(magnitude) + 0.5f;
    return (uint16_t)(sign | (conic_bits_of_float(shifted) - 0x3f000000));
  }
  return (uint16_t)(sign | (magnitude - 0x38000000 + 0xfff + (magnitude >> 13 & 1)) >> 13);
}
