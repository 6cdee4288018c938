/* What a ray meets, put in order. */
#pragma once

#include "gaussians/draw/gaussian_tile.h"

typedef struct conic_ray_hit {
  float z, alpha;
  uint32_t which;
} conic_ray_hit;

/* By insertion: a short list, or one that is nearly in order. What is equally far stays as it was. */
static inline void conic_insert_hits(CONIC_STORED conic_ray_hit *hits, size_t n) {
  for (size_t i = 1; i < n; i++) {
    conic_ray_hit moved = hits[i];
    size_t at = i;
    for (; at > 0 && hits[at - 1].z > moved.z; at--)
      hits[at] = hits[at - 1];
    hits[at] = moved;
  }
}

#ifdef CONIC_ON_DEVICE /* whose room is of n hits */
static inline void conic_sort_hits(CONIC_STORED conic_ray_hit *hits, size_t n) {
  conic_insert_hits(hits, n);
}
#else
#include "core/base/real.h"

enum { CONIC_HITS_INSERTED = 256, CONIC_HITS_DIGITS = 3, CONIC_HITS_DIGIT_BITS = 11 };

static inline uint32_t conic_digit_of_hit(const conic_ray_hit *hit, int digit) {
  return conic_bits_of_float(hit->z) >> (digit * CONIC_HITS_DIGIT_BITS) & ((1u << CONIC_HITS_DIGIT_BITS) - 1);
}

/* The same for any list of z over 0, by digits. Uses the room of n hits behind the last. */
static inline void conic_sort_hits(conic_ray_hit *hits, size_t n) {
  uint32_t starts[CONIC_HITS_DIGITS][1 << CONIC_HITS_DIGIT_BITS];
  conic_ray_hit *from = hits, *to = hits + n;
  if (n <= CONIC_HITS_INSERTED) {
    conic_insert_hits(hits, n);
    return;
  }
  memset(starts, 0, sizeof starts);
  for (size_t i = 0; i < n; i++)
    for (int digit = 0; digit < CONIC_HITS_DIGITS; digit++)
      starts[digit][conic_digit_of_hit(&hits[i], digit)]++;
  for (int digit = 0; digit < CONIC_HITS_DIGITS; digit++) {
    if (starts[digit][conic_digit_of_hit(&from[0], digit)] == n)
      continue;
    for (uint32_t i = 0, place = 0; i < 1 << CONIC_HITS_DIGIT_BITS; i++) {
      const uint32_t next = place + starts[digit][i];
      starts[digit][i] = place;
      place = next;
    }
    for (size_t i = 0; i < n; i++)
      to[starts[digit][conic_digit_of_hit(&from[i], digit)]++] = from[i];
    conic_ray_hit *other = from;
    from = to;
    to = other;
  }
  if (from != hits)
    memcpy(hits, from, n * sizeof *hits);
}
#endif
