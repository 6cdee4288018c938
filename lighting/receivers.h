/* What light falls on: points of a surface, with the sides that they face. */
#ifndef CONIC_RECEIVERS_H
#define CONIC_RECEIVERS_H

#include <stdint.h>

#include "conic/camera.h"
#include "conic/image.h"
#include "conic/splats.h"
#include "core/image/camera_rays.h"

typedef struct conic_receivers {
  size_t count;
  double origin[3];               /* in the world, from which positions are measured: the middle of their box */
  double half[3];                 /* of that box */
  double spacing;                 /* the mean edge of what one stands for, in world units */
  float *position[3], *normal[3]; /* normals of unit length, or 0: it faces parallel rays, wherever from */
  uint32_t *pixel;                /* which pixel of the picture it is; null: of splats */
  float *block;                   /* what holds all these */
} conic_receivers;

/* The pixels of a picture that have a depth and a normal, row by row. Errors: ARGUMENT, MEMORY. */
conic_status conic_receivers_of_image(conic_context *context, const conic_camera *camera, int samples,
                                      const conic_image *image, conic_receivers *receivers);

/* All splats of a set; dots and what has no axes have no normal, and one without a place is in the middle of all.
 * Errors: MEMORY. */
conic_status conic_receivers_of_splats(conic_context *context, const conic_splats *splats, double spacing,
                                       conic_receivers *receivers);

void conic_receivers_release(conic_context *context, conic_receivers *receivers);

/* Of the sample that Z is of, how far it is from the pixel's centre to the right and down. */
double conic_receiver_offset(int samples);

/* Where what is seen at a place of the picture, in pixels, is in the world by its depth; 0: nowhere. */
int conic_pixel_place(const conic_camera_rays *rays, double x_px, double y_px, double z, double world[3]);

/* The unit direction from what is seen at a pixel to the viewer, in the world. */
void conic_pixel_viewer(const conic_camera_rays *rays, size_t x, size_t y, float viewer[3]);

#endif
