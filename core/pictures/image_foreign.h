/* The formats of other libraries (TIFF, JPEG, HDR …) through OpenImageIO, which only moves finished samples. Linear
 * colour becomes codes here, so that the codes do not depend on the library's version.
 *
 * Written: rgba. 16 bits, sRGB-encoded, for tif; linear floats for hdr and other floating-point formats; else 8 bits,
 * sRGB-encoded. Where the format has an alpha channel the colour is divided by alpha before it is encoded; where it has
 * none, the picture stands over black. Read: rgba, by the same rules backwards; grey goes to R, G and B; without alpha
 * A is 1. Of an EXR all planes are read, by the names of its channels. */
#pragma once

#include "conic/image.h"

/* Whether some of these planes (bits) can be written in an ending's format. Errors: ARGUMENT, UNSUPPORTED, MEMORY. */
conic_status conic_foreign_check(conic_context *context, const char *path, const char *ending, unsigned planes);

/* Errors: ARGUMENT (no rgba, an unknown ending), UNSUPPORTED, MEMORY, IO. */
conic_status conic_foreign_write(conic_context *context, const char *path, const char *ending, const conic_image *image,
                                 conic_tone tone);

/* Errors: INPUT, UNSUPPORTED, MEMORY. */
conic_status conic_foreign_read(conic_context *context, const char *path, conic_image *image);

/* The size that a JPEG, GIF or WebP states; returns 0 for a damaged file, or one of another format. */
int conic_foreign_size(const char *path, int *width, int *height);
