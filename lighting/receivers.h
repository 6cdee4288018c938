/* What light falls on: points of a surface, with their normals. */
#pragma once

#include "conic/image.h"
#include "conic/splats.h"
#include "core/image/camera_rays.h"

typedef struct conic_receivers {
  size_t count;
  double origin[3];               /* in the world; positions are measured from it: the middle of their box */
  double half[3];                 /* of that box */
  double spacing;                 /* the mean edge of the area of a receiver, in world units */
  float *position[3], *normal[3]; /* unit normals; or 0: the receiver faces parallel rays from all sides */
  uint32_t *pixel;                /* the receiver's pixel in the picture; null: they are splats */
  float *block;                   /* the memory of all these */
} conic_receivers;

/* Makes receivers of the pixels that have a depth and a normal, row by row. Errors: ARGUMENT, MEMORY. */
conic_status conic_receivers_of_image(conic_context *context, const conic_camera *camera, int samples,
                                      const conic_image *image, conic_receivers *receivers);

/* Makes receivers of all splats of a set. Dots and splats without axes have no normal; a splat without a finite place
 * is put in the middle of all. Errors: MEMORY. */
conic_status conic_receivers_of_splats(conic_context *context, const conic_splats *splats, double spacing,
                                       conic_receivers *receivers);

void conic_receivers_release(conic_context *context, conic_receivers *receivers);

/* The world position of what a place of the picture, in pixels, shows at depth z; returns 0 where there is none. */
int conic_pixel_place(const conic_camera_rays *rays, double x_px, double y_px, double z, double world[3]);

/* The unit direction in the world from what a pixel shows to the viewer. */
void conic_pixel_viewer(const conic_camera_rays *rays, size_t x, size_t y, float viewer[3]);
