/* Sources that move as one piece: the camera moves the other way, and so do lights that stand in the world. */
#ifndef CONIC_CARRIED_H
#define CONIC_CARRIED_H

#include "source/source_kind.h"

/* conic_source_move with poses that have been checked; null: at rest. Errors: UNSUPPORTED (the inputs move in different
 * ways, one turns and shifts and does something else, or one has another shape). */
conic_status conic_carried_move(conic_source *source, const conic_source_pose *poses, size_t n_poses);

/* Makes the camera that sees the source at rest as `camera` sees it where it is, and the options that light it in the
 * same way. The results may be where `camera` and `render` are. */
void conic_carried_look(const conic_source *source, const conic_camera *camera, const conic_render_options *render,
                        conic_camera *rest_camera, conic_render_options *rest_render);

/* Turns the normals of such a picture into the world. */
void conic_carried_turn(const conic_source *source, conic_image *image);

#endif
