/* A camera's way through places in time: keys, between which all that a camera is goes smoothly and never past them
 * (docs/reference/cameras.md). */
#pragma once

#include "conic/cameras.h"

/* What goes smoothly: the place, where to it looks, what is up in the picture, the roll about the view in degrees, and
 * fx, fy, cx, cy. */
enum {
  CONIC_PATH_PLACE = 0,
  CONIC_PATH_TARGET = 3,
  CONIC_PATH_UP = 6,
  CONIC_PATH_ROLL = 9,
  CONIC_PATH_FOCAL = 10,
  CONIC_PATH_VALUES = 14
};

typedef struct conic_camera_key {
  double time, values[CONIC_PATH_VALUES], slopes[CONIC_PATH_VALUES];
} conic_camera_key;

/* At least two keys, in order of their times. */
typedef struct conic_camera_path {
  conic_camera_key *keys;
  size_t n, room;
  int has_up;         /* of the file's; else the scene's, which conic_camera_path_stand gives it */
  conic_camera usual; /* the size, kind and lens of all cameras on it */
} conic_camera_path;

/* Reads a file of keys, or any file of cameras, whose cameras are keys a second apart. `size` is the pictures', or 0
 * for a file's own. On success the caller releases *path. Errors: INPUT, MEMORY, and those of conic_cameras_read. */
conic_status conic_camera_path_read(conic_context *context, const char *name, const int size[2],
                                    conic_camera_path *path);
/* Sets what is up, where the file does not say it. */
void conic_camera_path_stand(conic_camera_path *path, const double up[3]);
/* Makes a list of the cameras at so many moments a second, from the first key to the last; they have no names. It may
 * be one that this has made before. Errors: ARGUMENT (too many), MEMORY. */
conic_status conic_camera_path_list(conic_context *context, const conic_camera_path *path, double fps,
                                    conic_cameras *cameras);
void conic_camera_path_release(conic_context *context, conic_camera_path *path);
