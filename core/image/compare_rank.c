/* Percentiles and counts of the pixels' differences, without memory for them. The bits of floats that are not negative
 * have the floats' order, so that three counts, of 2¹¹ classes each, find a rank exactly. */
#include "core/image/compare.h"
#include "core/image/image_common.h"

enum { CLASS_BITS = 11, N_CLASSES = 1 << CLASS_BITS };

/* Where pixel i lies in a plane. */
static const unsigned char *pixel_of(const conic_image *image, int plane, size_t i) {
  size_t n_channels = (size_t)conic_plane_describe((conic_plane)plane)->n_channels;
  return (const unsigned char *)image->planes[plane] + 4 * n_channels * i;
}

/* The largest difference of a pixel's samples in the planes. */
static float pixel_difference(const conic_image *a, const conic_image *b, unsigned planes, size_t i) {
  double largest = 0.0;
  for (int plane = 0; plane < CONIC_N_PLANES; plane++) {
    if (!(planes >> plane & 1))
      continue;
    const conic_plane_description *description = conic_plane_describe((conic_plane)plane);
    const unsigned char *a_pixel = pixel_of(a, plane, i), *b_pixel = pixel_of(b, plane, i);
    for (size_t c = 0; c < conic_compared_channels(a, b, plane); c++) {
      uint32_t a_bits = conic_bits_at(a_pixel, c), b_bits = conic_bits_at(b_pixel, c);
      double difference = a_bits == b_bits ? 0.0 : conic_sample_difference(a_bits, b_bits, description->is_uint);
      largest = difference > largest ? difference : largest;
    }
  }
  return (float)largest;
}

/* The class that holds the rank; *rank becomes the rank within it. */
static uint32_t find_class(const size_t *counts, size_t *rank) {
  uint32_t i = 0;
  for (; i < N_CLASSES - 1 && counts[i] <= *rank; i++)
    *rank -= counts[i];
  return i;
}

double conic_compare_p999(const conic_image *a, const conic_image *b, unsigned planes) {
  size_t n = conic_image_pixels(a), rank = n - n / 1000 - 1;          /* ⌈0.999 n⌉, from 0 on */
  uint64_t known = 0;                                                 /* the first bits of the value, found so far */
  for (int shift = 2 * CLASS_BITS; shift >= 0; shift -= CLASS_BITS) { /* 33 bits, the first of them 0 */
    size_t counts[N_CLASSES] = {0};
    for (size_t i = 0; i < n; i++) {
      uint64_t bits = conic_bits_of_float(pixel_difference(a, b, planes, i));
      if (bits >> shift >> CLASS_BITS == known)
        counts[bits >> shift & (N_CLASSES - 1)]++;
    }
    known = known << CLASS_BITS | find_class(counts, &rank);
  }
  uint32_t bits = (uint32_t)known;
  return (double)conic_float_of_bits(bits);
}

size_t conic_compare_codes(const conic_image *a, const conic_image *b) {
  const float *a_pixel = a->planes[CONIC_PLANE_RGBA], *b_pixel = b->planes[CONIC_PLANE_RGBA];
  int is_display = a->is_display != 0;
  size_t n_over = 0;
  for (size_t i = 0; i < conic_image_pixels(a); i++, a_pixel += 4, b_pixel += 4) {
    int is_over = 0;
    for (int c = 0; c < 3 && !is_over; c++)
      is_over =
          !conic_same_bits(a_pixel[c], b_pixel[c]) &&
          fabs(conic_screen_value(a_pixel[c], is_display) - conic_screen_value(b_pixel[c], is_display)) > 1.001 / 255.0;
    n_over += (size_t)is_over;
  }
  return n_over;
}
