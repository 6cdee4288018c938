/* The pose of a camera with a rolling shutter at each of its rows or columns. */
#pragma once

#include "conic/camera.h"

/* Shares of the exposure are counted from its middle, −½ to ½. At a share b, what the camera in the middle has at p is
 * at S·p + (t − S·t + b·shift), S a turn by b times the whole one and t the middle's translation. */
typedef struct conic_camera_shutter {
  uint32_t way; /* conic_shutter */
  int n;        /* rows or columns */
  double axis[3], angle, shift[3], translation[3];
} conic_camera_shutter;

/* The camera in the middle of the exposure, which still knows its shutter; as it is where it has none. */
void conic_camera_shutter_middle(const conic_camera *camera, conic_camera *middle);

/* The eye that colours are seen from: the middle between the first and the last. */
void conic_camera_shutter_eye(const conic_camera *camera, double eye[3]);

/* Of the camera in the middle. */
void conic_camera_shutter_init(const conic_camera *middle, conic_camera_shutter *shutter);

/* The share at which a place of the picture is exposed, in pixels, which may lie beside the picture. */
double conic_camera_shutter_share(const conic_camera_shutter *shutter, const double place[2]);

/* S, and where it then moves. */
void conic_camera_shutter_pose(const conic_camera_shutter *shutter, double share, double turn[3][3], double moved[3]);

/* Gives the camera the turn and the shift to the end's pose. */
void conic_camera_shutter_between(const conic_camera *end, conic_camera *camera);
/* And back: the last pose. */
void conic_camera_shutter_end(const conic_camera *camera, double cam_from_world[3][4]);
