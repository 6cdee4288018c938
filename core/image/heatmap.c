#include "core/image/compare.h"
#include "core/image/image_common.h"

/* The smallest difference that is not black: 2^-20, a millionth. */
enum { DARKEST_EXPONENT = -20 };

/* The position of `difference` on a logarithmic scale, from that power of two (0) to 1 and beyond (1). Between powers
 * of two it is linear, which needs no logarithm and is not visible. Infinity and NaN are 1. */
static float scale_position(double difference, int darkest_exponent) {
  int exponent;
  if (!(difference < 1.0))
    return 1.0f;
  double mantissa = frexp(difference, &exponent); /* in [½, 1) */
  double logarithm = (double)(exponent - 1) + (2.0 * mantissa - 1.0);
  double position = 1.0 - logarithm / darkest_exponent;
  return position > 0.0 ? (float)position : 0.0f;
}

/* Colours from blue over red and yellow to white. */
static void paint(float position, float pixel[4]) {
  static const float stops[4][3] = {{0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
  float scaled = position * 3.0f;
  int i = scaled < 1.0f ? 0 : scaled < 2.0f ? 1 : 2;
  float part = scaled - (float)i;
  for (int c = 0; c < 3; c++)
    pixel[c] = stops[i][c] + part * (stops[i + 1][c] - stops[i][c]);
}

/* The largest difference of a channel; NaN where one is NaN. Equal bits do not differ. */
static double pixel_difference(const float *a, const float *b, size_t n_channels) {
  double largest = 0.0;
  for (size_t c = 0; c < n_channels; c++) {
    if (conic_same_bits(a[c], b[c]))
      continue;
    double difference = fabs((double)a[c] - (double)b[c]);
    if (!(difference <= largest))
      largest = difference >= 0.0 ? difference : (double)INFINITY;
  }
  return largest;
}

/* A picture for the heat map of two images, all zero. */
static conic_status begin_heatmap(conic_context *context, const conic_image *a, const conic_image *b,
                                  conic_image *heatmap) {
  if (heatmap)
    memset(heatmap, 0, sizeof *heatmap);
  if (!a || !b || !heatmap || !a->planes[CONIC_PLANE_RGBA] || !b->planes[CONIC_PLANE_RGBA])
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "heatmap: an image has no colour");
  if (a->width != b->width || a->height != b->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "heatmap: the images differ in size, %d × %d and %d × %d",
                      a->width, a->height, b->width, b->height);
  return conic_image_allocate(context, a->width, a->height, 1u << CONIC_PLANE_RGBA, heatmap);
}

conic_status conic_image_heatmap(conic_context *context, const conic_image *a, const conic_image *b,
                                 conic_image *heatmap) {
  conic_image_pair pair = {.copy = NULL};
  conic_status status = begin_heatmap(context, a, b, heatmap);
  if (status == CONIC_OK)
    status = conic_pair_begin(context, a, b, &pair);
  if (status != CONIC_OK) {
    conic_image_release(context, heatmap);
    return status;
  }
  size_t n_channels = conic_compared_channels(a, b, CONIC_PLANE_RGBA);
  const float *a_rgba = pair.a.planes[CONIC_PLANE_RGBA], *b_rgba = pair.b.planes[CONIC_PLANE_RGBA];
  float *pixel = heatmap->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < conic_image_pixels(a); i++, pixel += 4) {
    double difference = pixel_difference(a_rgba + 4 * i, b_rgba + 4 * i, n_channels);
    if (difference > 0.0)
      paint(scale_position(difference, DARKEST_EXPONENT), pixel);
    pixel[3] = 1.0f;
  }
  conic_pair_end(context, &pair);
  return CONIC_OK;
}

conic_status conic_image_flip_heatmap(conic_context *context, const conic_image *a, const conic_image *b,
                                      conic_image *heatmap) {
  double mean;
  conic_image_pair pair;
  conic_status status = begin_heatmap(context, a, b, heatmap);
  if (status != CONIC_OK)
    return status;
  float *map = conic_memory_allocate(context, conic_image_pixels(a), sizeof *map);
  status = map ? conic_pair_begin(context, a, b, &pair) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_compare_flip(context, &pair.a, &pair.b, map, &mean);
  if (map)
    conic_pair_end(context, &pair);
  float *pixel = heatmap->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; status == CONIC_OK && i < conic_image_pixels(a); i++, pixel += 4) {
    if (map[i] < 0.25f) /* black to blue */
      pixel[2] = 4.0f * map[i];
    else
      paint((map[i] - 0.25f) / 0.75f, pixel);
    pixel[3] = 1.0f;
  }
  conic_memory_release(context, map);
  if (status != CONIC_OK)
    conic_image_release(context, heatmap);
  return status;
}

/* Blue at 1, white at 64, by the logarithm. */
static void paint_count(uint32_t count, float pixel[4]) {
  paint(scale_position((double)count * 0x1p-6, -6), pixel);
}

/* Blue at 1, green at 8, red at 16. */
static void paint_confetti(uint32_t count, float pixel[4]) {
  float above = count < 16 ? (float)(count - 1) : 15.0f;
  float low = above < 7.0f ? above / 7.0f : 1.0f, high = above > 7.0f ? (above - 7.0f) / 8.0f : 0.0f;
  pixel[0] = high;
  pixel[1] = low - high;
  pixel[2] = 1.0f - low;
}

static conic_status paint_overdraw(conic_context *context, const conic_image *image,
                                   void paint_one(uint32_t count, float pixel[4]), conic_image *map) {
  const uint32_t *count = image ? image->planes[CONIC_PLANE_COUNT] : NULL;
  if (map)
    memset(map, 0, sizeof *map);
  if (!count || !map)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "overdraw: the image has no count");
  conic_status status = conic_image_allocate(context, image->width, image->height, 1u << CONIC_PLANE_RGBA, map);
  if (status != CONIC_OK)
    return status;
  float *pixel = map->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < conic_image_pixels(image); i++, pixel += 4) {
    if (count[i] > 0)
      paint_one(count[i], pixel);
    pixel[3] = 1.0f;
  }
  return CONIC_OK;
}

conic_status conic_image_overdraw(conic_context *context, const conic_image *image, conic_image *map) {
  return paint_overdraw(context, image, paint_count, map);
}

conic_status conic_image_overdraw_confetti(conic_context *context, const conic_image *image, conic_image *map) {
  return paint_overdraw(context, image, paint_confetti, map);
}
