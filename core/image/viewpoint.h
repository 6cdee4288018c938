/* A camera for choosing what to draw: transforms places into its space, and tests which spheres are in its picture. */
#pragma once

#include "conic/camera.h"
#include "core/base/vectors.h"

typedef struct conic_viewpoint {
  double rotation[3][3], translation[3]; /* from places relative to an origin to camera space */
  double eye[3];                         /* relative to the origin */
  double side[4][3]; /* planes of the picture's sides, in camera space: unit normals, inwards, through the eye */
} conic_viewpoint;

/* The tested sides lie so many pixels outside of the picture. */
void conic_viewpoint_init(conic_viewpoint *from, const conic_camera *camera, const double origin[3], double margin_px);

static inline void conic_viewpoint_move(const conic_viewpoint *from, const double place[3], double p[3]) {
  for (int row = 0; row < 3; row++)
    p[row] = conic_dot(from->rotation[row], place) + from->translation[row];
}

static inline void conic_viewpoint_move_floats(const conic_viewpoint *from, const float place[3], double p[3]) {
  const double moved[3] = {(double)place[0], (double)place[1], (double)place[2]};
  conic_viewpoint_move(from, moved, p);
}

/* The greatest length in a sphere about p, in camera space, that is no more than error_px on the screen in any
 * direction; 0: the sphere reaches the near distance. */
static inline double conic_viewpoint_length_of(const double p[3], double radius, double near_z, double focal_px,
                                               double error_px) {
  double z = p[2] - radius;
  return z > near_z ? error_px * z * z / (focal_px * (conic_length(p) + radius)) : 0.0;
}

/* Whether a sphere about p, in camera space, is wholly beyond a side. */
static inline int conic_viewpoint_misses(const conic_viewpoint *from, const double p[3], double radius) {
  int is_beyond = 0;
  for (int i = 0; i < 4; i++)
    is_beyond |= conic_dot(from->side[i], p) < -radius;
  return is_beyond;
}
