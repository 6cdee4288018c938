/* The names of methods, kernels and shadings, and which method drew how much of a frame. */
#include "raster/view/method.h"

#include "core/base/base.h"
#include "core/splats/kernel.h"

CONIC_DEFINE_NAMES(conic_method_name, conic_method, CONIC_N_METHODS, "conic", "ray", "affine", "point", "disc", "auto")

const char *conic_kernel_type_name(conic_kernel_type type) {
#define WORD_OF_KERNEL(type, word, traits) [type] = (word),
  static const char *const names[CONIC_N_KERNELS] = {CONIC_FOR_KERNELS(WORD_OF_KERNEL)};
  return (unsigned)type < CONIC_N_KERNELS ? names[type] : NULL;
}

CONIC_DEFINE_NAMES(conic_shading_name, conic_shading, CONIC_N_SHADINGS, "none", "lambert", "phong")

/* Rays are counted one by one. What else is not by the method's own formula is drawn by a variance of the dual conic,
 * or is a segment, which has one of the same kind. */
void conic_method_count(conic_method method, uint64_t n_rays, conic_render_statistics *statistics) {
  uint64_t *counts = statistics->splats_by_method, others = statistics->splats_drawn - n_rays;
  counts[CONIC_METHOD_RAY] = n_rays;
  if (!conic_method_has_exact_outline(method)) {
    counts[method] = statistics->splats_drawn - statistics->splats_fallback;
    others -= counts[method];
  }
  counts[CONIC_METHOD_CONIC] = others;
}
