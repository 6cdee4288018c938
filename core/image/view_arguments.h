/* Checks of the camera and the options, for all functions that draw or choose what to draw. */
#pragma once

#include "conic/render.h"
#include "core/splats/gaussian_profile.h"

/* Why a matrix is not a rotation and a translation; null if it is. */
const char *conic_rotation_fault(const double rows[3][4]);

enum { CONIC_CAMERA_FAULT_ROOM = 128 };

/* Whether nobody can look through a camera, and why, as "the camera's focal lengths are out of range". */
int conic_camera_is_wrong(const conic_camera *camera, char wrong[CONIC_CAMERA_FAULT_ROOM]);

/* Errors: ARGUMENT: nobody can look through the camera. */
conic_status conic_view_camera_check(conic_context *context, const char *who, const conic_camera *camera);

/* conic_view_camera_check, and that the camera is a pinhole without a lens that distorts. */
conic_status conic_view_pinhole_check(conic_context *context, const char *who, const conic_camera *camera);

/* conic_view_camera_check, and that a ray goes through its pixels (core/image/camera_rays.h). */
conic_status conic_view_ray_check(conic_context *context, const char *who, const conic_camera *camera);

/* conic_view_camera_check, and that the profile draws Gaussians by such a camera. */
conic_status conic_view_profile_check(conic_context *context, const char *who, const conic_profile_row *rules,
                                      const conic_camera *camera);

/* The same of what bounds a profile's pictures, which takes fewer cameras: others than 3dgut-2025's are pinholes. */
conic_status conic_view_bounded_check(conic_context *context, const char *who, const conic_profile_row *rules,
                                      const conic_camera *camera);

/* Copies the caller's options (conic_options_take) to `own`. Errors: ARGUMENT: one is null, the options were not
 * initialised, or nobody can look through the camera. */
conic_status conic_view_arguments_take(conic_context *context, const char *who, const conic_camera *camera,
                                       const conic_render_options *options, conic_render_options *own);
