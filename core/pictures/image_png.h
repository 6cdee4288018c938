/* PNG files through libpng. A build without it leaves them to OpenImageIO, which gives the same samples.
 *
 * Written: rgba, 8 bits, sRGB-encoded and marked so, the colour divided by alpha. Read: any kind; grey, palettes and
 * transparent colours become channels, and colours are sRGB-encoded whatever the file says of its gamma. */
#pragma once

#include <stdio.h>

#include "conic/image.h"

/* Whether this build writes PNG, and one of these planes (bits) is one that a PNG holds. Errors: ARGUMENT, UNSUPPORTED,
 * MEMORY. */
conic_status conic_png_check(conic_context *context, const char *path, unsigned planes);

/* Errors: ARGUMENT (no rgba), UNSUPPORTED, MEMORY, IO. */
conic_status conic_png_write(conic_context *context, const char *path, const conic_image *image, conic_tone tone);

/* conic_png_write to a stream, without a curve; the caller checks the stream for errors. Errors: ARGUMENT, UNSUPPORTED,
 * MEMORY. */
conic_status conic_png_write_to(conic_context *context, FILE *stream, const conic_image *image);

/* A picture that nobody holds: rows of R, G, B, A, a byte each, which `next` fills from the top, and how many pixels an
 * inch has. Errors: as conic_png_write, and what `next` returns. */
typedef struct conic_png_rows {
  int width, height;
  double dpi;
  void *cookie;
  conic_status (*next)(void *cookie, int y, unsigned char *row);
} conic_png_rows;
conic_status conic_png_write_rows(conic_context *context, const char *path, const conic_png_rows *rows);

/* Errors: INPUT, UNSUPPORTED, MEMORY. */
conic_status conic_png_read(conic_context *context, const char *path, conic_image *image);

/* Reads the codes without decoding, each divided by *most_code, the greatest possible code: 255 or 65535. */
conic_status conic_png_read_codes(conic_context *context, const char *path, conic_image *image, unsigned *most_code);
