/* Doubles for as many splats as there are lanes: two halves, each of a native vector. */
#ifndef CONIC_LANES_DOUBLE_H
#define CONIC_LANES_DOUBLE_H

#include "core/lanes/lanes.h"

#define CONIC_HALF_LANES (CONIC_LANES / 2)

typedef double half_doubles __attribute__((vector_size(8 * CONIC_HALF_LANES)));
typedef float half_floats __attribute__((vector_size(4 * CONIC_HALF_LANES)));
typedef int32_t half_ints __attribute__((vector_size(4 * CONIC_HALF_LANES)));
typedef int64_t half_masks __attribute__((vector_size(8 * CONIC_HALF_LANES)));

typedef struct doubles {
  half_doubles half[2];
} doubles;

#if CONIC_LANES == 16
#define CONIC_ALL_LANES 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15
#define CONIC_LOW_LANES 0, 1, 2, 3, 4, 5, 6, 7
#define CONIC_HIGH_LANES 8, 9, 10, 11, 12, 13, 14, 15
#elif CONIC_LANES == 8
#define CONIC_ALL_LANES 0, 1, 2, 3, 4, 5, 6, 7
#define CONIC_LOW_LANES 0, 1, 2, 3
#define CONIC_HIGH_LANES 4, 5, 6, 7
#else
#define CONIC_ALL_LANES 0, 1, 2, 3
#define CONIC_LOW_LANES 0, 1
#define CONIC_HIGH_LANES 2, 3
#endif

#if defined(__AVX512F__)

/* By name: gcc 12 would take them apart into quarters. */
CONIC_INLINE half_doubles half_of(lanes value, int half) {
  __m256d part = half == 0 ? _mm512_castpd512_pd256((__m512d)value) : _mm512_extractf64x4_pd((__m512d)value, 1);
  return (half_doubles)_mm512_cvtps_pd((__m256)part);
}

/* Rounded to float. */
CONIC_INLINE lanes lanes_narrow(const doubles *value) {
  __m256 low = _mm512_cvtpd_ps((__m512d)value->half[0]), high = _mm512_cvtpd_ps((__m512d)value->half[1]);
  return (lanes)_mm512_insertf64x4(_mm512_castpd256_pd512((__m256d)low), (__m256d)high, 1);
}

/* Truncated; the values are within int32_t. */
CONIC_INLINE int_lanes lanes_truncate(const doubles *value) {
  __m256i low = _mm512_cvttpd_epi32((__m512d)value->half[0]), high = _mm512_cvttpd_epi32((__m512d)value->half[1]);
  return (int_lanes)_mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1);
}

#else

/* Both halves in one vector. */
CONIC_INLINE lanes lanes_join(half_floats low, half_floats high) {
  return __builtin_shufflevector(low, high, CONIC_ALL_LANES);
}

CONIC_INLINE int_lanes lanes_join_int(half_ints low, half_ints high) {
  return __builtin_shufflevector(low, high, CONIC_ALL_LANES);
}

CONIC_INLINE half_doubles half_of(lanes value, int half) {
  half_floats floats = half == 0 ? __builtin_shufflevector(value, value, CONIC_LOW_LANES)
                                 : __builtin_shufflevector(value, value, CONIC_HIGH_LANES);
  return __builtin_convertvector(floats, half_doubles);
}

/* Rounded to float. */
CONIC_INLINE lanes lanes_narrow(const doubles *value) {
  return lanes_join(__builtin_convertvector(value->half[0], half_floats),
                    __builtin_convertvector(value->half[1], half_floats));
}

/* Truncated; the values are within int32_t. */
CONIC_INLINE int_lanes lanes_truncate(const doubles *value) {
  return lanes_join_int(__builtin_convertvector(value->half[0], half_ints),
                        __builtin_convertvector(value->half[1], half_ints));
}

#endif

CONIC_INLINE half_doubles half_of_value(double value) {
  return value - (half_doubles){0};
}

/* a > b ? a : b and a < b ? a : b; the square root; which lanes have a > b, a ≤ b being false where one is not a
 * number. */
#if defined(__AVX512F__)

CONIC_INLINE half_doubles half_max(half_doubles a, half_doubles b) {
  return (half_doubles)_mm512_max_pd((__m512d)a, (__m512d)b);
}

CONIC_INLINE half_doubles half_min(half_doubles a, half_doubles b) {
  return (half_doubles)_mm512_min_pd((__m512d)a, (__m512d)b);
}

CONIC_INLINE half_doubles half_sqrt(half_doubles a) {
  return (half_doubles)_mm512_sqrt_pd((__m512d)a);
}

CONIC_INLINE lanes_mask lanes_greater_double(const doubles *a, double b) {
  __mmask8 low = _mm512_cmp_pd_mask((__m512d)a->half[0], _mm512_set1_pd(b), _CMP_GT_OQ);
  __mmask8 high = _mm512_cmp_pd_mask((__m512d)a->half[1], _mm512_set1_pd(b), _CMP_GT_OQ);
  return (lanes_mask)(low | high << 8);
}

#else

#if defined(__AVX2__)

CONIC_INLINE half_doubles half_max(half_doubles a, half_doubles b) {
  return (half_doubles)_mm256_max_pd((__m256d)a, (__m256d)b);
}

CONIC_INLINE half_doubles half_min(half_doubles a, half_doubles b) {
  return (half_doubles)_mm256_min_pd((__m256d)a, (__m256d)b);
}

CONIC_INLINE half_doubles half_sqrt(half_doubles a) {
  return (half_doubles)_mm256_sqrt_pd((__m256d)a);
}

#elif defined(__SSE2__)

CONIC_INLINE half_doubles half_max(half_doubles a, half_doubles b) {
  return (half_doubles)_mm_max_pd((__m128d)a, (__m128d)b);
}

CONIC_INLINE half_doubles half_min(half_doubles a, half_doubles b) {
  return (half_doubles)_mm_min_pd((__m128d)a, (__m128d)b);
}

CONIC_INLINE half_doubles half_sqrt(half_doubles a) {
  return (half_doubles)_mm_sqrt_pd((__m128d)a);
}

#else

CONIC_INLINE half_doubles half_max(half_doubles a, half_doubles b) {
  half_masks more = a > b;
  return (half_doubles)((more & (half_masks)a) | (~more & (half_masks)b));
}

CONIC_INLINE half_doubles half_min(half_doubles a, half_doubles b) {
  half_masks less = a < b;
  return (half_doubles)((less & (half_masks)a) | (~less & (half_masks)b));
}

CONIC_INLINE half_doubles half_sqrt(half_doubles a) {
  return (half_doubles){__builtin_sqrt(a[0]), __builtin_sqrt(a[1])};
}

#endif

CONIC_INLINE lanes_mask lanes_greater_double(const doubles *a, double b) {
  return lanes_join_int(__builtin_convertvector(a->half[0] > b, half_ints),
                        __builtin_convertvector(a->half[1] > b, half_ints));
}

#endif

#endif
