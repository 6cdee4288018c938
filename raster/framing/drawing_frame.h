/* conic_drawing_frame of a drawing whose parts the processes of a team have. */
#pragma once

#include "conic/triangles.h"
#include "core/splats/shares.h"

/* Collective where there is a team; then `drawing` is this process's splats, and there are no triangles. Errors: as
 * conic_drawing_frame, CANCELLED. */
conic_status conic_drawing_frame_shared(conic_context *context, const conic_splats_shares *shares,
                                        const conic_drawing *drawing, float cutoff, const conic_framing *given,
                                        int n_turns, conic_camera *camera, double *near_z);
