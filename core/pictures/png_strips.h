/* The pixels of a PNG, filtered and packed in strips of rows by all threads. */
#pragma once

#include <stdio.h>

#include "core/pictures/image_png.h"

/* Where a chunk's data begin, after its length and name. */
enum { CONIC_PNG_DATA = 8 };

/* Puts length, name and sum about n bytes of data that stand in their place; returns the bytes of the chunk. */
size_t conic_png_close_chunk(unsigned char *chunk, const char *name, size_t n);

/* Writes the picture's colours as straight sRGB codes of R, G, B and A, in chunks IDAT, whose bytes do not depend on
 * the number of threads. Without zlib they are stored, not packed. What the stream refuses it remembers. Where `rows`
 * is not null, the codes are its rows, and of the image only the size counts. Errors: MEMORY, CANCELLED, and what
 * `rows` returns. */
conic_status conic_png_write_strips(conic_context *context, const conic_image *image, conic_tone tone,
                                    const conic_png_rows *rows, FILE *to);
