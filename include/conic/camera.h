/* The pinhole camera, and how one is found for a scene.
 *
 * Camera space: x right, y down, z forward (COLMAP, OpenCV, gsplat); pixel (i, j) covers [i, i+1) × [j, j+1) and its
 * centre is at (i + 0.5, j + 0.5). A point at camera coordinates (x, y, z) projects to (fx·x/z + cx, fy·y/z + cy). */
#ifndef CONIC_CAMERA_H
#define CONIC_CAMERA_H

#include <stdint.h>

#include "conic/context.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conic_camera {
  int width, height;           /* pixels, 1 to 65535 each */
  double fx, fy;               /* focal lengths in pixels */
  double cx, cy;               /* principal point in pixels */
  double cam_from_world[3][4]; /* rows of the rotation and the translation; columns act on (x, y, z, 1) */
  uint64_t reserved[8];
} conic_camera;

/* How conic_camera_frame looks at a box. */
typedef struct conic_framing {
  size_t size; /* sizeof(conic_framing), set by the init function */
  int width, height;
  double azimuth_deg;   /* 0 looks along -z from +z (with y up); grows counter-clockwise seen from above */
  double elevation_deg; /* -90 to 90: how far the camera stands above the horizon */
  double fov_deg;       /* across the shorter side, 0 to 180 exclusive */
  double zoom;          /* multiplies the focal length */
  double up[3];         /* world direction that points up in the picture */
} conic_framing;

/* 1024 × 1024, 30°, 15°, 40°, zoom 1, y up. */
CONIC_API void conic_framing_init_sized(conic_framing *framing, size_t size);
#define conic_framing_init(framing) conic_framing_init_sized(framing, sizeof *(framing))

/* A camera that sees the bounding sphere of the box at 90 % of the picture's shorter side (at zoom 1). A box without
 * extent is framed as if its sphere had radius 1. Errors: ARGUMENT; *camera is then as it was. */
CONIC_API conic_status conic_camera_frame(conic_context *context, const conic_framing *framing, const double minimum[3],
                                          const double maximum[3], conic_camera *camera);

/* Reads a camera from JSON: width, height, fx, fy, cx, cy, world_to_camera (4 × 4, rows). Other keys are ignored.
 * Errors: INPUT, MEMORY; *camera is then as it was. */
CONIC_API conic_status conic_camera_read(conic_context *context, const char *path, conic_camera *camera);

#ifdef __cplusplus
}
#endif
#endif
