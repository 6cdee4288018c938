/* What the methods have in common, apart from how each draws. */
#ifndef CONIC_METHOD_H
#define CONIC_METHOD_H

#include "conic/render.h"

/* Whether a splat's shape on the screen is one that knows nothing of its tilt: a pixel or a circle. */
static inline int conic_method_is_dot(conic_method method) {
  return method == CONIC_METHOD_POINT || method == CONIC_METHOD_DISC;
}

/* Whether rays are a formula of the method's own; else they stand in for it. */
static inline int conic_method_has_rays(conic_method method) {
  return method == CONIC_METHOD_RAY || method == CONIC_METHOD_AUTO;
}

/* And whether ellipses (or dots) are. */
static inline int conic_method_has_ellipses(conic_method method) {
  return method != CONIC_METHOD_RAY;
}

/* The error in a weight (of a kernel of peak 1) at which `auto` hands over from conic to ray, and the bound of conic's,
 * 0.68·A·√q for a centre that is √q standard deviations from where it should be (docs/reference/picture.md, Auto). */
#define CONIC_AUTO_ERROR 4e-3f
#define CONIC_AUTO_STEEPNESS 0.68f
/* By how much of itself inverse depth may change over the filter's standard deviation where `ray` is still good. */
#define CONIC_AUTO_CHANGE 1e-2f

/* Fills splats_by_method, once what was drawn and what of it by a fallback is counted. */
void conic_method_count(conic_method method, uint64_t n_rays, conic_render_statistics *statistics);

#endif
