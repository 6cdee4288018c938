/* The methods' names, and what of a frame was drawn by which. */
#include "raster/view/method.h"

const char *conic_method_name(conic_method method) {
  static const char *const names[CONIC_N_METHODS] = {"conic", "ray", "affine", "point", "disc", "auto"};
  return (unsigned)method < CONIC_N_METHODS ? names[method] : NULL;
}

/* Rays are counted one by one. What else is not by the method's own formula is drawn by a variance of the dual conic,
 * or is a segment, which has one of the same kind. */
void conic_method_count(conic_method method, uint64_t n_rays, conic_render_statistics *statistics) {
  uint64_t *counts = statistics->splats_by_method, others = statistics->splats_drawn - n_rays;
  counts[CONIC_METHOD_RAY] = n_rays;
  if (method == CONIC_METHOD_AFFINE || method == CONIC_METHOD_POINT || method == CONIC_METHOD_DISC) {
    counts[method] = statistics->splats_drawn - statistics->splats_fallback;
    others -= counts[method];
  }
  counts[CONIC_METHOD_CONIC] = others;
}
