/* A camera for choosing patches: which spheres are in sight, and lengths on the screen. */
#ifndef CONIC_PATCHES_VIEW_H
#define CONIC_PATCHES_VIEW_H

#include <math.h>

#include "conic/camera.h"
#include "conic/render.h"
#include "core/image/viewpoint.h"

typedef struct conic_patches_view {
  conic_viewpoint from;    /* for places from the set's origin; its sides are as far out as the prefilter reaches */
  double near_z, focal_px; /* the longer focal length */
  double step_px;
  int cull_back;
} conic_patches_view;

/* `default_near` is used where the options have none. */
static inline void conic_patches_view_init(conic_patches_view *view, const conic_camera *camera,
                                           const conic_render_options *render, const double origin[3],
                                           double default_near, double step_px) {
  double growth_px = (double)render->kernel.cutoff * sqrt((double)render->prefilter) + 2.0; /* the filter widens
                                                                                               outlines by that */
  conic_viewpoint_init(&view->from, camera, origin, growth_px);
  view->near_z = render->near_z > 0.0 ? render->near_z : 0.999 * default_near;
  view->focal_px = camera->fx > camera->fy ? camera->fx : camera->fy;
  view->step_px = step_px;
  view->cull_back = render->cull_back;
}

/* Whether a sphere about p, in camera space, may be seen. */
static inline int conic_patches_sees(const conic_patches_view *view, const double p[3], double radius) {
  return p[2] + radius > view->near_z && !conic_viewpoint_misses(&view->from, p, radius);
}

/* The most pixels that a length takes in a sphere about p. */
static inline double conic_patches_pixels(const conic_patches_view *view, const double p[3], double radius,
                                          double length) {
  double nearest = p[2] - radius;
  return length * view->focal_px / (nearest > view->near_z ? nearest : view->near_z);
}

#endif
