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
  int is_pinhole;                 /* perspective, without a lens */
} conic_camera_rays;

void conic_camera_rays_init(const conic_camera *camera, conic_camera_rays *rays);

/* The world's point that is seen at a place of the picture, in pixels, at a depth. */
void conic_camera_unproject(const conic_camera_rays *rays, double x_px, double y_px, double z, double place[3]);

/* From a pixel's centre to the sample whose depth is in the plane Z, along both axes. */
static inline double conic_depth_offset(int samples) {
  return samples % 2 ? 0.0 : -0.5 / samples;
}

/* conic_camera_ray of a camera of any kind. */
int conic_camera_ray_bent(const conic_camera_rays *rays, double x_px, double y_px, double origin[3],
                          double direction[3]);

/* The ray through a place of the picture, in pixels, in camera space: origin + z·direction. For perspective and
 * orthographic cameras the direction's z is 1, and z is the depth; so it is for a cube's side in the side's own axes.
 * Other cameras have unit directions, and z is the distance from the eye. Returns 0 where no ray goes through the
 * place: the camera sees no direction there, or the lens has no single one. */
static inline int conic_camera_ray(const conic_camera_rays *rays, double x_px, double y_px, double origin[3],
                                   double direction[3]) {
  const conic_camera *camera = rays->camera;
  if (!rays->is_pinhole)
    return conic_camera_ray_bent(rays, x_px, y_px, origin, direction);
  origin[0] = origin[1] = origin[2] = 0.0;
  direction[0] = (x_px - camera->cx) / camera->fx;
  direction[1] = (y_px - camera->cy) / camera->fy;
  direction[2] = 1.0;
  return 1;
}
