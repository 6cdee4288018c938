/* An OpenEXR file written band by band, so that nobody has to hold the whole picture. Its bytes are
 * conic_exr_write's. */
#pragma once

#include "conic/image.h"

/* The rows of a band, except the last, are a multiple of this, so that they fill whole chunks of any compression. */
enum { CONIC_EXR_BAND = 32 };

typedef struct conic_exr_bands conic_exr_bands;

/* Starts a file with `planes` (bits), and with the size, attributes and manifest of `header`, whose planes are ignored.
 * It appears under its name when it is whole. Until then it is `part`, which stays when the file is dropped, or, for a
 * null `part`, a hidden file. On success the caller owns *bands and ends it with conic_exr_bands_end; `path` must
 * outlive it. Errors: as conic_exr_check; ARGUMENT (an attribute that the format refuses), MEMORY, IO. */
conic_status conic_exr_bands_open(conic_context *context, const char *path, const char *part, const conic_image *header,
                                  unsigned planes, const conic_image_options *options, conic_exr_bands **bands);
/* Appends the next rows: an image of the picture's width with at least its planes. All of the context's threads
 * compress it. Reports progress as "write". Errors: ARGUMENT (no such band), MEMORY, IO, CANCELLED. */
conic_status conic_exr_bands_append(conic_exr_bands *bands, const conic_image *band);
/* A writer without a file: it packs rows of a picture of that size for another writer. As conic_exr_bands_open. */
conic_status conic_exr_packer_open(conic_context *context, int width, int height, unsigned planes,
                                   const conic_image_options *options, conic_exr_bands **bands);
/* About the most memory that packing takes. */
uint64_t conic_exr_packer_bytes(const conic_exr_bands *bands);
/* Takes packed rows of the picture as a file holds them, from the top; an answer other than CONIC_OK ends packing. */
typedef conic_status conic_exr_receiver(void *cookie, int y, int n_rows, const void *bytes, size_t n_bytes);
/* Packs the picture's rows from `begin` to before `end`, both multiples of CONIC_EXR_BAND or the picture's end. The
 * image begins at the row `first`. With is_alone the calling thread does all the work. Errors: MEMORY, CANCELLED,
 * ARGUMENT, the receiver's. */
conic_status conic_exr_pack(conic_exr_bands *bands, const conic_image *image, int first, int begin, int end,
                            int is_alone, conic_exr_receiver *receive, void *cookie);
/* Appends the next rows, packed by a writer of the same size, planes and options. One thread at a time. Errors:
 * ARGUMENT (other rows than the next), IO. */
conic_status conic_exr_bands_append_packed(conic_exr_bands *bands, int y, int n_rows, const void *bytes,
                                           size_t n_bytes);
/* The length of the file so far: the rows appended last are its end. */
uint64_t conic_exr_bands_length(const conic_exr_bands *bands);
/* Hands appended rows to the system, which keeps them if the program is killed. Errors: IO. */
conic_status conic_exr_bands_flush(conic_exr_bands *bands);
/* Completes the file after the last band, or drops it if the status is not OK. Releases the writer, which may be null,
 * and returns the status. Errors: ARGUMENT (rows are missing), IO. */
conic_status conic_exr_bands_end(conic_exr_bands *bands, conic_status status);
