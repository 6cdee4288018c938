/* What a camera sees, for whoever chooses what to draw: spheres in sight, and lengths on the screen. */
#ifndef CONIC_PATCHES_VIEW_H
#define CONIC_PATCHES_VIEW_H

#include "conic/camera.h"
#include "conic/render.h"

typedef struct conic_patches_view {
  double rotation[3][3], translation[3]; /* of places relative to the set's origin */
  double sides[4][3];      /* unit normals of the planes through the eye that bound what is seen, inwards */
  double near_z, focal_px; /* the longer focal length */
  double step_px;
  int cull_back;
} conic_patches_view;

/* `default_near` is for options without one. */
void conic_patches_view_init(conic_patches_view *view, const conic_camera *camera, const conic_render_options *render,
                             const double origin[3], double default_near, double step_px);

static inline void conic_patches_to_camera(const conic_patches_view *view, const double place[3], double p[3]) {
  for (int i = 0; i < 3; i++)
    p[i] = view->rotation[i][0] * place[0] + view->rotation[i][1] * place[1] + view->rotation[i][2] * place[2] +
           view->translation[i];
}

/* Whether a sphere about p, in camera space, may be seen. */
static inline int conic_patches_sees(const conic_patches_view *view, const double p[3], double radius) {
  int is_seen = p[2] + radius > view->near_z;
  for (int i = 0; i < 4; i++)
    is_seen &= !(view->sides[i][0] * p[0] + view->sides[i][1] * p[1] + view->sides[i][2] * p[2] < -radius);
  return is_seen;
}

/* How many pixels a length takes at most, in a sphere about p. */
static inline double conic_patches_pixels(const conic_patches_view *view, const double p[3], double radius,
                                          double length) {
  double nearest = p[2] - radius;
  return length * view->focal_px / (nearest > view->near_z ? nearest : view->near_z);
}

#endif
