/* Display values: colours as a screen takes them, and as Gaussian profiles composite them. */

#include "core/image/compare.h"
#include "core/image/image_common.h"

/* For a colour in front of black. Light that adds without covering has no alpha to divide by: it is encoded as it is,
 * and files show nothing of it. */
static void encode_pixels(const float *linear, size_t n_pixels, float *display) {
  for (size_t i = 0; i < n_pixels; i++, linear += 4, display += 4) {
    double alpha = linear[3] > 0.0f ? (double)linear[3] : 1.0;
    for (int c = 0; c < 3; c++)
      display[c] = (float)(conic_srgb_encode((double)linear[c] / alpha) * alpha);
    display[3] = linear[3];
  }
}

void conic_image_encode(conic_image *image) {
  float *rgba = image->planes[CONIC_PLANE_RGBA];
  if (!rgba || image->is_display)
    return;
  encode_pixels(rgba, conic_image_pixels(image), rgba);
  image->is_display = 1;
}

conic_status conic_pair_begin(conic_context *context, const conic_image *a, const conic_image *b,
                              conic_image_pair *pair) {
  *pair = (conic_image_pair){.a = *a, .b = *b};
  conic_image *linear = a->is_display ? &pair->b : &pair->a;
  if (!a->is_display == !b->is_display || !a->planes[CONIC_PLANE_RGBA] || !b->planes[CONIC_PLANE_RGBA])
    return CONIC_OK;
  pair->copy = conic_memory_allocate(context, conic_image_pixels(linear), 4 * sizeof *pair->copy);
  if (!pair->copy)
    return CONIC_ERROR_MEMORY;
  encode_pixels(linear->planes[CONIC_PLANE_RGBA], conic_image_pixels(linear), pair->copy);
  linear->planes[CONIC_PLANE_RGBA] = pair->copy;
  linear->is_display = 1;
  return CONIC_OK;
}

void conic_pair_end(conic_context *context, conic_image_pair *pair) {
  conic_memory_release(context, pair->copy);
  pair->copy = NULL;
}
