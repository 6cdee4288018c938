/* Sorting: numbered keys, stably, in time that grows as their number. */
#pragma once

#include <stdint.h>

#include "conic/context.h"

typedef struct conic_radix_item {
  uint64_t key;
  uint32_t value;
} conic_radix_item;

/* Sorts by the lowest `n_bits` of the keys, which have no others. Errors: MEMORY. */
conic_status conic_radix_sort(conic_context *context, conic_radix_item *items, size_t n, int n_bits);
/* The same with room for as many. Returns where they are then: one of the two. */
const conic_radix_item *conic_radix_sort_in(conic_radix_item *items, conic_radix_item *room, size_t n, int n_bits);

/* How many bits it takes to write numbers below `count`. */
static inline int conic_bits_below(size_t count) {
  int n = 0;
  while (n < 63 && ((size_t)1 << n) < count)
    n++;
  return n;
}

/* Bit i of 21 goes to bit 3i: a part of a Morton code. */
static inline uint64_t conic_spread_bits(uint64_t bits) {
  bits = (bits | bits << 32) & UINT64_C(0x001f00000000ffff);
  bits = (bits | bits << 16) & UINT64_C(0x001f0000ff0000ff);
  bits = (bits | bits << 8) & UINT64_C(0x100f00f00f00f00f);
  bits = (bits | bits << 4) & UINT64_C(0x10c30c30c30c30c3);
  return (bits | bits << 2) & UINT64_C(0x1249249249249249);
}
