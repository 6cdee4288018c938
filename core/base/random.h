/* Random numbers by number: each depends on the seed, the index and the dimension, never on numbers drawn before, so
 * that any part of a sequence can be made by itself, on any thread. */
#pragma once

#include <stdint.h>

/* A bijection of 64 bits in which every input bit moves about half of the output bits. */
static inline uint64_t conic_random_mix(uint64_t bits) {
  bits = (bits ^ (bits >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  bits = (bits ^ (bits >> 27)) * UINT64_C(0x94d049bb133111eb);
  return bits ^ (bits >> 31);
}

static inline uint64_t conic_random_bits(uint64_t seed, uint64_t index, uint64_t dimension) {
  uint64_t stream = conic_random_mix(seed + UINT64_C(0x9e3779b97f4a7c15) * (dimension + 1));
  return conic_random_mix(stream + UINT64_C(0x9e3779b97f4a7c15) * (index + 1));
}

/* In [0, 1), a multiple of 2⁻⁵³. */
static inline double conic_random_uniform(uint64_t seed, uint64_t index, uint64_t dimension) {
  return (double)(conic_random_bits(seed, index, dimension) >> 11) * 0x1p-53;
}

/* Mean 0, variance 1, within ±6: the sum of twelve 16-bit uniforms, whose distribution function is off the Gaussian's
 * by under 0.0024. Uses three dimensions, from `dimension` on. */
static inline double conic_random_gaussian(uint64_t seed, uint64_t index, uint64_t dimension) {
  uint64_t sum = 0;
  for (uint64_t i = 0; i < 3; i++) {
    uint64_t bits = conic_random_bits(seed, index, dimension + i);
    sum += (bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48);
  }
  return ((double)sum + 6.0) * 0x1p-16 - 6.0;
}
