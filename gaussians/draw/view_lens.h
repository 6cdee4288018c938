/* How gsplat's cameras see, of CONIC_SHAPE_SOLID: its steps to invert a lens and its limits are part of the rule. */
#pragma once

#include "conic/camera.h"

typedef struct conic_view_lens {
  const conic_camera *camera;
  double radial[6], tangential[2]; /* k1 … k6 of OpenCV; of a fisheye, k1 … k4 */
  double most_angle, first_guess;  /* of a fisheye: it sees less; and what the inverse begins at, times the radius */
} conic_view_lens;

/* Of a camera that conic_view_solid_check takes. */
void conic_view_lens_init(const conic_camera *camera, conic_view_lens *lens);

/* Where a place in camera space shows. Returns 0 where the lens does not see it; it has a place all the same. */
int conic_view_lens_show(const conic_view_lens *lens, const double at[3], double place[2]);

/* The direction seen at a place of the picture, as conic_camera_ray has it. Returns 0 where there is none. */
int conic_view_lens_ray(const conic_view_lens *lens, double x_px, double y_px, double direction[3]);
