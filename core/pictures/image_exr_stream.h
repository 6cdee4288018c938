/* Shared by the EXR writers and the reader: file access by our own functions, the library's message kept for the end,
 * and an image's attributes. */
#pragma once

#if CONIC_HAVE_OPENEXR

#include <openexr.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>

#include "conic/image.h"

/* The attribute that names a colour space, and the name of the space whose colours are display values. */
#define CONIC_EXR_COLOR_SPACE "colorInteropID"
#define CONIC_EXR_DISPLAY "srgb_rec709_display"

typedef struct conic_exr_stream {
  conic_context *context;
  const char *path;
  FILE *file;       /* the caller's; null: written bytes go nowhere */
  int64_t position; /* of `file`, for writing */
  int64_t length;   /* of the written bytes */
  int error;        /* errno of the first failed access */
  atomic_flag has_message;
  char message[200]; /* the library's first; later ones only repeat that something failed */
} conic_exr_stream;

/* Fills `stream`, and `settings` with the functions that work on it. */
void conic_exr_stream_init(conic_exr_stream *stream, conic_context *context, const char *path, FILE *file,
                           exr_context_initializer_t *settings);

/* Logs what `result` means and returns the status: MEMORY; UNSUPPORTED; IO where access to the file failed while
 * `doing` ("write"); else `otherwise`. */
conic_status conic_exr_fail(conic_exr_stream *stream, exr_result_t result, const char *doing, conic_status otherwise);

/* For the header of a file that is being written, on one thread: the first, before the part is added, prepares it for
 * the names of the image's attributes, where there is an image; the second adds them after the required attributes are
 * set; the third writes it, where `result` is success, and is called in any case. */
exr_result_t conic_exr_prepare_attributes(exr_context_t file, const conic_image *image);
exr_result_t conic_exr_add_attributes(exr_context_t file, const conic_image *image);
exr_result_t conic_exr_end_header(exr_context_t file, exr_result_t result);

#endif
