/* An OpenEXR file that is written band by band, so that nobody has to hold the picture. Its bytes are those of
 * conic_exr_write. */
#ifndef CONIC_IMAGE_EXR_BANDS_H
#define CONIC_IMAGE_EXR_BANDS_H

#include "conic/image.h"

/* The rows of a band are a multiple of that, but for the last: of the rows that any compression takes together. */
enum { CONIC_EXR_BAND = 32 };

typedef struct conic_exr_bands conic_exr_bands;

/* Starts a file of the size, attributes and manifest of `header`, whose planes are not looked at, and with `planes`, as
 * bits. It appears under its name when it is whole. On success the caller owns *bands and ends it by
 * conic_exr_bands_end; `path` is to stay until then. Errors: as conic_exr_check; ARGUMENT (an attribute that the format
 * refuses), MEMORY, IO. */
conic_status conic_exr_bands_open(conic_context *context, const char *path, const conic_image *header, unsigned planes,
                                  const conic_image_options *options, conic_exr_bands **bands);
/* The next rows: an image of the picture's width with at least its planes, compressed by all of the context's threads.
 * Reports progress as "write". Errors: ARGUMENT (no such band), MEMORY, IO, CANCELLED. */
conic_status conic_exr_bands_append(conic_exr_bands *bands, const conic_image *band);
/* After the last band, or with a status other than OK to drop all of it. Releases the writer, which may be null, and
 * returns the status. Errors: ARGUMENT (rows are missing), IO. */
conic_status conic_exr_bands_end(conic_exr_bands *bands, conic_status status);

#endif
