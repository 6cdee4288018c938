/* Sources that move as one piece: instead of the source, the camera and the lights that stand in the world move the
 * other way. */
#pragma once

#include "source/source_kind.h"

/* conic_source_move with checked poses; null: at rest. Errors: UNSUPPORTED (the inputs move in different ways, one does
 * more than turn and shift, or one has another shape). */
conic_status conic_carried_move(conic_source *source, const conic_source_pose *poses, size_t n_poses);

/* *rest_camera sees of the source at rest what the camera sees of it in its place, and *rest_render lights it the same.
 * Each may be the very struct that it is made from. */
void conic_carried_look(const conic_source *source, const conic_camera *camera, const conic_render_options *render,
                        conic_camera *rest_camera, conic_render_options *rest_render);

/* Turns the normals of a picture that *rest_camera drew into the world. */
void conic_carried_turn(const conic_source *source, conic_image *image);
