/* Tables of 16 numbers in registers; every lane looks up its own place. */
#ifndef CONIC_LANES_TABLE_H
#define CONIC_LANES_TABLE_H

#include "core/lanes/lanes.h"

#define CONIC_TABLE_PARTS (16 / CONIC_LANES)

typedef struct lanes_table {
  lanes part[CONIC_TABLE_PARTS];
} lanes_table;

/* The numbers at the places, 0 to 15. */
#if defined(__AVX512F__)
CONIC_INLINE lanes lanes_look_up(const lanes_table *table, int_lanes place) {
  return (lanes)_mm512_permutexvar_ps((__m512i)place, (__m512)table->part[0]);
}
#elif defined(__AVX2__)
CONIC_INLINE lanes lanes_look_up(const lanes_table *table, int_lanes place) {
  __m256 low = _mm256_permutevar8x32_ps((__m256)table->part[0], (__m256i)place);
  __m256 high = _mm256_permutevar8x32_ps((__m256)table->part[1], (__m256i)place);
  return (lanes)_mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32((__m256i)place, 28)));
}
#else
CONIC_INLINE lanes lanes_look_up(const lanes_table *table, int_lanes place) {
  const float *numbers = (const float *)(const void *)table;
  lanes value;
  for (int lane = 0; lane < CONIC_LANES; lane++)
    value[lane] = numbers[place[lane] & 15];
  return value;
}
#endif

#endif
