/* Deep EXR files: any number of samples a pixel, each with a colour, a depth, a number and a weight. */
#pragma once

#include "conic/image.h"
#include "core/files/deflate.h"

typedef struct conic_deep_sample {
  float rgba[4]; /* premultiplied */
  float depth, weight;
  uint32_t id;
} conic_deep_sample;

/* A line of a deep picture: pixel x has counts[x] samples; all samples of the line are one after the other. */
typedef struct conic_deep_line {
  const uint32_t *counts;
  size_t n_samples;
  const conic_deep_sample *samples;
} conic_deep_line;

/* A line as the file holds it. Begins as zeros; its memory serves line after line. */
typedef struct conic_deep_packed {
  unsigned char *ends, *samples, *scratch;
  size_t n_ends, n_samples, n_unpacked; /* bytes */
  size_t ends_room, samples_room, scratch_room;
  conic_deflater deflater;
} conic_deep_packed;

typedef struct conic_deep_writer conic_deep_writer;

/* Begins a deep scanline EXR with channels R, G, B, A, Z, id and weight, compressed (ZIPS) where the build has zlib. No
 * pixel has more than `most_samples`. `header` gives the attributes and may be null; the caller owns `path`, which must
 * outlive the writer. On success the caller owns *writer, and ends it with conic_deep_end. Errors: ARGUMENT (an
 * attribute that the format refuses), UNSUPPORTED (a build without OpenEXR), MEMORY, IO. */
conic_status conic_deep_open(conic_context *context, const char *path, int width, int height, uint32_t most_samples,
                             const conic_image *header, conic_deep_writer **writer);
/* Packs a line, on any thread. Errors: UNSUPPORTED (more samples than a file can hold), MEMORY. */
conic_status conic_deep_pack(conic_context *context, const conic_deep_line *line, int width, conic_deep_packed *packed);
void conic_deep_packed_release(conic_context *context, conic_deep_packed *packed);
/* Appends the next line from the top. Errors: IO. */
conic_status conic_deep_append(conic_deep_writer *writer, const conic_deep_packed *packed);
/* Completes the file, or drops it if the status is not OK. Releases the writer, which may be null, and returns the
 * status. Errors: IO. */
conic_status conic_deep_end(conic_deep_writer *writer, conic_status status);
