/* A stable sort of numbered keys, in time that grows as their number. */
#ifndef CONIC_RADIX_H
#define CONIC_RADIX_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"

typedef struct conic_radix_item {
  uint64_t key;
  uint32_t value;
} conic_radix_item;

/* Sorts by the lowest `n_bits` of the keys, which have no others. Errors: MEMORY. */
conic_status conic_radix_sort(conic_context *context, conic_radix_item *items, size_t n, int n_bits);

/* How many bits it takes to write numbers below `count`. */
static inline int conic_bits_below(size_t count) {
  int n = 0;
  while (n < 63 && ((size_t)1 << n) < count)
    n++;
  return n;
}

#endif
