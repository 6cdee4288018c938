/* Parts of gathering a picture: the grid of each view, and pictures that consist of views. */
#pragma once

#include "conic/gather.h"
#include "core/image/camera_rays.h"

typedef struct conic_gathering {
  conic_context *context;
  const conic_gather_options *options;
  conic_image *image;
} conic_gathering;

/* The camera of a side, with its eye moved in camera space; its inner numbers are left to the caller. */
conic_camera conic_gather_side_camera(const conic_camera *camera, const double side[3][3], const double eye[3]);

/* Draws a view of the size of its camera into planes that the caller releases. */
conic_status conic_gather_draw(const conic_gathering *g, const conic_gather_view *view, conic_image *image);

/* Whether a plane holds depths, or 1 over them. */
int conic_gather_is_depth(conic_plane plane);

/* Gathers pictures that consist of views, pixel by pixel: of a cube, and of an orthographic camera. */
conic_status conic_gather_cube(const conic_gathering *g);
conic_status conic_gather_parallel(const conic_gathering *g);

/* Gathers all other pictures. */
conic_status conic_gather_central(const conic_gathering *g);
