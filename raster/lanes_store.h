/* From channels in lanes to pixels in rows: a part of a block is 4 rows, lane l is column l / 4, row l % 4. In each
 * 128 bits a column, so that a transposition within them gives rows of pixels. */
#ifndef RASTER_LANES_STORE_H
#define RASTER_LANES_STORE_H

#include "raster/lanes.h"
#include "raster/stream.h"

typedef float quad __attribute__((vector_size(16)));

/* Column `column` of the part: its four rows. */
CONIC_INLINE quad lanes_column(lanes value, int column) {
  quad rows;
  memcpy(&rows, (const char *)&value + sizeof(quad) * (size_t)column, sizeof rows);
  return rows;
}

/* a[0…3] become rows of four. */
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

/* The records of four fields, or of a multiple of them: record l of lane l, those of `drawn` one after the other.
 * Others may be written where a drawn one follows. */
CONIC_INLINE void lanes_store_records(const lanes *fields, size_t n_fields, unsigned drawn, float *to) {
  float records[CONIC_LANES][16];
  for (size_t first = 0; first < n_fields; first += 4) {
    __m512 rows[4];
    lanes_pixels(fields + first, rows);
    for (size_t row = 0; row < 4; row++) {
      _mm_storeu_ps(records[row] + first, _mm512_castps512_ps128(rows[row]));
      _mm_storeu_ps(records[4 + row] + first, _mm512_extractf32x4_ps(rows[row], 1));
      _mm_storeu_ps(records[8 + row] + first, _mm512_extractf32x4_ps(rows[row], 2));
      _mm_storeu_ps(records[12 + row] + first, _mm512_extractf32x4_ps(rows[row], 3));
    }
  }
  for (; drawn; drawn &= drawn - 1, to += n_fields)
    conic_stream_copy(to, records[__builtin_ctz(drawn)], n_fields * sizeof(float));
}

#else

CONIC_INLINE void lanes_store_records(const lanes *fields, size_t n_fields, unsigned drawn, float *to) {
  float records[CONIC_LANES][16];
  for (size_t first = 0; first < n_fields; first += 4)
    for (int column = 0; column < CONIC_LANES / 4; column++) {
      quad rows[4];
      for (size_t field = 0; field < 4; field++)
        rows[field] = lanes_column(fields[first + field], column);
      quad_transpose(rows);
      for (int row = 0; row < 4; row++)
        memcpy(records[column * 4 + row] + first, &rows[row], sizeof rows[row]);
    }
  for (; drawn; drawn &= drawn - 1, to += n_fields)
    conic_stream_copy(to, records[__builtin_ctz(drawn)], n_fields * sizeof(float));
}

CONIC_INLINE void lanes_store_quads(float *to, size_t stride, const lanes *channels) {
  for (int column = 0; column < CONIC_LANES / 4; column++) {
    quad rows[4];
    for (int channel = 0; channel < 4; channel++)
      rows[channel] = lanes_column(channels[channel], column);
    quad_transpose(rows);
    for (size_t row = 0; row < 4; row++)
      memcpy(to + row * stride + 4 * column, &rows[row], sizeof rows[row]);
  }
}

CONIC_INLINE void lanes_store_triples(float *to, size_t stride, const lanes *channels) {
  for (int column = 0; column < CONIC_LANES / 4; column++) {
    quad rows[4] = {lanes_column(channels[0], column), lanes_column(channels[1], column),
                    lanes_column(channels[2], column)};
    rows[3] = rows[2];
    quad_transpose(rows);
    for (size_t row = 0; row < 4; row++)
      memcpy(to + row * stride + 3 * column, &rows[row], 3 * sizeof(float));
  }
}

CONIC_INLINE void lanes_store_plane(float *to, size_t stride, lanes value) {
  for (int column = 0; column < CONIC_LANES / 4; column++)
    for (size_t row = 0; row < 4; row++)
      to[row * stride + (size_t)column] = value[column * 4 + (int)row];
}

#endif

#endif
