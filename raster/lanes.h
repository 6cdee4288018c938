/* Four pixels at a time, in the compiler's vector types: every lane does exactly what the scalar code would, so that
 * nothing here changes a bit. A mask has all bits set in a lane that holds, none in one that does not. */
#ifndef RASTER_LANES_H
#define RASTER_LANES_H

#include <stdint.h>
#include <string.h>

#define CONIC_LANES 4

typedef float conic_floats __attribute__((vector_size(4 * CONIC_LANES)));
typedef int32_t conic_mask __attribute__((vector_size(4 * CONIC_LANES)));
typedef uint32_t conic_indices __attribute__((vector_size(4 * CONIC_LANES)));

static inline conic_floats conic_load(const float *from) {
  conic_floats lanes;
  memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

static inline void conic_store(float *to, conic_floats lanes) {
  memcpy(to, &lanes, sizeof lanes);
}

static inline conic_indices conic_load_indices(const uint32_t *from) {
  conic_indices lanes;
  memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

static inline void conic_store_indices(uint32_t *to, conic_indices lanes) {
  memcpy(to, &lanes, sizeof lanes);
}

static inline conic_floats conic_splat_lanes(float value) {
  return (conic_floats){value, value, value, value};
}

static inline conic_indices conic_index_lanes(uint32_t value) {
  return (conic_indices){value, value, value, value};
}

/* mask ? yes : no, lane by lane. */
static inline conic_floats conic_select(conic_mask mask, conic_floats yes, conic_floats no) {
  return (conic_floats)((mask & (conic_mask)yes) | (~mask & (conic_mask)no));
}

static inline conic_indices conic_select_indices(conic_mask mask, conic_indices yes, conic_indices no) {
  return ((conic_indices)mask & yes) | (~(conic_indices)mask & no);
}

static inline int conic_any(conic_mask mask) {
  uint64_t halves[2];
  memcpy(halves, &mask, sizeof halves);
  return (halves[0] | halves[1]) != 0;
}

/* How many lanes hold. */
static inline unsigned conic_count_lanes(conic_mask mask) {
  unsigned n = 0;
  for (int i = 0; i < CONIC_LANES; i++)
    n += (unsigned)mask[i] & 1u;
  return n;
}

/* conic_exp_negative (core/kernel.h) in every lane: the same operations in the same order. */
static inline conic_floats conic_exp_negative_lanes(conic_floats x) {
  conic_floats least = conic_splat_lanes(-80.0f);
  x = conic_select(x > least, x, least);
  conic_mask k = __builtin_convertvector(x * 0x1.715476p+0f - 0.5f, conic_mask);
  conic_floats k_float = __builtin_convertvector(k, conic_floats);
  conic_floats r = (x - k_float * 0x1.63p-1f) + k_float * 0x1.bd0106p-13f;
  conic_floats p = conic_splat_lanes(0x1.6a23cap-10f);
  p = p * r + 0x1.123a20p-7f;
  p = p * r + 0x1.5558f2p-5f;
  p = p * r + 0x1.555492p-3f;
  p = p * r + 0x1.fffffcp-2f;
  p = (p * (r * r) + r) + 1.0f;
  return (conic_floats)((conic_mask)p + k * (1 << 23));
}

#endif
