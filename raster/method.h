/* What the methods have in common, apart from how each draws. */
#ifndef RASTER_METHOD_H
#define RASTER_METHOD_H

#include "conic/render.h"

/* Whether a splat's shape on the screen is one that knows nothing of its tilt: a pixel or a circle. */
static inline int conic_method_is_dot(conic_method method) {
  return method == CONIC_METHOD_POINT || method == CONIC_METHOD_DISC;
}

/* Fills splats_by_method, once what was drawn and what of it by a fallback is counted. */
void conic_method_count(conic_method method, uint64_t n_rays, conic_render_statistics *statistics);

#endif
