/* Eye-dome lighting once more, in double: docs/reference/lighting.md, "Eye-dome lighting". It is of the picture's own
 * plane Z, which is judged by itself. */
#include "oracle/oracle_bounds.h"

static double depth_at(const conic_image *image, long x, long y) {
  int is_within = x >= 0 && y >= 0 && x < image->width && y < image->height;
  return is_within ? (double)((const float *)image->planes[CONIC_PLANE_Z])[y * (long)image->width + x] : 0.0;
}

static double sine_to(double z, double other, double across) {
  return other > 0.0 ? (z - other) / sqrt((z - other) * (z - other) + across * across) : 0.0;
}

static double light_left(const conic_camera *camera, double stops, const conic_image *image, long x, long y) {
  double z = depth_at(image, x, y), sum = 0.0;
  double pixel = 2.0 / (camera->fx + camera->fy) * (camera->kind == CONIC_CAMERA_ORTHOGRAPHIC ? 1.0 : z);
  if (!(z > 0.0))
    return 1.0;
  for (long ring = 1; ring <= 8; ring *= 2)
    for (long dy = -ring; dy <= ring; dy += ring)
      for (long dx = -ring; dx <= ring; dx += ring) {
        double across = pixel * sqrt((double)(dx * dx + dy * dy));
        double here = dx || dy ? sine_to(z, depth_at(image, x + dx, y + dy), across) : 0.0;
        double behind = dx || dy ? sine_to(z, depth_at(image, x - dx, y - dy), across) : 0.0;
        sum += oracle_max(here + 0.5 * oracle_min(behind, 0.0), 0.0);
      }
  return conic_oracle_exp(-stops * 0.69314718055994530942 * sum / 32.0);
}

conic_status conic_oracle_eye_dome(conic_context *context, const conic_camera *camera, double stops,
                                   const conic_image *image, conic_reference *reference) {
  size_t i_alternative = 0;
  if (!image->planes[CONIC_PLANE_Z] || image->width != reference->width || image->height != reference->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the oracle: eye-dome lighting is judged by a picture with Z");
  for (size_t i = 0; i < reference->n_pixels; i++) {
    size_t pixel = reference->pixels ? reference->pixels[i] : i;
    double light =
        light_left(camera, stops, image, (long)(pixel % (size_t)image->width), (long)(pixel / (size_t)image->width));
    for (int c = 0; c < 3; c++)
      reference->planes[CONIC_PLANE_RGBA][4 * i + (size_t)c] *= light;
    for (; i_alternative < reference->n_alternatives && reference->alternatives[i_alternative].pixel <= i;
         i_alternative++)
      for (int c = 0; c < 3; c++) {
        reference->alternatives[i_alternative].low[c] *= light;
        reference->alternatives[i_alternative].high[c] *= light;
      }
  }
  return CONIC_OK;
}
