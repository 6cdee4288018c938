/* The largest hole: pixels that the first image covers and the second does not. */

#include "core/image/compare.h"
#include "core/image/image_common.h"

/* Whether pixel i is covered, by one plane. */
static int is_covered(const conic_image *image, conic_plane plane, size_t i) {
  size_t n_channels = (size_t)conic_plane_describe(plane)->n_channels;
  const float *value = (const float *)image->planes[plane] + i * n_channels;
  if (plane == CONIC_PLANE_RGBA)
    return value[3] > 0.0f;
  if (plane == CONIC_PLANE_TRANSPARENCY)
    return value[0] < 1.0f;
  if (plane == CONIC_PLANE_ID || plane == CONIC_PLANE_CLUSTER || plane == CONIC_PLANE_LAST)
    return ((const uint32_t *)image->planes[plane])[i] != CONIC_NO_ID;
  if (plane == CONIC_PLANE_COUNT || plane == CONIC_PLANE_DOUBT || plane == CONIC_PLANE_SAMPLES)
    return ((const uint32_t *)image->planes[plane])[i] != 0;
  for (size_t c = 0; c < n_channels; c++)
    if (value[c] != 0.0f)
      return 1;
  return 0;
}

/* The plane that tells which pixels are covered: the first of these that both images have; negative where there is
 * none. */
static int covering_plane(const conic_image *a, const conic_image *b) {
  static const conic_plane order[CONIC_N_PLANES] = {
      CONIC_PLANE_RGBA,         CONIC_PLANE_ID,       CONIC_PLANE_Z,         CONIC_PLANE_WEIGHT,
      CONIC_PLANE_COUNT,        CONIC_PLANE_NORMAL,   CONIC_PLANE_ALBEDO,    CONIC_PLANE_CLUSTER,
      CONIC_PLANE_POSITION,     CONIC_PLANE_MATTE_0,  CONIC_PLANE_MATTE_1,   CONIC_PLANE_MATTE_2,
      CONIC_PLANE_TRANSPARENCY, CONIC_PLANE_MEDIAN_Z, CONIC_PLANE_INVERSE_Z, CONIC_PLANE_LAST,
      CONIC_PLANE_DOUBT,        CONIC_PLANE_AO,       CONIC_PLANE_SHADOW,    CONIC_PLANE_SAMPLES,
      CONIC_PLANE_VARIANCE,     CONIC_PLANE_MOTION,   CONIC_PLANE_BOUND};
  for (size_t i = 0; i < sizeof order / sizeof order[0]; i++)
    if (a->planes[order[i]] && b->planes[order[i]])
      return (int)order[i];
  return -1;
}

/* Takes pixel i off the map and puts it on the stack, if it is on the map. */
static size_t push(unsigned char *is_hole, uint32_t *stack, size_t n_stack, size_t i) {
  if (is_hole[i]) {
    is_hole[i] = 0;
    stack[n_stack++] = (uint32_t)i;
  }
  return n_stack;
}

/* The size of the hole around pixel `first`, which it takes off the map. */
static size_t fill_hole(unsigned char *is_hole, uint32_t *stack, size_t width, size_t height, size_t first) {
  size_t n_filled = 0, n_stack = push(is_hole, stack, 0, first);
  while (n_stack > 0) {
    size_t i = stack[--n_stack], x = i % width, y = i / width;
    n_filled++;
    if (x > 0)
      n_stack = push(is_hole, stack, n_stack, i - 1);
    if (x + 1 < width)
      n_stack = push(is_hole, stack, n_stack, i + 1);
    if (y > 0)
      n_stack = push(is_hole, stack, n_stack, i - width);
    if (y + 1 < height)
      n_stack = push(is_hole, stack, n_stack, i + width);
  }
  return n_filled;
}

conic_status conic_largest_hole(conic_context *context, const conic_image *a, const conic_image *b, size_t *n_pixels) {
  size_t n = conic_image_pixels(a), n_missing = 0;
  int plane = covering_plane(a, b);
  *n_pixels = 0;
  if (plane < 0)
    return CONIC_OK;
  unsigned char *is_hole = conic_memory_allocate(context, n, 1);
  if (!is_hole)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++) {
    is_hole[i] = is_covered(a, (conic_plane)plane, i) && !is_covered(b, (conic_plane)plane, i);
    n_missing += is_hole[i];
  }
  uint32_t *stack = conic_memory_allocate(context, n_missing, sizeof *stack);
  if (!stack) {
    conic_memory_release(context, is_hole);
    return CONIC_ERROR_MEMORY;
  }
  for (size_t i = 0; i < n && n_missing > *n_pixels; i++) {
    if (!is_hole[i])
      continue;
    size_t n_filled = fill_hole(is_hole, stack, (size_t)a->width, (size_t)a->height, i);
    n_missing -= n_filled;
    if (n_filled > *n_pixels)
      *n_pixels = n_filled;
  }
  conic_memory_release_these(context, stack, is_hole);
  return CONIC_OK;
}
