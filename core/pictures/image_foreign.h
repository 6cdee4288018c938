/* The formats of other libraries (TIFF, JPEG, HDR …) through OpenImageIO, which moves finished samples only: how
 * linear colour becomes codes is decided here, so that the codes are the same whatever the library's version.
 *
 * Written: rgba. 8 bits, sRGB-encoded, for all but: tif 16 bits, sRGB-encoded; hdr (and other floating-point formats)
 * linear floats. Where the format has an alpha channel the colour is divided by alpha before it is encoded; where it
 * has none, the picture stands over black. Read: rgba, by the same rules backwards; grey goes to R, G and B; without
 * alpha A is 1. Of an EXR all planes are read, by the names of its channels. */
#ifndef CONIC_IMAGE_FOREIGN_H
#define CONIC_IMAGE_FOREIGN_H

#include "conic/image.h"

/* Whether some of these planes (bits) can be written in the format that an ending means. Errors: ARGUMENT, UNSUPPORTED,
 * MEMORY. */
conic_status conic_foreign_check(conic_context *context, const char *path, const char *ending, unsigned planes);

/* Errors: ARGUMENT (no rgba, an ending that nobody knows), UNSUPPORTED, MEMORY, IO. */
conic_status conic_foreign_write(conic_context *context, const char *path, const char *ending, const conic_image *image,
                                 conic_tone tone);

/* Errors: INPUT, UNSUPPORTED, MEMORY. */
conic_status conic_foreign_read(conic_context *context, const char *path, conic_image *image);

/* What size a JPEG, GIF or WebP says that it has: 1, or 0 where the file is none, or damaged. */
int conic_foreign_size(const char *path, int *width, int *height);

#endif
