/* Where camera and scene are while the shutter is open. */
#pragma once

#include "conic/shot.h"

/* Turns a camera by a part of a turn about an axis `up` through a place; by 0 it stays to the bit as it is. */
void conic_camera_orbit(const double center[3], const double up[3], double turns, conic_camera *camera);

/* Moves a camera to where an eye is. Errors: ARGUMENT (two of its kind have no common depth). */
conic_status conic_camera_move_eye(conic_context *context, const conic_stereo_eye *eye, conic_camera *camera);

/* How a sample sees what lets light through: what is lit, or among Gaussians, has one depth, by chance. */
void conic_sample_see(uint64_t index, int has_one_depth, conic_source_view *view);

/* Brings the source's inputs to where they are at a time in the shutter, 0 to 1. Errors: as conic_motion_apply. */
conic_status conic_shot_move(const conic_shot *shot, conic_source *source, double time);
/* Brings them to rest. */
void conic_shot_rest(const conic_shot *shot, conic_source *source);
