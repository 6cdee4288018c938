/* The parts of a comparison; docs/reference/diff.md has the definitions. */
#pragma once

#include "conic/image.h"
#include "core/base/base.h"
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

/* How many of a plane's first channels both images have. */
static inline size_t conic_compared_channels(const conic_image *a, const conic_image *b, int plane) {
  int is_without_alpha = plane == CONIC_PLANE_RGBA && (a->lacks_alpha || b->lacks_alpha);
  return (size_t)conic_plane_describe((conic_plane)plane)->n_channels - (size_t)is_without_alpha;
}

/* A colour, linear or a display value, as a screen shows it, 0 to 1; NaN becomes -1, which is no colour. */
static inline double conic_screen_value(float value, int is_display) {
  if (!(value > 0.0f))
    return value <= 0.0f ? 0.0 : -1.0;
  if (value >= 1.0f)
    return 1.0;
  return is_display ? (double)value : conic_srgb_encode((double)value);
}

/* Two images with colours of one kind. If only one has display values, the other's colours are encoded in a copy. The
 * other planes are the images' own. */
typedef struct conic_image_pair {
  conic_image a, b;
  float *copy; /* null: none was needed */
} conic_image_pair;

/* Ended by conic_pair_end, also after a failure. Errors: MEMORY. */
conic_status conic_pair_begin(conic_context *context, const conic_image *a, const conic_image *b,
                              conic_image_pair *pair);
void conic_pair_end(conic_context *context, conic_image_pair *pair);

/* How the colours of two images of one size and one kind of colour differ. */
typedef struct conic_color_difference {
  double sum_of_squares;    /* of R, G and B */
  double ssim, ssim_padded; /* the means over the windows */
} conic_color_difference;

static inline void conic_add_weighted(double *restrict sum, const double *restrict values, double weight, size_t n) {
  for (size_t i = 0; i < n; i++)
    sum[i] += weight * values[i];
}

/* Compares two images with rgba of one kind and one size. Errors: MEMORY. */
conic_status conic_compare_color(conic_context *context, const conic_image *a, const conic_image *b,
                                 conic_color_difference *difference);

/* The mean of ꟻLIP over the pixels; `map`, which may be null, gets its value at each. Both images have rgba of one
 * kind, and one size. Errors: MEMORY. */
conic_status conic_compare_flip(conic_context *context, const conic_image *a, const conic_image *b, float *map,
                                double *mean);

/* The 99.9th percentile over the pixels of the largest difference in `planes` (bits), to a float's precision. Both
 * images have these planes, and one size. */
double conic_compare_p999(const conic_image *a, const conic_image *b, unsigned planes);

/* Pixels where R, G or B, as a screen shows them, differ by more than 8-bit rounding: 1.001/255. Both images have rgba
 * of one kind, and one size. */
size_t conic_compare_codes(const conic_image *a, const conic_image *b);

/* Pixels of the largest 4-connected set covered in `a` and not in `b`. Errors: MEMORY. */
conic_status conic_largest_hole(conic_context *context, const conic_image *a, const conic_image *b, size_t *n_pixels);

/* A smaller rgba picture. Each pixel is the mean over the area of `image` that it covers, of the numbers as they are.
 * Allocated; `width` and `height` are at most the image's. Errors: ARGUMENT (there is no rgba), MEMORY. */
conic_status conic_image_reduce(conic_context *context, const conic_image *image, int width, int height,
                                conic_image *reduced);
