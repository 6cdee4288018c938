/* The camera, and how one is found for a scene.
 *
 * Camera space: x right, y down, z forward (COLMAP, OpenCV, gsplat); pixel (i, j) covers [i, i+1) × [j, j+1) and its
 * centre is at (i + 0.5, j + 0.5). A point at camera coordinates (x, y, z) projects to (fx·a + cx, fy·b + cy), where
 * (a, b) is what the camera's kind makes of the point, distorted by its lens. Where kind and lens are zero, the camera
 * is a pinhole: (a, b) = (x/z, y/z). Everything can draw a pinhole; a function that cannot draw another kind or lens
 * refuses it: ARGUMENT. */
#ifndef CONIC_CAMERA_H
#define CONIC_CAMERA_H

#include <stdint.h>

#include "conic/context.h"

CONIC_BEGIN_C

typedef enum conic_camera_kind {
  CONIC_CAMERA_PERSPECTIVE,     /* (x/z, y/z) */
  CONIC_CAMERA_FISHEYE,         /* (x, y)·θ/‖(x, y)‖, θ the angle from the z axis: equidistant */
  CONIC_CAMERA_ORTHOGRAPHIC,    /* (x, y): fx and fy are pixels per unit */
  CONIC_CAMERA_EQUIRECTANGULAR, /* (atan2(x, z), atan2(y, hypot(x, z))): fx and fy are pixels per radian */
  CONIC_CAMERA_CUBE, /* six pinholes, one below the other, each as high as the picture is wide: OpenEXR's cube, +X −X +Y
                        −Y +Z −Z, where +Z is z and +Y is −y; fx, fy, cx and cy are each side's. Nothing draws it but
                        conic/gather.h */
  CONIC_N_CAMERA_KINDS
} conic_camera_kind;

/* What a lens does to (a, b), named as COLMAP does. With s = a² + b², each gives (a', b') = (a, b)·r + d. */
typedef enum conic_lens {
  CONIC_LENS_NONE,   /* r = 1, d = 0 */
  CONIC_LENS_RADIAL, /* k1 k2 k3 k4: r = 1 + k1·s + k2·s² + k3·s³ + k4·s⁴; of a fisheye, s is θ² */
  CONIC_LENS_OPENCV, /* k1 k2 p1 p2 k3 k4 k5 k6: r = (1 + k1·s + k2·s² + k3·s³)/(1 + k4·s + k5·s² + k6·s³),
                        d = (2·p1·a·b + p2·(s + 2·a²), p1·(s + 2·b²) + 2·p2·a·b) */
  CONIC_LENS_THIN_PRISM, /* k1 k2 p1 p2 k3 k4 s1 s2: r as RADIAL's; d as OPENCV's plus (s1·s, s2·s) */
  CONIC_LENS_FOV,        /* ω: r = atan(2·√s·tan(ω/2))/(ω·√s), d = 0 (Devernay and Faugeras 2001) */
  CONIC_LENS_DIVISION,   /* k: r = 2/(1 + √(1 − 4·k·s)), d = 0 (Fitzgibbon 2001) */
  CONIC_LENS_EUCM,       /* α β: r = 1/(α·√(1 + β·s) + 1 − α), d = 0 (Khomutenko and others 2016) */
  CONIC_N_LENSES
} conic_lens;

/* Which way the rows or columns of a picture are exposed, one after the other. The pose goes from the first one's to
 * the last one's linearly in its translation, and by equal turns. Gaussians by 3dgut-2025 alone are drawn so. */
typedef enum conic_shutter {
  CONIC_SHUTTER_GLOBAL, /* all at once */
  CONIC_SHUTTER_TOP_TO_BOTTOM,
  CONIC_SHUTTER_LEFT_TO_RIGHT,
  CONIC_SHUTTER_BOTTOM_TO_TOP,
  CONIC_SHUTTER_RIGHT_TO_LEFT,
  CONIC_N_SHUTTERS
} conic_shutter;

/* "global", "top-to-bottom", "left-to-right", "bottom-to-top", "right-to-left"; null for an unknown number. */
CONIC_API const char *conic_shutter_name(conic_shutter shutter);

/* "perspective", "fisheye", "orthographic", "equirectangular", "cube"; and "none", "radial", "opencv", "thin-prism",
 * "fov", "division", "eucm"; null for an unknown number. */
CONIC_API const char *conic_camera_kind_name(conic_camera_kind kind);
CONIC_API const char *conic_lens_name(conic_lens lens);

typedef struct conic_camera {
  int width, height;           /* pixels, 1 to 65535 each */
  double fx, fy;               /* focal lengths in pixels */
  double cx, cy;               /* principal point in pixels */
  double cam_from_world[3][4]; /* rows of the rotation and the translation; columns act on (x, y, z, 1) */
  uint32_t kind, lens;         /* conic_camera_kind, conic_lens */
  double distortion[8];        /* the lens's numbers as listed; 0 past them */
  uint32_t shutter;            /* conic_shutter; the rest is of a rolling one */
  uint32_t reserved_word;
  double turn[3], shift[3]; /* from the first row's or column's pose, which is cam_from_world, to the last one's: x, y
                               and z of the unit quaternion by which it is turned further (w is not below 0), and
                               what the translation gains */
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

/* Reads the camera of a file that has one, of any kind that conic_cameras_read reads. conic's own is JSON: width,
 * height, fx, fy, cx, cy, world_to_camera (4 × 4, rows), and kind, lens and distortion where it is no pinhole; other
 * keys are ignored. A rolling shutter has the keys shutter and world_to_camera_end. Errors: INPUT, MEMORY, UNSUPPORTED;
 * *camera is then as it was. */
CONIC_API conic_status conic_camera_read(conic_context *context, const char *path, conic_camera *camera);

CONIC_END_C
#endif
