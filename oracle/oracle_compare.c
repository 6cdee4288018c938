/* An image held against the oracle's reference. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "oracle/oracle_pixel.h"

static const double bounds[CONIC_N_PLANES] = {
    [CONIC_PLANE_RGBA] = ORACLE_COLOR_BOUND,
    [CONIC_PLANE_Z] = ORACLE_Z_BOUND,
    [CONIC_PLANE_NORMAL] = ORACLE_NORMAL_BOUND,
    [CONIC_PLANE_ALBEDO] = ORACLE_COLOR_BOUND,
    [CONIC_PLANE_WEIGHT] = ORACLE_WEIGHT_BOUND,
    [CONIC_PLANE_COUNT] = 0.0,
    [CONIC_PLANE_ID] = 0.0,
};

static const double unstable_limit = 0.005;

static double sample(const conic_image *image, conic_plane plane, int is_uint, size_t at) {
  if (is_uint)
    return (double)((const uint32_t *)image->planes[plane])[at];
  return (double)((const float *)image->planes[plane])[at];
}

/* What a difference in a plane is measured by. */
static double scale_of(const conic_reference *reference, conic_plane plane, double expected) {
  switch (plane) {
  case CONIC_PLANE_Z:
    return expected != 0.0 ? fabs(expected) : 1.0;
  case CONIC_PLANE_RGBA:
    return reference->white * oracle_max(1.0, fabs(expected) / reference->white);
  case CONIC_PLANE_ALBEDO:
  case CONIC_PLANE_WEIGHT:
    return oracle_max(1.0, fabs(expected));
  default:
    return 1.0;
  }
}

static int is_rival(const conic_reference *reference, conic_plane plane, size_t i, double found) {
  uint32_t tied = reference->tied_id[i];
  return plane == CONIC_PLANE_ID && (tied == CONIC_ANY_ID || (tied != CONIC_NO_ID && found == (double)tied));
}

/* The largest difference of the pixel's channels. */
static double difference(const conic_reference *reference, const conic_image *image, conic_plane plane, size_t i) {
  const conic_plane_description *about = conic_plane_describe(plane);
  double largest = 0.0;
  for (size_t c = 0; c < (size_t)about->n_channels; c++) {
    size_t at = i * (size_t)about->n_channels + c;
    double expected = reference->planes[plane][at], found = sample(image, plane, about->is_uint, at);
    int is_alpha = plane == CONIC_PLANE_RGBA && c == 3;
    double scaled = fabs(found - expected) / (is_alpha ? 1.0 : scale_of(reference, plane, expected));
    if (found == expected || is_rival(reference, plane, i, found))
      scaled = 0.0;
    if (!(scaled <= largest))
      largest = scaled == scaled ? scaled : INFINITY;
  }
  return largest;
}

static void compare_plane(const conic_reference *reference, const conic_image *image, conic_plane plane, double *errors,
                          conic_oracle_plane_verdict *verdict) {
  size_t n_pixels = (size_t)reference->width * (size_t)reference->height, n = 0;
  verdict->is_compared = 1;
  for (size_t i = 0; i < n_pixels; i++) {
    if (reference->unstable[i])
      continue;
    double error = difference(reference, image, plane, i);
    verdict->max_abs = oracle_max(verdict->max_abs, error);
    if (reference->planes[CONIC_PLANE_COUNT][i] > 0.0)
      errors[n++] = error;
  }
  if (n)
    verdict->p999 = conic_oracle_select(errors, n, (size_t)(0.999 * (double)(n - 1)));
}

conic_status conic_oracle_compare(conic_context *context, const conic_reference *reference, const conic_image *image,
                                  conic_oracle_verdict *verdict) {
  memset(verdict, 0, sizeof *verdict);
  if (image->width != reference->width || image->height != reference->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "an image of %d x %d and a reference of %d x %d are not comparable", image->width, image->height,
                      reference->width, reference->height);
  size_t n_pixels = (size_t)image->width * (size_t)image->height;
  double *errors = conic_memory_allocate(context, reference->covered_pixels, sizeof *errors);
  if (!errors)
    return CONIC_ERROR_MEMORY;
  int is_exact = reference->question == CONIC_ORACLE_EXACT;
  verdict->unstable_limit = unstable_limit;
  verdict->covered_pixels = reference->covered_pixels;
  verdict->unstable_pixels = reference->unstable_pixels;
  verdict->compared_pixels = n_pixels - reference->unstable_pixels;
  size_t unstable = reference->samples > 1 ? reference->unstable_samples : reference->unstable_pixels;
  size_t covered = reference->samples > 1 ? reference->covered_samples : reference->covered_pixels;
  verdict->pass = is_exact || (double)unstable <= unstable_limit * (double)covered;
  for (int i = 0; i < CONIC_N_DRAWN_PLANES; i++) { /* the others are names, given after drawing */
    conic_oracle_plane_verdict *plane = &verdict->planes[i];
    plane->bound = is_exact ? NAN : bounds[i];
    if (!image->planes[i])
      continue;
    compare_plane(reference, image, (conic_plane)i, errors, plane);
    verdict->pass = verdict->pass && (is_exact || plane->max_abs <= plane->bound);
  }
  conic_memory_release(context, errors);
  return CONIC_OK;
}
