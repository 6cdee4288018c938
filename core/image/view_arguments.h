/* What is asked of the camera and the options of whoever draws, or chooses what to draw. */
#ifndef CONIC_VIEW_ARGUMENTS_H
#define CONIC_VIEW_ARGUMENTS_H

#include "conic/camera.h"
#include "conic/render.h"

/* What makes a matrix no rotation and translation, or null. */
const char *conic_rotation_fault(const double rows[3][4]);

enum { CONIC_CAMERA_FAULT_ROOM = 128 };

/* Whether a camera is none to look through, and why, as "the camera's focal lengths are out of range". */
int conic_camera_is_wrong(const conic_camera *camera, char wrong[CONIC_CAMERA_FAULT_ROOM]);

/* Errors: ARGUMENT: the camera is none to look through. */
conic_status conic_view_camera_check(conic_context *context, const char *who, const conic_camera *camera);

/* The same, and that it is a pinhole without a lens that distorts. */
conic_status conic_view_pinhole_check(conic_context *context, const char *who, const conic_camera *camera);

/* The same, and that a ray goes through its pixels (core/image/camera_rays.h). */
conic_status conic_view_ray_check(conic_context *context, const char *who, const conic_camera *camera);

/* Copies what the caller gave (conic_options_take) to `own`. Errors: ARGUMENT: one is null, the options were not
 * initialised, or the camera is none to look through. */
conic_status conic_view_arguments_take(conic_context *context, const char *who, const conic_camera *camera,
                                       const conic_render_options *options, conic_render_options *own);

#endif
