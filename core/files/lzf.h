/* LZF, the packing of LibLZF: unpacking only. A byte below 32 says how many bytes less one follow as they are; any
 * other begins a copy of what was unpacked before: three bits of its length, 13 of its distance. */
#ifndef CONIC_LZF_H
#define CONIC_LZF_H

#include <stddef.h>
#include <stdint.h>

/* More than so many bytes cannot come of `n_packed`: three of them are 264 at most. */
static inline uint64_t conic_lzf_most_bytes(uint64_t n_packed) {
  return n_packed * 88;
}

/* Whether unpacking comes to n_bytes exactly. */
int conic_lzf_unpack(const unsigned char *packed, size_t n_packed, unsigned char *bytes, size_t n_bytes);

#endif
