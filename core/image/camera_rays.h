/* Rays through places of a picture, for cameras of every kind: the inverse of conic/camera.h's projection. */
#pragma once

#include "conic/camera.h"

enum { CONIC_CUBE_SIDES = 6, CONIC_CUBE_FORWARD = 4 };

/* The sides of a cube in OpenEXR's order, +X −X +Y −Y +Z −Z; the camera looks at +Z, and +Y is above. For each side:
 * the directions right, down and forward of its picture, in camera space. */
extern const double conic_cube_sides[CONIC_CUBE_SIDES][3][3];

/* A lens as a' = a·top(s)/bottom(s) and so on, and how far from its centre it is one-to-one. */
typedef struct conic_camera_rays {
  const conic_camera *camera;
  double top[5], bottom[4], tangential[2], prism[2];
  double most_radius, most_place; /* the radius √s, and its distorted radius, up to which the distorted radius grows */
  int is_bent;                    /* tangential or prism is not zero */
} conic_camera_rays;

void conic_camera_rays_init(const conic_camera *camera, conic_camera_rays *rays);

/* The ray through a place of the picture, in pixels, in camera space: origin + z·direction. For perspective and
 * orthographic cameras the direction's z is 1, and z is the depth; so it is for a cube's side in the side's own axes.
 * Other cameras have unit directions, and z is the distance from the eye. Returns 0 where no ray goes through the
 * place: the camera sees no direction there, or the lens has no single one. */
int conic_camera_ray(const conic_camera_rays *rays, double x_px, double y_px, double origin[3], double direction[3]);
