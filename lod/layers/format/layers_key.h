/* Morton codes: the bits of x, y and z in turn, x's first. */
#pragma once

#include "core/base/radix.h"

/* And back; the bits between are passed over. */
static inline uint32_t conic_layers_gather_bits(uint64_t bits) {
  bits &= UINT64_C(0x1249249249249249);
  bits = (bits | bits >> 2) & UINT64_C(0x10c30c30c30c30c3);
  bits = (bits | bits >> 4) & UINT64_C(0x100f00f00f00f00f);
  bits = (bits | bits >> 8) & UINT64_C(0x001f0000ff0000ff);
  bits = (bits | bits >> 16) & UINT64_C(0x001f00000000ffff);
  return (uint32_t)(bits | bits >> 32) & 0x1fffff;
}

static inline uint64_t conic_layers_key(uint32_t x, uint32_t y, uint32_t z) {
  return conic_spread_bits(x) << 2 | conic_spread_bits(y) << 1 | conic_spread_bits(z);
}

/* The step of the grid on an axis: 0 for x. */
static inline uint32_t conic_layers_step(uint64_t key, int axis) {
  return conic_layers_gather_bits(key >> (2 - axis));
}
