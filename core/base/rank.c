#include "core/base/rank.h"

#include "core/base/base.h"

/* Digits are found from the highest down; at each, only numbers that share the higher digits count. */
enum { RANK_DIGIT_BITS = 11, N_RANK_DIGITS = 1 << RANK_DIGIT_BITS };

static uint32_t keep_number(uint32_t bits) {
  return bits;
}

/* Bits in the order of the floats. */
static uint32_t order_float(uint32_t bits) {
  return bits >> 31 ? ~bits : bits | UINT32_C(0x80000000);
}

/* The key of that rank; `numbers` are n times four bytes. */
static inline uint32_t key_of_rank(const void *numbers, size_t n, size_t rank, uint32_t (*key_of)(uint32_t)) {
  uint32_t prefix = 0;
  for (int shift = 32 - RANK_DIGIT_BITS, above = 32; above > 0; above = shift, shift -= RANK_DIGIT_BITS) {
    size_t counts[N_RANK_DIGITS] = {0};
    shift = shift > 0 ? shift : 0;
    for (size_t i = 0; i < n; i++) {
      uint32_t bits, key;
      memcpy(&bits, (const unsigned char *)numbers + i * sizeof bits, sizeof bits);
      key = key_of(bits);
      if ((uint64_t)key >> above == prefix)
        counts[key >> shift & ((UINT32_C(1) << (above - shift)) - 1)]++;
    }
    uint32_t digit = 0;
    while (rank >= counts[digit])
      rank -= counts[digit++];
    prefix = prefix << (above - shift) | digit;
  }
  return prefix;
}

uint32_t conic_bits_of_rank(const uint32_t *numbers, size_t n, size_t rank) {
  return key_of_rank(numbers, n, rank, keep_number);
}

float conic_float_of_rank(const float *values, size_t n, size_t rank) {
  uint32_t key = key_of_rank(values, n, rank, order_float);
  return conic_float_of_bits(key >> 31 ? key & UINT32_C(0x7fffffff) : ~key);
}
