/* The parts of a comparison; docs/reference/diff.md has the definitions. */
#ifndef CONIC_COMPARE_H
#define CONIC_COMPARE_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "conic/image.h"
#include "core/base/color.h"

/* Sample i of a row, as bits. */
static inline uint32_t conic_bits_at(const unsigned char *row, size_t i) {
  uint32_t bits;
  memcpy(&bits, row + 4 * i, sizeof bits);
  return bits;
}

/* |a − b| of samples whose bits differ; NaN, and infinities of two signs, differ by infinity. */
static inline double conic_sample_difference(uint32_t a_bits, uint32_t b_bits, int is_uint) {
  float a, b;
  if (is_uint)
    return a_bits > b_bits ? (double)(a_bits - b_bits) : (double)(b_bits - a_bits);
  memcpy(&a, &a_bits, sizeof a);
  memcpy(&b, &b_bits, sizeof b);
  double difference = fabs((double)a - (double)b);
  return difference >= 0.0 ? difference : (double)INFINITY;
}

/* Of a plane's channels, the first ones, which both images have. */
static inline size_t conic_compared_channels(const conic_image *a, const conic_image *b, int plane) {
  int is_without_alpha = plane == CONIC_PLANE_RGBA && (a->lacks_alpha || b->lacks_alpha);
  return (size_t)conic_plane_describe((conic_plane)plane)->n_channels - (size_t)is_without_alpha;
}

/* A colour as a screen shows it, 0 to 1; NaN is -1, which no colour is. */
static inline double conic_screen_value(float linear) {
  if (!(linear > 0.0f))
    return linear <= 0.0f ? 0.0 : -1.0;
  return linear >= 1.0f ? 1.0 : conic_srgb_encode((double)linear);
}

static inline void conic_add_weighted(double *restrict sum, const double *restrict values, double weight, size_t n) {
  for (size_t i = 0; i < n; i++)
    sum[i] += weight * values[i];
}

/* Sum of the squared differences and mean structural similarity of R, G, B. Both images have rgba and one size. Errors:
 * MEMORY. */
conic_status conic_compare_color(conic_context *context, const conic_image *a, const conic_image *b,
                                 double *sum_of_squares, double *ssim);

/* The mean of ꟻLIP over the pixels, and its value at each into `map`, which may be null. Both images have rgba and one
 * size. Errors: MEMORY. */
conic_status conic_compare_flip(conic_context *context, const conic_image *a, const conic_image *b, float *map,
                                double *mean);

/* The 99.9th percentile over the pixels of the largest difference in the planes of `planes` (bits), to the precision of
 * a float; both images have them and one size. */
double conic_compare_p999(const conic_image *a, const conic_image *b, unsigned planes);

/* Pixels where R, G or B, sRGB-encoded, differ by more than 8-bit rounding: 1.001/255. Both images have rgba and one
 * size. */
size_t conic_compare_codes(const conic_image *a, const conic_image *b);

/* Pixels of the largest 4-connected set covered in `a` and not in `b`. Errors: MEMORY. */
conic_status conic_largest_hole(conic_context *context, const conic_image *a, const conic_image *b, size_t *n_pixels);

#endif
