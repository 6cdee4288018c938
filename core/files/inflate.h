/* Unpacking deflated data, with zlib where it is there. */
#pragma once

#include "core/base/base.h"

typedef enum conic_deflate_wrapping { CONIC_DEFLATE_BARE, CONIC_DEFLATE_GZIP } conic_deflate_wrapping;

/* The most bytes that n bytes can unpack to: a match of 258 takes two bits. */
static inline double conic_inflate_most_bytes(size_t n) {
  return 1032.0 * (double)n + 1032.0;
}

/* Unpacks up to n_bytes; returns how many there were, or fewer where the data are spoiled or zlib is not there.
 * *is_whole, if not null, says whether the data go on to their end, beyond n_bytes, with the right sum. */
size_t conic_inflate(conic_deflate_wrapping wrapping, const unsigned char *from, size_t n_from, unsigned char *to,
                     size_t n_bytes, int *is_whole);

int conic_inflate_is_there(void);

/* Packs as gzip into a new block, which the caller releases. Errors: MEMORY, UNSUPPORTED. */
conic_status conic_gzip(conic_context *context, const unsigned char *from, size_t n_from, unsigned char **to,
                        size_t *n_to);
