/* Lanes: several pixels at a time, as wide as the instruction set that the including file is compiled for. Every lane
 * does exactly what scalar code would, so that no width changes a bit.
 *
 * A part of a block is 4 rows of pixels, column by column: lane l is column l / 4, row l % 4. Operators + - × ÷ work on
 * float lanes. lanes_max(a, b) is a > b ? a : b, lanes_min(a, b) is a < b ? a : b: both are b where a is NaN. */
#ifndef CONIC_LANES_H
#define CONIC_LANES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(__AVX512F__) || defined(__AVX2__) || defined(__SSE2__)
#include <immintrin.h>
#endif

/* How many there are, and how the instruction set calls its own operations and vectors. */
#if defined(__AVX512F__)
#define CONIC_LANES 16
#define CONIC_NATIVE(operation) _mm512_##operation
typedef __m512 native_lanes;
typedef __m512d native_wide;
#elif defined(__AVX2__)
#define CONIC_LANES 8
#define CONIC_NATIVE(operation) _mm256_##operation
typedef __m256 native_lanes;
typedef __m256d native_wide;
#else
#define CONIC_LANES 4
#if defined(__SSE2__)
#define CONIC_NATIVE(operation) _mm_##operation
typedef __m128 native_lanes;
typedef __m128d native_wide;
#endif
#endif

#define CONIC_BLOCK_ROWS 4
/* The number of vectors for a block of 4 × 4 pixels. */
#define CONIC_PARTS (CONIC_BLOCK_ROWS * 4 / CONIC_LANES)

#define CONIC_INLINE static inline __attribute__((always_inline))
#define CONIC_OUTLINE static __attribute__((noinline))

typedef float lanes __attribute__((vector_size(4 * CONIC_LANES)));
typedef int32_t int_lanes __attribute__((vector_size(4 * CONIC_LANES)));
typedef uint32_t index_lanes __attribute__((vector_size(4 * CONIC_LANES)));

CONIC_INLINE lanes lanes_load(const float *from) {
  lanes value;
  memcpy(&value, from, sizeof value);
  return value;
}

CONIC_INLINE void lanes_store(float *to, lanes value) {
  memcpy(to, &value, sizeof value);
}

CONIC_INLINE index_lanes lanes_load_indices(const uint32_t *from) {
  index_lanes value;
  memcpy(&value, from, sizeof value);
  return value;
}

CONIC_INLINE void lanes_store_indices(uint32_t *to, index_lanes value) {
  memcpy(to, &value, sizeof value);
}

CONIC_INLINE lanes lanes_of(float value) {
  return value - (lanes){0};
}

CONIC_INLINE index_lanes lanes_of_index(uint32_t value) {
  return value - (index_lanes){0};
}

CONIC_INLINE int_lanes lanes_of_int(int32_t value) {
  return value - (int_lanes){0};
}

/* Conversions of value, rounded or truncated (the values are within int32_t). */
CONIC_INLINE lanes lanes_of_ints(int_lanes value) {
  return __builtin_convertvector(value, lanes);
}

CONIC_INLINE int_lanes lanes_to_ints(lanes value) {
  return __builtin_convertvector(value, int_lanes);
}

/* The same bits as another type. */
CONIC_INLINE lanes lanes_of_bits(index_lanes bits) {
  return (lanes)bits;
}

CONIC_INLINE index_lanes lanes_to_bits(lanes value) {
  return (index_lanes)value;
}

CONIC_INLINE int_lanes ints_of_indices(index_lanes value) {
  return (int_lanes)value;
}

CONIC_INLINE index_lanes indices_of_ints(int_lanes value) {
  return (index_lanes)value;
}

#if defined(__AVX512F__)

typedef __mmask16 lanes_mask;

CONIC_INLINE lanes_mask lanes_less(lanes a, lanes b) {
  return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
}

CONIC_INLINE lanes_mask lanes_at_least(lanes a, lanes b) {
  return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_GE_OQ);
}

CONIC_INLINE lanes_mask lanes_not(lanes_mask mask) {
  return (lanes_mask)~mask;
}

/* Bit l for lane l. */
CONIC_INLINE unsigned lanes_bits(lanes_mask mask) {
  return mask;
}

CONIC_INLINE lanes_mask lanes_mask_of(unsigned bits) {
  return (lanes_mask)bits;
}

CONIC_INLINE lanes_mask lanes_less_int(int_lanes a, int_lanes b) {
  return _mm512_cmplt_epi32_mask((__m512i)a, (__m512i)b);
}

CONIC_INLINE lanes lanes_select(lanes_mask mask, lanes yes, lanes no) {
  return (lanes)_mm512_mask_blend_ps(mask, (__m512)no, (__m512)yes);
}

CONIC_INLINE index_lanes lanes_select_indices(lanes_mask mask, index_lanes yes, index_lanes no) {
  return (index_lanes)_mm512_mask_blend_epi32(mask, (__m512i)no, (__m512i)yes);
}

/* Writes value where the mask holds. */
CONIC_INLINE void lanes_replace(float *to, lanes_mask mask, lanes value) {
  _mm512_mask_storeu_ps(to, mask, (__m512)value);
}

CONIC_INLINE void lanes_replace_indices(uint32_t *to, lanes_mask mask, index_lanes value) {
  _mm512_mask_storeu_epi32(to, mask, (__m512i)value);
}

/* value where the mask holds, else +0. */
CONIC_INLINE lanes lanes_keep(lanes_mask mask, lanes value) {
  return (lanes)_mm512_maskz_mov_ps(mask, (__m512)value);
}

/* value + 1 where the mask holds. */
CONIC_INLINE index_lanes lanes_increment(lanes_mask mask, index_lanes value) {
  return (index_lanes)_mm512_mask_add_epi32((__m512i)value, mask, (__m512i)value, _mm512_set1_epi32(1));
}

/* Which lanes have a bit of the mask. */
CONIC_INLINE lanes_mask lanes_has_bits(index_lanes value, uint32_t mask) {
  return _mm512_test_epi32_mask((__m512i)value, _mm512_set1_epi32((int)mask));
}

/* Writes the masked values one after the other, then anything up to CONIC_LANES; returns how many are masked. */
CONIC_INLINE size_t lanes_append(uint32_t *to, lanes_mask mask, index_lanes value) {
  _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(mask, (__m512i)value));
  return (size_t)__builtin_popcount(mask);
}

CONIC_INLINE int lanes_any(lanes_mask mask) {
  return mask != 0;
}

CONIC_INLINE unsigned lanes_count(lanes_mask mask) {
  return (unsigned)__builtin_popcount(mask);
}

#else

typedef int_lanes lanes_mask;

CONIC_INLINE lanes_mask lanes_less(lanes a, lanes b) {
  return a < b;
}

CONIC_INLINE lanes_mask lanes_at_least(lanes a, lanes b) {
  return a >= b;
}

CONIC_INLINE lanes_mask lanes_not(lanes_mask mask) {
  return ~mask;
}

CONIC_INLINE lanes_mask lanes_less_int(int_lanes a, int_lanes b) {
  return a < b;
}

CONIC_INLINE lanes lanes_select(lanes_mask mask, lanes yes, lanes no) {
  return (lanes)((mask & (int_lanes)yes) | (~mask & (int_lanes)no));
}

CONIC_INLINE index_lanes lanes_select_indices(lanes_mask mask, index_lanes yes, index_lanes no) {
  return ((index_lanes)mask & yes) | (~(index_lanes)mask & no);
}

CONIC_INLINE void lanes_replace(float *to, lanes_mask mask, lanes value) {
  lanes_store(to, lanes_select(mask, value, lanes_load(to)));
}

CONIC_INLINE void lanes_replace_indices(uint32_t *to, lanes_mask mask, index_lanes value) {
  lanes_store_indices(to, lanes_select_indices(mask, value, lanes_load_indices(to)));
}

/* value where the mask holds, else +0. */
CONIC_INLINE lanes lanes_keep(lanes_mask mask, lanes value) {
  return (lanes)(mask & (int_lanes)value);
}

/* value + 1 where the mask holds. */
CONIC_INLINE index_lanes lanes_increment(lanes_mask mask, index_lanes value) {
  return value - (index_lanes)mask;
}

CONIC_INLINE lanes_mask lanes_mask_of(unsigned bits) {
  lanes_mask mask = {0};
  for (int lane = 0; lane < CONIC_LANES; lane++)
    mask[lane] = -(int32_t)(bits >> lane & 1);
  return mask;
}

CONIC_INLINE lanes_mask lanes_has_bits(index_lanes value, uint32_t mask) {
  return (value & mask) != 0u;
}

CONIC_INLINE size_t lanes_append(uint32_t *to, lanes_mask mask, index_lanes value) {
  size_t n = 0;
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    to[n] = value[lane];
    n -= (size_t)(ptrdiff_t)mask[lane];
  }
  return n;
}

#if defined(__AVX2__)

CONIC_INLINE int lanes_any(lanes_mask mask) {
  return !_mm256_testz_si256((__m256i)mask, (__m256i)mask);
}

CONIC_INLINE unsigned lanes_bits(lanes_mask mask) {
  return (unsigned)_mm256_movemask_ps((__m256)mask);
}

CONIC_INLINE unsigned lanes_count(lanes_mask mask) {
  return (unsigned)__builtin_popcount(lanes_bits(mask));
}

#elif defined(__SSE2__)

CONIC_INLINE int lanes_any(lanes_mask mask) {
  return _mm_movemask_ps((__m128)mask) != 0;
}

CONIC_INLINE unsigned lanes_bits(lanes_mask mask) {
  return (unsigned)_mm_movemask_ps((__m128)mask);
}

CONIC_INLINE unsigned lanes_count(lanes_mask mask) {
  unsigned bits = lanes_bits(mask);
  return (unsigned)(UINT64_C(0x4332322132212110) >> (4 * bits)) & 7u; /* number of bits of each of 16 patterns */
}

#else

CONIC_INLINE int lanes_any(lanes_mask mask) {
  return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
}

CONIC_INLINE unsigned lanes_bits(lanes_mask mask) {
  return (unsigned)((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
}

CONIC_INLINE unsigned lanes_count(lanes_mask mask) {
  return (unsigned)-(mask[0] + mask[1] + mask[2] + mask[3]);
}

#endif
#endif

#if defined(CONIC_NATIVE)

CONIC_INLINE lanes lanes_max(lanes a, lanes b) {
  return (lanes)CONIC_NATIVE(max_ps)((native_lanes)a, (native_lanes)b);
}

CONIC_INLINE lanes lanes_min(lanes a, lanes b) {
  return (lanes)CONIC_NATIVE(min_ps)((native_lanes)a, (native_lanes)b);
}

CONIC_INLINE lanes lanes_sqrt(lanes a) {
  return (lanes)CONIC_NATIVE(sqrt_ps)((native_lanes)a);
}

#else

CONIC_INLINE lanes lanes_max(lanes a, lanes b) {
  return lanes_select(a > b, a, b);
}

CONIC_INLINE lanes lanes_min(lanes a, lanes b) {
  return lanes_select(a < b, a, b);
}

CONIC_INLINE lanes lanes_sqrt(lanes a) {
  return (lanes){__builtin_sqrtf(a[0]), __builtin_sqrtf(a[1]), __builtin_sqrtf(a[2]), __builtin_sqrtf(a[3])};
}

#endif

CONIC_INLINE int_lanes lanes_select_ints(lanes_mask mask, int_lanes yes, int_lanes no) {
  return (int_lanes)lanes_select_indices(mask, (index_lanes)yes, (index_lanes)no);
}

CONIC_INLINE lanes lanes_absolute(lanes value) {
  return (lanes)((int_lanes)value & 0x7fffffff);
}

#if CONIC_LANES == 16
#define CONIC_EVEN_LANES 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30
#define CONIC_ODD_LANES 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31
#elif CONIC_LANES == 8
#define CONIC_EVEN_LANES 0, 2, 4, 6, 8, 10, 12, 14
#define CONIC_ODD_LANES 1, 3, 5, 7, 9, 11, 13, 15
#else
#define CONIC_EVEN_LANES 0, 2, 4, 6
#define CONIC_ODD_LANES 1, 3, 5, 7
#endif

/* Splits pairs of values into the first and the second of each. */
CONIC_INLINE void lanes_load_pairs(const uint32_t *from, index_lanes *first, index_lanes *second) {
  index_lanes low = lanes_load_indices(from), high = lanes_load_indices(from + CONIC_LANES);
  *first = __builtin_shufflevector(low, high, CONIC_EVEN_LANES);
  *second = __builtin_shufflevector(low, high, CONIC_ODD_LANES);
}

#if CONIC_LANES == 16
#define CONIC_PAIRED_LANES 0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15
#elif CONIC_LANES == 8
#define CONIC_PAIRED_LANES 0, 1, 4, 5, 2, 3, 6, 7
#else
#define CONIC_PAIRED_LANES 0, 1, 2, 3
#endif

typedef float half_lanes __attribute__((vector_size(2 * CONIC_LANES)));

/* Takes half the lanes from each, in alternating pairs. */
CONIC_INLINE lanes lanes_of_pairs(const float *a, const float *b) {
  half_lanes of_a, of_b;
  memcpy(&of_a, a, sizeof of_a);
  memcpy(&of_b, b, sizeof of_b);
  return __builtin_shufflevector(of_a, of_b, CONIC_PAIRED_LANES);
}

/* first, first + 1, … */
CONIC_INLINE index_lanes lanes_ascending(uint32_t first) {
  index_lanes ascending = {0};
  for (int lane = 0; lane < CONIC_LANES; lane++)
    ascending[lane] = (uint32_t)lane; /* a constant, to which `first` is added: else the compiler would build it lane by
                                         lane */
  return ascending + first;
}

/* 0, 0, 0, 0, 1, 1, 1, 1, … and 0, 1, 2, 3, 0, 1, 2, 3, …: a lane's place in its block. */
CONIC_INLINE int_lanes lanes_columns(void) {
  int_lanes columns;
  for (int lane = 0; lane < CONIC_LANES; lane++)
    columns[lane] = lane / CONIC_BLOCK_ROWS;
  return columns;
}

CONIC_INLINE int_lanes lanes_rows(void) {
  int_lanes rows;
  for (int lane = 0; lane < CONIC_LANES; lane++)
    rows[lane] = lane % CONIC_BLOCK_ROWS;
  return rows;
}

/* 0, 1, … n - 1, 0, 1, … */
CONIC_INLINE int_lanes lanes_alternating(int n) {
  int_lanes alternating;
  for (int lane = 0; lane < CONIC_LANES; lane++)
    alternating[lane] = lane % n;
  return alternating;
}

#include "core/lanes/lanes_exponential.h"

#endif
