#include "core/image/compare.h"

#include "core/base/power.h"
#include "core/image/image_common.h"

/* The sums of one or several planes. */
typedef struct plane_sums {
  double max_abs, sum_of_squares;
  double n_samples;
} plane_sums;

/* Sums row by row, so that rounding does not depend on how rows are grouped; marks the pixels that differ. */
static plane_sums compare_plane(const conic_image *a, const conic_image *b, conic_plane plane, unsigned char *differs) {
  const conic_plane_description *description = conic_plane_describe(plane);
  size_t n_channels = (size_t)description->n_channels, width = (size_t)a->width;
  size_t n_compared = conic_compared_channels(a, b, (int)plane);
  plane_sums sums = {.n_samples = (double)(conic_image_pixels(a) * n_compared)};
  for (size_t y = 0; y < (size_t)a->height; y++) {
    size_t first = y * width * n_channels;
    const unsigned char *a_row = (const unsigned char *)a->planes[plane] + first * 4;
    const unsigned char *b_row = (const unsigned char *)b->planes[plane] + first * 4;
    double row_sum = 0.0;
    if (memcmp(a_row, b_row, width * n_channels * 4) == 0)
      continue;
    for (size_t i = 0; i < width * n_channels; i++) {
      uint32_t a_bits = conic_bits_at(a_row, i), b_bits = conic_bits_at(b_row, i);
      if (a_bits == b_bits || i % n_channels >= n_compared)
        continue;
      double difference = conic_sample_difference(a_bits, b_bits, description->is_uint);
      differs[y * width + i / n_channels] = 1;
      if (difference > sums.max_abs)
        sums.max_abs = difference;
      row_sum += difference * difference;
    }
    sums.sum_of_squares += row_sum;
  }
  return sums;
}

static double root_mean(const plane_sums *sums) {
  return sums->n_samples > 0.0 ? sqrt(sums->sum_of_squares / sums->n_samples) : 0.0;
}

static void compare_planes(const conic_image *a, const conic_image *b, conic_difference *difference,
                           unsigned char *differs) {
  plane_sums total = {0};
  unsigned measured = 0;
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    if (!a->planes[i] || !b->planes[i])
      continue;
    plane_sums sums = compare_plane(a, b, (conic_plane)i, differs);
    difference->planes[i].compared = 1;
    difference->planes[i].max_abs = sums.max_abs;
    difference->planes[i].rmse = root_mean(&sums);
    difference->planes[i].p999 = conic_compare_p999(a, b, 1u << i);
    if (conic_plane_describe((conic_plane)i)->is_uint || CONIC_MATTE_PLANES >> i & 1) /* numbers that name */
      continue;
    measured |= 1u << i;
    if (sums.max_abs > total.max_abs)
      total.max_abs = sums.max_abs;
    total.sum_of_squares += sums.sum_of_squares;
    total.n_samples += sums.n_samples;
  }
  difference->p999 = conic_compare_p999(a, b, measured);
  difference->max_abs = total.max_abs;
  difference->rmse = root_mean(&total);
  for (size_t i = 0; i < conic_image_pixels(a); i++)
    difference->differing_pixels += differs[i];
}

static int has_same_alpha(const conic_image *a, const conic_image *b) {
  const float *a_rgba = a->planes[CONIC_PLANE_RGBA], *b_rgba = b->planes[CONIC_PLANE_RGBA];
  size_t i = 0, n = a_rgba && b_rgba ? conic_image_pixels(a) : 0;
  while (i < n && conic_same_bits(a_rgba[4 * i + 3], b_rgba[4 * i + 3]))
    i++;
  return i == n;
}

static double psnr_of(double mean_square) {
  if (mean_square == 0.0)
    return (double)INFINITY;
  return -10.0 * conic_logarithm(mean_square) / 2.30258509299404568402;
}

static conic_status compare_colors(conic_context *context, const conic_image *a, const conic_image *b,
                                   conic_difference *difference) {
  conic_color_difference found;
  if (!a->planes[CONIC_PLANE_RGBA] || !b->planes[CONIC_PLANE_RGBA])
    return CONIC_OK;
  conic_status status = conic_compare_color(context, a, b, &found);
  if (status != CONIC_OK)
    return status;
  status = conic_compare_flip(context, a, b, NULL, &difference->flip);
  if (status != CONIC_OK)
    return status;
  difference->over_code = conic_compare_codes(a, b);
  difference->has_color = 1;
  difference->is_display = a->is_display;
  difference->psnr = psnr_of(found.sum_of_squares / (3.0 * (double)conic_image_pixels(a)));
  difference->ssim = found.ssim;
  difference->ssim_padded = found.ssim_padded;
  return CONIC_OK;
}

static conic_status compare_pair(conic_context *context, const conic_image *a, const conic_image *b,
                                 conic_difference *difference) {
  unsigned char *differs = conic_memory_allocate_zeroed(context, conic_image_pixels(a), 1);
  if (!differs)
    return CONIC_ERROR_MEMORY;
  compare_planes(a, b, difference, differs);
  conic_memory_release(context, differs);
  difference->lacks_alpha =
      a->planes[CONIC_PLANE_RGBA] && b->planes[CONIC_PLANE_RGBA] && conic_compared_channels(a, b, CONIC_PLANE_RGBA) < 4;
  difference->identical = conic_image_planes(a) == conic_image_planes(b) && difference->differing_pixels == 0 &&
                          (a->lacks_alpha == b->lacks_alpha || has_same_alpha(a, b));
  conic_status status = compare_colors(context, a, b, difference);
  if (status == CONIC_OK)
    status = conic_largest_hole(context, a, b, &difference->largest_hole);
  return status;
}

conic_status conic_image_compare(conic_context *context, const conic_image *a, const conic_image *b,
                                 conic_difference *difference) {
  if (!a || !b || !difference || a->width < 1 || a->height < 1 || b->width < 1 || b->height < 1)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "compare: an image is missing or empty");
  memset(difference, 0, sizeof *difference);
  difference->same_size = a->width == b->width && a->height == b->height;
  if (!difference->same_size)
    return CONIC_OK;
  conic_image_pair pair;
  conic_status status = conic_pair_begin(context, a, b, &pair);
  if (status == CONIC_OK)
    status = compare_pair(context, &pair.a, &pair.b, difference);
  conic_pair_end(context, &pair);
  return status;
}
