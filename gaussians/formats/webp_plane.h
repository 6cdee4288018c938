/* Pictures of four bytes a pixel as lossless WebP, through libwebp where it is there. */
#pragma once

#include "core/base/base.h"

enum { CONIC_WEBP_MOST_PIXELS_A_SIDE = 16383 };

/* Bytes r, g, b, a, row by row, in a block that the caller releases; no more than `most_pixels`. Errors: INPUT, MEMORY,
 * UNSUPPORTED. */
conic_status conic_webp_decode(conic_context *context, const char *name, const unsigned char *bytes, size_t n_bytes,
                               size_t most_pixels, size_t size[2], unsigned char **pixels);

/* Every byte as it is, whatever alpha says. Errors: MEMORY, UNSUPPORTED. */
conic_status conic_webp_encode(conic_context *context, const unsigned char *pixels, const size_t size[2],
                               unsigned char **bytes, size_t *n_bytes);
