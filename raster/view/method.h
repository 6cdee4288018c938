/* What the methods have in common, apart from how each draws. */
#pragma once

#include "conic/render.h"

/* Whether a splat is a pixel or a circle on the screen, whatever its tilt. */
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

/* And whether a splat ends where its outline is projected to, by dual conic or ray. */
static inline int conic_method_has_exact_outline(conic_method method) {
  return method != CONIC_METHOD_AFFINE && !conic_method_is_dot(method);
}

/* `auto` hands over from conic to ray at the first error of a weight, for a kernel of peak 1. conic's error is at most
 * the second times A·√q, where its centre is √q standard deviations off (docs/reference/picture.md, Auto); of a kernel
 * that is no Gaussian the third times its slope takes the second's place. */
#define CONIC_AUTO_ERROR 4e-3f
#define CONIC_AUTO_STEEPNESS 0.68f
#define CONIC_AUTO_BY_SLOPE 1.12f
/* `ray` is good as long as inverse depth changes by no larger a share of itself over the filter's standard deviation.
 */
#define CONIC_AUTO_CHANGE 1e-2f

/* Fills splats_by_method from the counts of what was drawn, and of what a fallback drew. */
void conic_method_count(conic_method method, uint64_t n_rays, conic_render_statistics *statistics);
