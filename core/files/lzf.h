/* LZF, the packing of LibLZF: unpacking only. A byte n below 32 is followed by n + 1 bytes that are copied. Any other
 * byte begins a copy of unpacked bytes: three bits of its length, 13 of its distance. */
#pragma once

#include "core/base/base.h"

/* The most bytes that `n_packed` can unpack to: three of them give at most 264. */
static inline uint64_t conic_lzf_most_bytes(uint64_t n_packed) {
  return n_packed * 88;
}

/* Returns whether unpacking gives exactly n_bytes. */
int conic_lzf_unpack(const unsigned char *packed, size_t n_packed, unsigned char *bytes, size_t n_bytes);
