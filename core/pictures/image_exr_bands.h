/* An OpenEXR file that is written band by band, so that nobody has to hold the picture. Its bytes are those of
 * conic_exr_write. */
#ifndef CONIC_IMAGE_EXR_BANDS_H
#define CONIC_IMAGE_EXR_BANDS_H

#include "conic/image.h"

/* The rows of a band are a multiple of that, but for the last: of the rows that any compression takes together. */
enum { CONIC_EXR_BAND = 32 };

typedef struct conic_exr_bands conic_exr_bands;

/* Starts a file of the size, attributes and manifest of `header`, whose planes are not looked at, and with `planes`, as
 * bits. It appears under its name when it is whole; until then it is `part`, which also stays when it is dropped, or
 * where that is null a hidden file. On success the caller owns *bands and ends it by conic_exr_bands_end; `path` is to
 * stay until then. Errors: as conic_exr_check; ARGUMENT (an attribute that the format
 * refuses), MEMORY, IO. */
conic_status conic_exr_bands_open(conic_context *context, const char *path, const char *part, const conic_image *header,
                                  unsigned planes, const conic_image_options *options, conic_exr_bands **bands);
/* The next rows: an image of the picture's width with at least its planes, compressed by all of the context's threads.
 * Reports progress as "write". Errors: ARGUMENT (no such band), MEMORY, IO, CANCELLED. */
conic_status conic_exr_bands_append(conic_exr_bands *bands, const conic_image *band);
/* A writer without a file: of a picture of that size, it packs rows for whoever writes them. As conic_exr_bands_open.
 */
conic_status conic_exr_packer_open(conic_context *context, int width, int height, unsigned planes,
                                   const conic_image_options *options, conic_exr_bands **bands);
/* Memory that packing takes at most, about. */
uint64_t conic_exr_packer_bytes(const conic_exr_bands *bands);
/* Takes rows of the picture as they stand in the file, from the top; an answer other than CONIC_OK ends packing. */
typedef conic_status conic_exr_receiver(void *cookie, int y, int n_rows, const void *bytes, size_t n_bytes);
/* Packs the picture's rows from `begin` to before `end`, both multiples of CONIC_EXR_BAND or the picture's end, of an
 * image that begins at the row `first`. With is_alone the calling thread does it all. Errors: MEMORY, CANCELLED,
 * ARGUMENT, the receiver's. */
conic_status conic_exr_pack(conic_exr_bands *bands, const conic_image *image, int first, int begin, int end,
                            int is_alone, conic_exr_receiver *receive, void *cookie);
/* The next rows, as a writer of the same size, planes and options packed them. One thread at a time. Errors: ARGUMENT
 * (others than the next), IO. */
conic_status conic_exr_bands_append_packed(conic_exr_bands *bands, int y, int n_rows, const void *bytes,
                                           size_t n_bytes);
/* How long the file is so far: the rows that were appended last are its end. */
uint64_t conic_exr_bands_length(const conic_exr_bands *bands);
/* Hands what was appended to the system, which keeps it if the program is killed. Errors: IO. */
conic_status conic_exr_bands_flush(conic_exr_bands *bands);
/* After the last band, or with a status other than OK to drop all of it. Releases the writer, which may be null, and
 * returns the status. Errors: ARGUMENT (rows are missing), IO. */
conic_status conic_exr_bands_end(conic_exr_bands *bands, conic_status status);

#endif
