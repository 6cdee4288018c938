/* Doubles: a native vector of them, `wide`, and one for each lane, `doubles`, which is two of these. */
#ifndef CONIC_LANES_DOUBLE_H
#define CONIC_LANES_DOUBLE_H

#include "core/lanes/lanes.h"

#define CONIC_WIDE_LANES (CONIC_LANES / 2)

typedef double wide __attribute__((vector_size(8 * CONIC_WIDE_LANES)));
typedef float wide_floats __attribute__((vector_size(4 * CONIC_WIDE_LANES)));
typedef int32_t wide_ints __attribute__((vector_size(4 * CONIC_WIDE_LANES)));
typedef int64_t wide_mask __attribute__((vector_size(8 * CONIC_WIDE_LANES)));

typedef struct doubles {
  wide half[2];
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

/* Both halves by name: gcc 12 would split them into quarters. */
CONIC_INLINE wide half_of(lanes value, int half) {
  __m256d part = half == 0 ? _mm512_castpd512_pd256((__m512d)value) : _mm512_extractf64x4_pd((__m512d)value, 1);
  return (wide)_mm512_cvtps_pd((__m256)part);
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
CONIC_INLINE lanes lanes_join(wide_floats low, wide_floats high) {
  return __builtin_shufflevector(low, high, CONIC_ALL_LANES);
}

CONIC_INLINE int_lanes lanes_join_int(wide_ints low, wide_ints high) {
  return __builtin_shufflevector(low, high, CONIC_ALL_LANES);
}

CONIC_INLINE wide half_of(lanes value, int half) {
  wide_floats floats = half == 0 ? __builtin_shufflevector(value, value, CONIC_LOW_LANES)
                                 : __builtin_shufflevector(value, value, CONIC_HIGH_LANES);
  return __builtin_convertvector(floats, wide);
}

/* Rounded to float. */
CONIC_INLINE lanes lanes_narrow(const doubles *value) {
  return lanes_join(__builtin_convertvector(value->half[0], wide_floats),
                    __builtin_convertvector(value->half[1], wide_floats));
}

/* Truncated; the values are within int32_t. */
CONIC_INLINE int_lanes lanes_truncate(const doubles *value) {
  return lanes_join_int(__builtin_convertvector(value->half[0], wide_ints),
                        __builtin_convertvector(value->half[1], wide_ints));
}

#endif

CONIC_INLINE wide wide_of(double value) {
  return value - (wide){0};
}

CONIC_INLINE wide wide_load(const double *from) {
  wide value;
  memcpy(&value, from, sizeof value);
  return value;
}

CONIC_INLINE void wide_store(double *to, wide value) {
  memcpy(to, &value, sizeof value);
}

CONIC_INLINE wide wide_load_floats(const float *from) {
  wide_floats value;
  memcpy(&value, from, sizeof value);
  return __builtin_convertvector(value, wide);
}

CONIC_INLINE wide wide_select(wide_mask mask, wide yes, wide no) {
  return (wide)((mask & (wide_mask)yes) | (~mask & (wide_mask)no));
}

/* value where the mask holds, else +0. */
CONIC_INLINE wide wide_keep(wide_mask mask, wide value) {
  return (wide)(mask & (wide_mask)value);
}

CONIC_INLINE wide wide_absolute(wide value) {
  return (wide)((wide_mask)value & INT64_MAX);
}

/* Bit l for lane l. */
CONIC_INLINE unsigned wide_bits(wide_mask mask) {
#if defined(__AVX512F__)
  return _mm512_movepi64_mask((__m512i)mask);
#elif defined(__AVX2__)
  return (unsigned)_mm256_movemask_pd((__m256d)mask);
#elif defined(__SSE2__)
  return (unsigned)_mm_movemask_pd((__m128d)mask);
#else
  return (unsigned)(mask[0] & 1) | (unsigned)(mask[1] & 2);
#endif
}

CONIC_INLINE int wide_any(wide_mask mask) {
  return wide_bits(mask) != 0;
}

/* Writes the values of the lanes with a bit one after the other, then anything up to CONIC_WIDE_LANES. */
CONIC_INLINE void wide_append(double *to, unsigned bits, wide value) {
#if defined(__AVX512F__)
  _mm512_storeu_pd(to, _mm512_maskz_compress_pd((__mmask8)bits, (__m512d)value));
#else
  for (int lane = 0; lane < CONIC_WIDE_LANES; to += bits >> lane++ & 1)
    *to = value[lane];
#endif
}

CONIC_INLINE void wide_append_ints(uint32_t *to, unsigned bits, wide_ints value) {
#if defined(__AVX512F__)
  _mm256_storeu_si256((__m256i *)(void *)to, _mm256_maskz_compress_epi32((__mmask8)bits, (__m256i)value));
#else
  for (int lane = 0; lane < CONIC_WIDE_LANES; to += bits >> lane++ & 1)
    *to = (uint32_t)value[lane];
#endif
}

/* a > b ? a : b and a < b ? a : b; the square root; in which lanes a > b holds. a ≤ b is false where one is NaN. */
#if defined(CONIC_NATIVE)

CONIC_INLINE wide wide_max(wide a, wide b) {
  return (wide)CONIC_NATIVE(max_pd)((native_wide)a, (native_wide)b);
}

CONIC_INLINE wide wide_min(wide a, wide b) {
  return (wide)CONIC_NATIVE(min_pd)((native_wide)a, (native_wide)b);
}

CONIC_INLINE wide wide_sqrt(wide a) {
  return (wide)CONIC_NATIVE(sqrt_pd)((native_wide)a);
}

#else

CONIC_INLINE wide wide_max(wide a, wide b) {
  return wide_select(a > b, a, b);
}

CONIC_INLINE wide wide_min(wide a, wide b) {
  return wide_select(a < b, a, b);
}

CONIC_INLINE wide wide_sqrt(wide a) {
  return (wide){__builtin_sqrt(a[0]), __builtin_sqrt(a[1])};
}

#endif

#if defined(__AVX512F__)

CONIC_INLINE lanes_mask lanes_greater_double(const doubles *a, double b) {
  __mmask8 low = _mm512_cmp_pd_mask((__m512d)a->half[0], _mm512_set1_pd(b), _CMP_GT_OQ);
  __mmask8 high = _mm512_cmp_pd_mask((__m512d)a->half[1], _mm512_set1_pd(b), _CMP_GT_OQ);
  return (lanes_mask)(low | high << 8);
}

#else

CONIC_INLINE lanes_mask lanes_greater_double(const doubles *a, double b) {
  return lanes_join_int(__builtin_convertvector(a->half[0] > b, wide_ints),
                        __builtin_convertvector(a->half[1] > b, wide_ints));
}

#endif

#endif
