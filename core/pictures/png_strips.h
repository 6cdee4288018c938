/* The pixels of a PNG, filtered and packed in strips of rows by all threads. */
#pragma once

#include <stdio.h>

#include "conic/image.h"

/* Writes the picture's colours as straight sRGB codes of R, G, B and A, in chunks IDAT, whose bytes do not depend on
 * the number of threads. The build has libpng, and so zlib. What the stream refuses it remembers. Errors: MEMORY,
 * CANCELLED. */
conic_status conic_png_write_strips(conic_context *context, const conic_image *image, conic_tone tone, FILE *to);
