/* A picture of Gaussians that is set up once and drawn window by window. */
#pragma once

#include "gaussians/draw/gaussian_tile.h"

typedef struct conic_gaussian_picture conic_gaussian_picture;

/* Pixels of a picture, from begin to before end; they begin at multiples of CONIC_GAUSSIAN_TILE, and end there or where
 * the picture ends. */
typedef struct conic_gaussian_window {
  int begin[2], end[2];
} conic_gaussian_window;

/* Sets up all Gaussians, which stay as they are until the picture is released; with normals where a window wants them.
 * On success the caller owns *picture. Errors: as conic_gaussians_render. */
conic_status conic_gaussian_picture_begin(conic_context *context, const conic_gaussians *gaussians,
                                          const conic_camera *camera, const conic_gaussian_options *options,
                                          int has_normals, conic_gaussian_picture **picture);

/* Puts in order, bins and composites what the window meets, into planes of its size. On a device the window is the
 * picture. Errors: MEMORY, CANCELLED, the device's. */
conic_status conic_gaussian_picture_draw(conic_gaussian_picture *f, const conic_gaussian_window *window,
                                         conic_gaussian_planes *planes);

/* From now on the picture is drawn in plain C, and says of what: `steps` has room for all that windows composite, and
 * their size. */
void conic_gaussian_picture_note(conic_gaussian_picture *f, conic_gaussian_steps *steps);

/* What was drawn so far, and how long it took. The counts are the whole picture's from the beginning on. */
const conic_gaussian_statistics *conic_gaussian_picture_statistics(const conic_gaussian_picture *f);

/* Null is allowed. */
void conic_gaussian_picture_release(conic_gaussian_picture *f);
