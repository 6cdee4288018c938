/* The order of Gaussians along rays, one a lane: a merge sort of keys by minima and maxima alone, since a network of
 * them takes the same way at every ray. */
#pragma once

#include "core/base/real.h"
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

/* Sorts sixteen that rise and then fall, or the other way round, by halves. */
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
 * of CONIC_SORTED_TOGETHER. Whatever would lie behind the last counts as greater than all. */
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

/* Sorts n rows; up to CONIC_SORTED_TOGETHER - 1 behind them are used. */
static void sort_rows(lanes_row *keys, size_t n) {
  for (; n % CONIC_SORTED_TOGETHER != 0; n++)
    lanes_store(keys[n], lanes_of(__builtin_inff()));
  for (size_t i = 0; i < n; i += CONIC_SORTED_TOGETHER)
    sort_together(keys + i);
  for (size_t length = CONIC_SORTED_TOGETHER; length < n; length *= 2)
    merge_runs(keys, n, length);
}

/* Keys of depths: the higher bits of how far z's bits are from the nearest's, and a number below. As floats over 0 they
 * are in the order of z, and of the numbers where the bits that are left out would tell; infinity: none. */
typedef struct depth_keys {
  uint32_t nearest, shift, n_bits, numbers;
} depth_keys;

enum { KEY_BITS = 30 };

/* For depths between, and numbers below n. */
CONIC_INLINE depth_keys keys_between(lanes nearest, lanes farthest, size_t n) {
  float nearest_of[CONIC_LANES], farthest_of[CONIC_LANES], least = __builtin_inff(), most = 0.0f;
  uint32_t range;
  depth_keys by = {0};
  lanes_store(nearest_of, nearest);
  lanes_store(farthest_of, farthest);
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    least = nearest_of[lane] < least ? nearest_of[lane] : least;
    most = farthest_of[lane] > most ? farthest_of[lane] : most;
  }
  by.nearest = conic_bits_of_float(least);
  range = most > least ? conic_bits_of_float(most) - by.nearest : 0;
  while (n >> by.n_bits)
    by.n_bits++;
  while (range >> by.shift >> (KEY_BITS - by.n_bits))
    by.shift++;
  by.numbers = (1u << by.n_bits) - 1;
  return by;
}

CONIC_INLINE lanes key_of_depth(const depth_keys *by, lanes z, index_lanes number) {
  return lanes_of_bits(((lanes_to_bits(z) - by->nearest) >> by->shift << by->n_bits) + number);
}

/* z, or somewhat less, so that keys tell which depths are not less; not below the nearest. */
CONIC_INLINE float key_border(const depth_keys *by, float z) {
  uint32_t bits = conic_bits_of_float(z);
  bits = bits > by->nearest ? (bits - by->nearest) >> by->shift << by->shift : 0;
  return conic_float_of_bits(by->nearest + bits);
}

/* What no key of a depth that is not below such a border is below. */
CONIC_INLINE float least_key_at(const depth_keys *by, float border) {
  uint32_t bits = (conic_bits_of_float(border) - by->nearest) >> by->shift;
  return bits >> (KEY_BITS - by->n_bits) ? __builtin_inff() : conic_float_of_bits(bits << by->n_bits);
}
