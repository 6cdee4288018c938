/* A suite's expectations of a picture, and the files that hold them.
 *
 * Numbers are floats, in the order [range][y][x][channel], as in the .npy. */
#pragma once

#include "conic/gaussian_judge.h"

/* R, G, B over the background, A = 1 − T, Z. */
enum { SUITE_CHANNELS = 5 };

/* The members of conic_gaussian_bound, rounded outwards. */
enum { SUITE_VALUE, SUITE_LOW, SUITE_HIGH, SUITE_LEAST, SUITE_MOST, SUITE_RANGES };

/* "R" …, and "value" …. */
extern const char *const cli_suite_channel_names[SUITE_CHANNELS];
extern const char *const cli_suite_range_names[SUITE_RANGES];

typedef struct suite_planes {
  int width, height;
  float *numbers;
} suite_planes;

/* Where a pixel's numbers of a range begin. */
static inline size_t cli_suite_at(const suite_planes *planes, int range, size_t pixel) {
  const size_t n_pixels = (size_t)planes->width * (size_t)planes->height;
  return ((size_t)range * n_pixels + pixel) * SUITE_CHANNELS;
}

/* Takes the bounds of all pixels of planes' size. With a background, A may be 1 as well as 1 − T. On success the caller
 * releases planes->numbers. Errors: MEMORY. */
conic_status cli_suite_take_bounds(conic_context *context, const conic_gaussian_bound *bounds, int has_background,
                                   suite_planes *planes);

/* The same for surface splats, from the oracle's reference for the method. Errors: MEMORY. */
conic_status cli_suite_take_reference(conic_context *context, const conic_reference *reference, suite_planes *planes);

/* Writes them uncompressed, so that no library's version matters. The EXR's channels are R, G, B, A and Z; other ranges
 * have LOW.R …, as in cli_suite_range_names. Errors: as conic_output_open and _end. */
conic_status cli_suite_write_exr(conic_context *context, const char *path, const suite_planes *planes);
conic_status cli_suite_write_npy(conic_context *context, const char *path, const suite_planes *planes);

/* Reads an .npy for a picture of that size from a file's bytes. On success the caller releases planes->numbers. Errors:
 * INPUT, MEMORY. */
conic_status cli_suite_take_npy(conic_context *context, const char *path, const unsigned char *bytes, size_t n_bytes,
                                suite_planes *planes);
