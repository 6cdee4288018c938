/* OpenEXR files through OpenEXRCore. Without it, conic_exr_write is UNSUPPORTED, and conic_exr_read leaves the file to
 * OpenImageIO. It also does so where OpenEXRCore cannot decompress the file (before version 3.2 DWAA and DWAB).
 *
 * Written: one part of scanlines, the channels of conic_plane_describe in alphabetical order, FLOAT (or HALF) and UINT,
 * the attributes, and colorInteropID where colours are display values. Read: the first part, scanlines or tiles, any
 * compression; the data window is the picture. */
#pragma once

#include "conic/image.h"

/* Whether this build writes EXR, which holds every plane. Errors: UNSUPPORTED, ARGUMENT (mattes with a compression that
 * changes their bits). */
conic_status conic_exr_check(conic_context *context, const char *path, unsigned planes,
                             const conic_image_options *options);

/* Errors: ARGUMENT (an attribute that the format refuses), UNSUPPORTED, MEMORY, IO. */
conic_status conic_exr_write(conic_context *context, const char *path, const conic_image *image,
                             const conic_image_options *options);

/* Errors: INPUT, UNSUPPORTED (deep or subsampled), MEMORY. */
conic_status conic_exr_read(conic_context *context, const char *path, conic_image *image);
