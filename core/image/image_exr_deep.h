/* Deep EXR files: any number of samples a pixel, each with a depth, a number and a weight. */
#ifndef CONIC_IMAGE_EXR_DEEP_H
#define CONIC_IMAGE_EXR_DEEP_H

#include "conic/image.h"

/* A line of a deep picture: pixel x has counts[x] samples; those of the line lie one after the other. */
typedef struct conic_deep_line {
  const uint32_t *counts;
  size_t n_samples;
  const float *depths;
  const uint32_t *ids;
  const float *weights;
} conic_deep_line;

typedef struct conic_deep_writer conic_deep_writer;

/* Begins a deep scanline EXR without compression, channels Z, id and weight; no pixel has more than `most_samples`.
 * `header` gives the attributes and may be null; `path` stays the caller's and must outlive the writer. On success the
 * caller owns *writer, and ends it with finish or abandon. Errors: ARGUMENT (an attribute that the format refuses),
 * UNSUPPORTED (a build without OpenEXR), MEMORY, IO.
 */
conic_status conic_deep_open(conic_context *context, const char *path, int width, int height, uint32_t most_samples,
                             const conic_image *header, conic_deep_writer **writer);
/* Appends the next line from the top. Errors: MEMORY, IO. */
conic_status conic_deep_append(conic_deep_writer *writer, const conic_deep_line *line);
/* Completes the file and releases the writer, on failure too. Errors: IO. */
conic_status conic_deep_finish(conic_deep_writer *writer);
/* Drops the file and releases the writer; null is allowed. */
void conic_deep_abandon(conic_deep_writer *writer);

#endif
