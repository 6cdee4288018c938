/* Numbers as bytes: the one place that knows this machine's byte order. Files are little-endian unless their format
 * says otherwise; on a little-endian machine each of these is a plain load or store. */
#pragma once

#include <stddef.h>

#include "core/base/real.h"

#define CONIC_IS_BIG_ENDIAN (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)

static inline uint16_t conic_load_16(const void *from) {
  uint16_t bits;
  memcpy(&bits, from, sizeof bits);
  return CONIC_IS_BIG_ENDIAN ? __builtin_bswap16(bits) : bits;
}

static inline uint32_t conic_load_32(const void *from) {
  uint32_t bits;
  memcpy(&bits, from, sizeof bits);
  return CONIC_IS_BIG_ENDIAN ? __builtin_bswap32(bits) : bits;
}

static inline uint64_t conic_load_64(const void *from) {
  uint64_t bits;
  memcpy(&bits, from, sizeof bits);
  return CONIC_IS_BIG_ENDIAN ? __builtin_bswap64(bits) : bits;
}

static inline float conic_load_float(const void *from) {
  return conic_float_of_bits(conic_load_32(from));
}

static inline double conic_load_double(const void *from) {
  return conic_double_of_bits(conic_load_64(from));
}

/* A number of up to eight bytes. */
static inline uint64_t conic_load_bits(const void *from, size_t n_bytes) {
  uint64_t bits = 0;
  memcpy(&bits, from, n_bytes);
  return CONIC_IS_BIG_ENDIAN ? __builtin_bswap64(bits) : bits;
}

static inline void conic_store_32(void *to, uint32_t bits) {
  bits = CONIC_IS_BIG_ENDIAN ? __builtin_bswap32(bits) : bits;
  memcpy(to, &bits, sizeof bits);
}

static inline void conic_store_64(void *to, uint64_t bits) {
  bits = CONIC_IS_BIG_ENDIAN ? __builtin_bswap64(bits) : bits;
  memcpy(to, &bits, sizeof bits);
}

static inline void conic_store_float(void *to, float value) {
  conic_store_32(to, conic_bits_of_float(value));
}

static inline void conic_store_double(void *to, double value) {
  conic_store_64(to, conic_bits_of_double(value));
}

/* The lowest bytes of a number, up to eight. */
static inline void conic_store_bits(void *to, size_t n_bytes, uint64_t bits) {
  bits = CONIC_IS_BIG_ENDIAN ? __builtin_bswap64(bits) : bits;
  memcpy(to, &bits, n_bytes);
}

/* --- big-endian numbers --- */

static inline uint16_t conic_load_big_16(const void *from) {
  return __builtin_bswap16(conic_load_16(from));
}

static inline uint32_t conic_load_big_32(const void *from) {
  return __builtin_bswap32(conic_load_32(from));
}

static inline uint64_t conic_load_big_64(const void *from) {
  return __builtin_bswap64(conic_load_64(from));
}

static inline void conic_store_big_32(void *to, uint32_t bits) {
  conic_store_32(to, __builtin_bswap32(bits));
}

static inline void conic_store_big_64(void *to, uint64_t bits) {
  conic_store_64(to, __builtin_bswap64(bits));
}

/* --- arrays --- */

/* Turns words of 1, 2, 4 or 8 bytes between a file's order and the machine's, in place. */
static inline void conic_turn_words(void *words, size_t n, size_t n_bytes) {
  unsigned char *word = words;
  for (size_t i = 0; CONIC_IS_BIG_ENDIAN && n_bytes > 1 && i < n; i++, word += n_bytes)
    for (size_t a = 0, b = n_bytes - 1; a < b; a++, b--) {
      unsigned char byte = word[a];
      word[a] = word[b];
      word[b] = byte;
    }
}
