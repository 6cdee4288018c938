/* The order of Gaussians along rays, one a lane: a merge sort of keys by minima and maxima alone, since a network of
 * them takes the same way at every ray. */
#ifndef CONIC_GAUSSIAN_ORDER_LANES_H
#define CONIC_GAUSSIAN_ORDER_LANES_H

#include "core/lanes/lanes.h"

enum { CONIC_SORTED_TOGETHER = 16 }; /* in registers */

typedef float lanes_row[CONIC_LANES];

CONIC_INLINE void put_in_order(lanes *a, lanes *b) {
  lanes lesser = lanes_min(*a, *b);
  *b = lanes_max(*a, *b);
  *a = lesser;
}

/* Batcher's odd-even merge sort. */
CONIC_INLINE void sort_together(lanes_row *keys) {
  lanes k[CONIC_SORTED_TOGETHER];
#pragma GCC unroll 16
  for (int i = 0; i < CONIC_SORTED_TOGETHER; i++)
    k[i] = lanes_load(keys[i]);
#pragma GCC unroll 4
  for (int length = 1; length < CONIC_SORTED_TOGETHER; length *= 2)
#pragma GCC unroll 4
    for (int apart = length; apart > 0; apart /= 2)
#pragma GCC unroll 16
      for (int i = apart % length; i + apart < CONIC_SORTED_TOGETHER; i++)
        if ((i - apart % length) / apart % 2 == 0 && i / (2 * length) == (i + apart) / (2 * length))
          put_in_order(&k[i], &k[i + apart]);
#pragma GCC unroll 16
  for (int i = 0; i < CONIC_SORTED_TOGETHER; i++)
    lanes_store(keys[i], k[i]);
}

/* Sixteen of which each half is no more than what follows, by halves. */
CONIC_INLINE void merge_together(lanes_row *keys) {
  lanes k[CONIC_SORTED_TOGETHER];
#pragma GCC unroll 16
  for (int i = 0; i < CONIC_SORTED_TOGETHER; i++)
    k[i] = lanes_load(keys[i]);
#pragma GCC unroll 4
  for (int apart = CONIC_SORTED_TOGETHER / 2; apart > 0; apart /= 2)
#pragma GCC unroll 16
    for (int i = 0; i < CONIC_SORTED_TOGETHER; i++)
      if ((i & apart) == 0)
        put_in_order(&k[i], &k[i + apart]);
#pragma GCC unroll 16
  for (int i = 0; i < CONIC_SORTED_TOGETHER; i++)
    lanes_store(keys[i], k[i]);
}

CONIC_INLINE void put_rows_in_order(lanes_row *keys, size_t i, size_t j) {
  lanes a = lanes_load(keys[i]), b = lanes_load(keys[j]);
  lanes_store(keys[i], lanes_min(a, b));
  lanes_store(keys[j], lanes_max(a, b));
}

/* Merges sorted runs of `length` by two: their greatest with their least, outside in, then by halves. n is a multiple
 * of what is sorted together; what would lie behind is greater than all. */
static void merge_runs(lanes_row *keys, size_t n, size_t length) {
  for (size_t begin = 0; begin + length < n; begin += 2 * length)
    for (size_t i = begin + 2 * length > n ? begin + 2 * length - n : 0; i < length; i++)
      put_rows_in_order(keys, begin + i, begin + 2 * length - 1 - i);
  for (size_t apart = length / 2; apart >= CONIC_SORTED_TOGETHER; apart /= 2)
    for (size_t begin = 0; begin + apart < n; begin += 2 * apart)
      for (size_t i = begin; i < begin + apart && i + apart < n; i++)
        put_rows_in_order(keys, i, i + apart);
  for (size_t i = 0; i < n; i += CONIC_SORTED_TOGETHER)
    merge_together(keys + i);
}

static void sort_rows(lanes_row *keys, size_t n) {
  for (size_t i = 0; i < n; i += CONIC_SORTED_TOGETHER)
    sort_together(keys + i);
  for (size_t length = CONIC_SORTED_TOGETHER; length < n; length *= 2)
    merge_runs(keys, n, length);
}

/* Whether keys that are not of different depths lie side by side. */
static int has_equals(const lanes_row *keys, size_t n, uint32_t numbers) {
  for (size_t i = 1; i < n; i++) {
    lanes key = lanes_load(keys[i]);
    index_lanes both = lanes_to_bits(key) ^ lanes_to_bits(lanes_load(keys[i - 1]));
    if (lanes_any(lanes_less(key, lanes_of(__builtin_inff())) & lanes_not(lanes_has_bits(both, ~numbers))))
      return 1;
  }
  return 0;
}

/* Puts in order what the keys could not tell apart. */
static void mend_order(const lanes_row *z, lanes_row *keys, size_t n, uint32_t numbers) {
  for (size_t lane = 0; lane < CONIC_LANES; lane++)
    for (size_t i = 1; i < n && keys[i][lane] < __builtin_inff(); i++) {
      const float key = keys[i][lane];
      uint32_t bits, bits_before;
      size_t at = i;
      memcpy(&bits, &key, sizeof bits);
      for (; at > 0; at--) {
        memcpy(&bits_before, &keys[at - 1][lane], sizeof bits_before);
        if (!(z[bits_before & numbers][lane] > z[bits & numbers][lane]))
          break;
        keys[at][lane] = keys[at - 1][lane];
      }
      keys[at][lane] = key;
    }
}

/* Sorts, at each ray, those of n Gaussians that have an alpha there, by z, of equal ones by their numbers: in keys'
 * bits that the result has come their numbers, nearest first, and then infinities. A key is the higher bits of z's
 * distance from the nearest, as whole numbers, and the number below; as floats over 0 they are in the same order. */
CONIC_INLINE uint32_t sort_by_depth(const lanes_row *z, const lanes_row *alpha, size_t n, lanes nearest, lanes farthest,
                                    lanes_row *keys) {
  enum { KEY_BITS = 30 };
  const size_t n_rows = (n + CONIC_SORTED_TOGETHER - 1) / CONIC_SORTED_TOGETHER * CONIC_SORTED_TOGETHER;
  const lanes_mask has_some = lanes_at_least(farthest, nearest);
  const index_lanes range =
      lanes_select_indices(has_some, lanes_to_bits(farthest) - lanes_to_bits(nearest), lanes_of_index(0));
  uint32_t widest = 0, shift = 0, n_bits = 0;
  for (int lane = 0; lane < CONIC_LANES; lane++)
    widest |= range[lane];
  while (n >> n_bits)
    n_bits++;
  while (widest >> shift >> (KEY_BITS - n_bits))
    shift++;
  for (size_t i = 0; i < n; i++) {
    index_lanes distance = (lanes_to_bits(lanes_load(z[i])) - lanes_to_bits(nearest)) >> shift;
    lanes key = lanes_of_bits((distance << n_bits) + (uint32_t)i);
    lanes_mask is_there = lanes_less(lanes_of(0.0f), lanes_load(alpha[i]));
    lanes_store(keys[i], lanes_select(is_there, key, lanes_of(__builtin_inff())));
  }
  for (size_t i = n; i < n_rows; i++)
    lanes_store(keys[i], lanes_of(__builtin_inff()));
  sort_rows(keys, n_rows);
  if (shift > 0 && has_equals(keys, n, (1u << n_bits) - 1))
    mend_order(z, keys, n, (1u << n_bits) - 1);
  return (1u << n_bits) - 1;
}

#endif
