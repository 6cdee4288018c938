/* Shared by both ways of packing: predictions of differences, tables of returns, and the codes of times, colours and
 * waveforms. */
#pragma once

#include "core/laz/laz_stream.h"

/* Roughly the median of the last five values: a new value replaces the largest or the smallest, in turn. All zero at
 * first, except `drops_largest`. */
typedef struct conic_laz_median {
  int32_t sorted[5];
  int drops_largest;
} conic_laz_median;

static inline void conic_laz_median_begin(conic_laz_median *medians, size_t n) {
  for (size_t i = 0; i < n; i++)
    medians[i] = (conic_laz_median){.drops_largest = 1};
}

static inline int32_t conic_laz_lesser(int32_t a, int32_t b) {
  return a < b ? a : b;
}

static inline int32_t conic_laz_greater(int32_t a, int32_t b) {
  return a > b ? a : b;
}

/* Replaces the largest or smallest value by a new one. */
static inline void conic_laz_median_add(conic_laz_median *median, int32_t value) {
  int32_t *s = median->sorted, middle = s[2];
  const int32_t *stay = median->drops_largest ? s : s + 1;
  int32_t a = stay[0], b = stay[1], c = stay[2], d = stay[3];
  s[0] = conic_laz_lesser(a, value);
  s[1] = conic_laz_greater(a, conic_laz_lesser(b, value));
  s[2] = conic_laz_greater(b, conic_laz_lesser(c, value));
  s[3] = conic_laz_greater(c, conic_laz_lesser(d, value));
  s[4] = conic_laz_greater(d, value);
  median->drops_largest = median->drops_largest ? value < middle : value <= middle;
}

/* The step of a coordinate, predicted by such a median; the error's code depends on the context. */
static inline int32_t conic_laz_step(conic_laz_stream *stream, conic_laz_integer *integer, conic_laz_median *median,
                                     unsigned context) {
  int32_t step = conic_laz_integer_32(stream, integer, median->sorted[2], context);
  conic_laz_median_add(median, step);
  return step;
}

/* A context from how many bits the previous coordinates' errors had, in steps of two. */
static inline unsigned conic_laz_context(unsigned k, unsigned most, int is_single) {
  return (k < most ? k & ~1u : most) + (unsigned)is_single;
}

/* The context of the r-th of n returns: one of 16 in point formats up to 5, one of 6 in the others. */
extern const char conic_laz_returns_16[8][9], conic_laz_returns_6[16][17];

/* How far a return is below the first, or above it where counts are mixed up. */
static inline unsigned conic_laz_level(unsigned n, unsigned r) {
  unsigned level = n > r ? n - r : r - n;
  return level < 7 ? level : 7;
}

/* Four interleaved sequences of times. The differences are multiples of the last one. */
typedef struct conic_laz_times {
  unsigned last, next;
  uint64_t time[4];
  int32_t step[4], n_extreme[4];
  conic_laz_model multiple, first;
  conic_laz_integer off;
} conic_laz_times;

/* Begins the sequences with the first time; everything else is zero. */
static inline void conic_laz_times_begin(conic_laz_times *times, uint64_t first) {
  times->time[0] = first;
}

/* The next time; in point formats up to 5 it may be the same as before. */
uint64_t conic_laz_time(conic_laz_stream *stream, conic_laz_times *times, int may_be_same);

/* Codes which bytes of a colour are new, and by how much they changed. All zero at first. */
typedef struct conic_laz_colors {
  conic_laz_model changed, off[6];
} conic_laz_colors;

/* Decodes the colour after `last`. Both are three numbers of 16 bits, as in a record; they may be at the same place. */
void conic_laz_color(conic_laz_stream *stream, conic_laz_colors *colors, const unsigned char *last,
                     unsigned char *color);

typedef struct conic_laz_nirs {
  conic_laz_model changed, off[2];
} conic_laz_nirs;

void conic_laz_nir(conic_laz_stream *stream, conic_laz_nirs *nirs, const unsigned char *last, unsigned char *nir);

enum { CONIC_LAZ_WAVE_BYTES = 29 };

typedef struct conic_laz_waves {
  conic_laz_model index, offset_kind[4];
  conic_laz_integer offset, n_bytes, location, direction;
  unsigned last_kind;
  int32_t last_step;
} conic_laz_waves;

/* Decodes the description of a waveform after `last`; they may be at the same place. */
void conic_laz_wave(conic_laz_stream *stream, conic_laz_waves *waves, const unsigned char *last, unsigned char *wave);
