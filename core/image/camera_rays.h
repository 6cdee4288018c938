/* Rays through places of a picture, for cameras of every kind: what conic/camera.h says, the other way round. */
#ifndef CONIC_CAMERA_RAYS_H
#define CONIC_CAMERA_RAYS_H

#include "conic/camera.h"

enum { CONIC_CUBE_SIDES = 6, CONIC_CUBE_FORWARD = 4 };

/* The sides of a cube in OpenEXR's order, +X −X +Y −Y +Z −Z, +Z being where the camera looks and +Y what is above it:
 * of each what is to the right in it, downwards, and forward, in camera space. */
extern const double conic_cube_sides[CONIC_CUBE_SIDES][3][3];

/* A lens as a' = a·top(s)/bottom(s) and so on; how far from its centre it maps one place to one. */
typedef struct conic_camera_rays {
  const conic_camera *camera;
  double top[5], bottom[4], tangential[2], prism[2];
  double most_radius, most_place; /* √s, and the distorted radius, up to which that grows */
  int is_bent;                    /* tangential or prism is not zero */
} conic_camera_rays;

void conic_camera_rays_init(const conic_camera *camera, conic_camera_rays *rays);

/* The ray through a place of the picture, in pixels, in camera space: origin + z·direction. The direction's z is 1 for
 * perspective and orthographic cameras, where z is the depth, and so in its own axes is that of a cube's side; others
 * have unit directions, and z is the distance from the eye. Returns 0 where none goes through the place: no direction
 * is seen there, or the lens has no single one. */
int conic_camera_ray(const conic_camera_rays *rays, double x_px, double y_px, double origin[3], double direction[3]);

#endif
