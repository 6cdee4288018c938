/* Pictures of cameras other than pinholes, gathered from the pictures of pinholes ("views"), which any renderer draws:
 * fisheyes, lenses that distort, panoramas, cubes and parallel projections. docs/reference/cameras.md says how, and how
 * far the surface that a pixel shows is from its own ray. */
#ifndef CONIC_GATHER_H
#define CONIC_GATHER_H

#include "conic/image.h"

CONIC_BEGIN_C

/* A view to be drawn. */
typedef struct conic_gather_view {
  conic_camera camera; /* a pinhole of the image's size */
  double near_z;       /* nothing nearer is drawn */
  int samples;         /* N × N a pixel */
  int reserved_int;
  uint64_t reserved[4];
} conic_gather_view;

typedef struct conic_gather_options {
  size_t size;         /* sizeof(conic_gather_options), set by the init function */
  conic_camera camera; /* of any kind and lens */
  double near_z;       /* of a cube and an orthographic camera: as of a pinhole; of others: from each side of a cube */
  int samples;         /* N × N a pixel */
  double fineness;     /* 1 or more: a view's pixel is no larger than a sample's, divided by this */
  double shift[2]; /* 0 to 1: where the views' pixels lie in their grid, in pixels, and where an orthographic camera's
                      views lie in the picture, in their edge. It matters only for means of many pictures */
  /* The eye's way to the right, down and forward, in world units. The picture stays as it is at the depth or distance
   * `focus` from the camera. */
  double lens[3], focus;
  double minimum[3], maximum[3]; /* box of all that is drawn; only an orthographic camera looks at it */
  float empty[4];                /* rgba where the camera sees no direction */
  unsigned view_planes;          /* planes that the views have beside the image's */
  void *cookie;
  /* Draws all planes of the view's image; depth is a pinhole's. Any status but OK ends the gathering. */
  conic_status (*draw)(void *cookie, const conic_gather_view *view, conic_image *image);
  int edge; /* an orthographic camera's views have at most so many pixels a side, 32 to 4096. Their rays are off by up
               to half a view's diagonal / 2048 */
} conic_gather_options;

/* One sample, fineness 2, the eye in its place, an edge of 256. */
CONIC_API void conic_gather_options_init_sized(conic_gather_options *options, size_t size);
#define conic_gather_options_init(options) conic_gather_options_init_sized(options, sizeof *(options))

/* Draws the views that the camera needs, one after the other, and fills the image's planes from them. Z and medianZ are
 * depths as the camera's kind has them (conic_camera_rays.h: along the ray for fisheyes and panoramas), inverseZ is 1
 * over that, and all else is as in the views. With several samples a pixel, the image may have drawn planes and the
 * cluster plane alone. The bits do not depend on the threads, unless `draw` depends on them. Errors: ARGUMENT, MEMORY,
 * CANCELLED, and what `draw` returns. */
CONIC_API conic_status conic_gather(conic_context *context, const conic_gather_options *options, conic_image *image);

CONIC_END_C
#endif
