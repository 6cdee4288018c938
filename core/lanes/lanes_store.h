/* From channels in lanes to pixels in rows. A part of a block is 4 rows; lane l is column l / 4, row l % 4. Each column
 * is 128 bits, so that transposing within them gives rows of pixels. */
#pragma once

#include "core/lanes/lanes.h"
#include "core/lanes/stream.h"

typedef float quad __attribute__((vector_size(16)));

/* Copies half a cache line or a whole one, aligned so, past the caches. */
CONIC_INLINE void lanes_stream(void *to, const void *from, size_t bytes) {
#if defined(__AVX512F__)
  if (bytes == 64) {
    _mm512_stream_si512(to, _mm512_load_si512(from));
    return;
  }
#endif
#if defined(__AVX2__)
  for (size_t at = 0; at < bytes; at += 32)
    _mm256_stream_si256((__m256i *)(void *)((char *)to + at),
                        _mm256_load_si256((const __m256i *)(const void *)((const char *)from + at)));
#else
  conic_stream_copy(to, from, bytes);
#endif
}

/* Column `column` of the part: its four rows. */
CONIC_INLINE quad lanes_column(lanes value, int column) {
  quad rows;
  memcpy(&rows, (const char *)&value + sizeof(quad) * (size_t)column, sizeof rows);
  return rows;
}

/* Copies a row of pixels past the caches, in whole lines where possible. */
CONIC_INLINE void lanes_stream_row(float *to, const float *from, size_t n) {
  size_t i = 0;
#if defined(__AVX512F__)
  for (; (uintptr_t)to % 64 == 0 && i + 16 <= n; i += 16)
    _mm512_stream_ps(to + i, _mm512_loadu_ps(from + i));
#elif defined(__AVX2__)
  for (; (uintptr_t)to % 32 == 0 && i + 8 <= n; i += 8)
    _mm256_stream_ps(to + i, _mm256_loadu_ps(from + i));
#endif
  conic_stream_copy(to + i, from + i, (n - i) * sizeof *to);
}

/* Transposes a[0…3] into rows of four. */
CONIC_INLINE void quad_transpose(quad a[4]) {
  quad low01 = __builtin_shufflevector(a[0], a[1], 0, 4, 1, 5),
       high01 = __builtin_shufflevector(a[0], a[1], 2, 6, 3, 7);
  quad low23 = __builtin_shufflevector(a[2], a[3], 0, 4, 1, 5),
       high23 = __builtin_shufflevector(a[2], a[3], 2, 6, 3, 7);
  a[0] = __builtin_shufflevector(low01, low23, 0, 1, 4, 5);
  a[1] = __builtin_shufflevector(low01, low23, 2, 3, 6, 7);
  a[2] = __builtin_shufflevector(high01, high23, 0, 1, 4, 5);
  a[3] = __builtin_shufflevector(high01, high23, 2, 3, 6, 7);
}

#if defined(__AVX512F__)

/* rows[r]: the pixels of row r, four channels each. */
CONIC_INLINE void lanes_pixels(const lanes channels[4], __m512 rows[4]) {
  __m512 low01 = _mm512_unpacklo_ps((__m512)channels[0], (__m512)channels[1]);
  __m512 high01 = _mm512_unpackhi_ps((__m512)channels[0], (__m512)channels[1]);
  __m512 low23 = _mm512_unpacklo_ps((__m512)channels[2], (__m512)channels[3]);
  __m512 high23 = _mm512_unpackhi_ps((__m512)channels[2], (__m512)channels[3]);
  rows[0] = _mm512_shuffle_ps(low01, low23, 0x44);
  rows[1] = _mm512_shuffle_ps(low01, low23, 0xee);
  rows[2] = _mm512_shuffle_ps(high01, high23, 0x44);
  rows[3] = _mm512_shuffle_ps(high01, high23, 0xee);
}

/* Loads eight fields of the records with the lanes' numbers. */
CONIC_INLINE void lanes_gather_records(const float *records, const uint32_t *indices, lanes fields[8]) {
  for (int half = 0; half < 2; half++) {
    lanes quads[4];
    __m512 rows[4];
    const float *from = records + 4 * (size_t)half;
    for (int row = 0; row < 4; row++) {
      __m512 four = _mm512_castps128_ps512(_mm_loadu_ps(from + (size_t)indices[row] * 8));
      four = _mm512_insertf32x4(four, _mm_loadu_ps(from + (size_t)indices[4 + row] * 8), 1);
      four = _mm512_insertf32x4(four, _mm_loadu_ps(from + (size_t)indices[8 + row] * 8), 2);
      quads[row] = (lanes)_mm512_insertf32x4(four, _mm_loadu_ps(from + (size_t)indices[12 + row] * 8), 3);
    }
    lanes_pixels(quads, rows);
    for (int field = 0; field < 4; field++)
      fields[4 * half + field] = (lanes)rows[field];
  }
}

CONIC_INLINE void lanes_store_quads(float *to, size_t stride, const lanes *channels) {
  __m512 rows[4];
  lanes_pixels(channels, rows);
  for (size_t row = 0; row < 4; row++)
    _mm512_storeu_ps(to + row * stride, rows[row]);
}

CONIC_INLINE void lanes_store_triples(float *to, size_t stride, const lanes *channels) {
  const lanes with_fourth[4] = {channels[0], channels[1], channels[2], channels[2]};
  __m512 rows[4];
  lanes_pixels(with_fourth, rows);
  for (size_t row = 0; row < 4; row++)
    _mm512_mask_storeu_ps(to + row * stride, 0x0fff, _mm512_maskz_compress_ps(0x7777, rows[row]));
}

CONIC_INLINE void lanes_store_plane(float *to, size_t stride, lanes value) {
  const __m512i by_row = _mm512_setr_epi32(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
  __m512 rows = _mm512_permutexvar_ps(by_row, (__m512)value);
  _mm_storeu_ps(to, _mm512_castps512_ps128(rows));
  _mm_storeu_ps(to + stride, _mm512_extractf32x4_ps(rows, 1));
  _mm_storeu_ps(to + 2 * stride, _mm512_extractf32x4_ps(rows, 2));
  _mm_storeu_ps(to + 3 * stride, _mm512_extractf32x4_ps(rows, 3));
}

/* The first 16 fields of a record a lane: records[l] is that of lane l. */
CONIC_INLINE void lanes_whole_records(const lanes *fields, __m512 records[16]) {
  __m512 rows[4][4];
  for (int quarter = 0; quarter < 4; quarter++)
    lanes_pixels(fields + 4 * (size_t)quarter, rows[quarter]);
  for (int row = 0; row < 4; row++) {
    __m512 low01 = _mm512_shuffle_f32x4(rows[0][row], rows[1][row], 0x44);
    __m512 high01 = _mm512_shuffle_f32x4(rows[0][row], rows[1][row], 0xee);
    __m512 low23 = _mm512_shuffle_f32x4(rows[2][row], rows[3][row], 0x44);
    __m512 high23 = _mm512_shuffle_f32x4(rows[2][row], rows[3][row], 0xee);
    records[row] = _mm512_shuffle_f32x4(low01, low23, 0x88);
    records[4 + row] = _mm512_shuffle_f32x4(low01, low23, 0xdd);
    records[8 + row] = _mm512_shuffle_f32x4(high01, high23, 0x88);
    records[12 + row] = _mm512_shuffle_f32x4(high01, high23, 0xdd);
  }
}

/* Records of 8 fields: records[l] is that of lane l. */
CONIC_INLINE void lanes_half_records(const lanes *fields, __m256 records[16]) {
  __m512 rows[2][4];
  lanes_pixels(fields, rows[0]);
  lanes_pixels(fields + 4, rows[1]);
  for (int row = 0; row < 4; row++) {
    __m512 low = _mm512_shuffle_f32x4(rows[0][row], rows[1][row], 0x44);
    __m512 high = _mm512_shuffle_f32x4(rows[0][row], rows[1][row], 0xee);
    low = _mm512_shuffle_f32x4(low, low, 0xd8);
    high = _mm512_shuffle_f32x4(high, high, 0xd8);
    records[row] = _mm512_castps512_ps256(low);
    records[4 + row] = _mm512_extractf32x8_ps(low, 1);
    records[8 + row] = _mm512_castps512_ps256(high);
    records[12 + row] = _mm512_extractf32x8_ps(high, 1);
  }
}

/* Stores records of 16 or 8 fields, lane l's being record l: those of `drawn`, one after the other. One place after the
 * last may be written, too. */
CONIC_INLINE void lanes_store_records(const lanes *fields, size_t n_fields, unsigned drawn, float *to) {
  __m512 whole[16];
  __m256 half[16];
  if (n_fields == 16)
    lanes_whole_records(fields, whole);
  else
    lanes_half_records(fields, half);
  if (__builtin_expect(drawn == 0xffff, 1)) {
    for (int lane = 0; lane < 16; lane++)
      if (n_fields == 16)
        _mm512_storeu_ps(to + (size_t)lane * 16, whole[lane]);
      else
        _mm256_storeu_ps(to + (size_t)lane * 8, half[lane]);
    return;
  }
  for (int lane = 0; lane < 16; lane++) {
    if (n_fields == 16)
      _mm512_storeu_ps(to, whole[lane]);
    else
      _mm256_storeu_ps(to, half[lane]);
    to += (drawn >> lane & 1) * n_fields;
  }
}

/* Writes pairs of the masked values, one after the other, then anything up to CONIC_LANES pairs. */
CONIC_INLINE void lanes_append_pairs(uint32_t *to, lanes_mask mask, index_lanes first, index_lanes second) {
  const __m512i low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i high = _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
  __m512i packed_first = _mm512_maskz_compress_epi32(mask, (__m512i)first);
  __m512i packed_second = _mm512_maskz_compress_epi32(mask, (__m512i)second);
  _mm512_storeu_si512(to, _mm512_permutex2var_epi32(packed_first, low, packed_second));
  _mm512_storeu_si512(to + 16, _mm512_permutex2var_epi32(packed_first, high, packed_second));
}

#else

CONIC_INLINE void lanes_gather_records(const float *records, const uint32_t *indices, lanes fields[8]) {
  float columns[8][CONIC_LANES];
  for (int lane = 0; lane < CONIC_LANES; lane++)
    for (int field = 0; field < 8; field++)
      columns[field][lane] = records[(size_t)indices[lane] * 8 + (size_t)field];
  for (int field = 0; field < 8; field++)
    fields[field] = lanes_load(columns[field]);
}

CONIC_INLINE void lanes_store_records(const lanes *fields, size_t n_fields, unsigned drawn, float *to) {
  float packed[CONIC_LANES][16];
  int are_all = drawn == (1u << CONIC_LANES) - 1; /* then each goes straight to its place */
  float *records = are_all ? to : packed[0];
  size_t stride = are_all ? n_fields : 16;
  for (size_t first = 0; first < n_fields; first += 4)
    for (int column = 0; column < CONIC_LANES / 4; column++) {
      quad rows[4];
      for (size_t field = 0; field < 4; field++)
        rows[field] = lanes_column(fields[first + field], column);
      quad_transpose(rows);
      for (int row = 0; row < 4; row++)
        memcpy(records + (size_t)(column * 4 + row) * stride + first, &rows[row], sizeof rows[row]);
    }
  for (int lane = 0; lane < CONIC_LANES && !are_all; lane++) {
    memcpy(to, packed[lane], n_fields * sizeof(float));
    to += (drawn >> lane & 1) * n_fields;
  }
}

CONIC_INLINE void lanes_append_pairs(uint32_t *to, lanes_mask mask, index_lanes first, index_lanes second) {
  unsigned bits = lanes_bits(mask);
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    to[0] = first[lane];
    to[1] = second[lane];
    to += (size_t)(bits >> lane & 1) * 2;
  }
}

CONIC_INLINE void lanes_store_quads(float *to, size_t stride, const lanes *channels) {
  for (int column = 0; column < CONIC_LANES / 4; column++) {
    quad rows[4];
    for (int channel = 0; channel < 4; channel++)
      rows[channel] = lanes_column(channels[channel], column);
    quad_transpose(rows);
    for (size_t row = 0; row < 4; row++)
      memcpy(to + row * stride + 4 * (size_t)column, &rows[row], sizeof rows[row]);
  }
}

CONIC_INLINE void lanes_store_triples(float *to, size_t stride, const lanes *channels) {
  for (int column = 0; column < CONIC_LANES / 4; column++) {
    quad rows[4] = {lanes_column(channels[0], column), lanes_column(channels[1], column),
                    lanes_column(channels[2], column)};
    rows[3] = rows[2];
    quad_transpose(rows);
    for (size_t row = 0; row < 4; row++)
      memcpy(to + row * stride + 3 * (size_t)column, &rows[row], 3 * sizeof(float));
  }
}

CONIC_INLINE void lanes_store_plane(float *to, size_t stride, lanes value) {
  for (int column = 0; column < CONIC_LANES / 4; column++)
    for (size_t row = 0; row < 4; row++)
      to[row * stride + (size_t)column] = value[column * 4 + (int)row];
}

#endif
