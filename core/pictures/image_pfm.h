/* Portable float maps: linear floats without compression, no library needed.
 *
 * Written: rgba as colour (R, G, B as they are, over black); without rgba, a single other plane, as colour or as grey.
 * Whole numbers become floats if floats hold them, and -1 where nothing is. Little-endian, rows from the bottom. Read:
 * either byte order; the scale's size is ignored; grey goes to R, G and B; A is 1. */
#pragma once

#include "conic/image.h"

/* Whether a plane of these (bits) can be written. Errors: ARGUMENT. */
conic_status conic_pfm_check(conic_context *context, const char *path, unsigned planes);

/* Errors: ARGUMENT (no plane that it can hold), UNSUPPORTED (numbers that floats cannot hold), MEMORY, IO. */
conic_status conic_pfm_write(conic_context *context, const char *path, const conic_image *image);

/* Errors: INPUT, MEMORY. */
conic_status conic_pfm_read(conic_context *context, const char *path, conic_image *image);
