/* What of a scene its picture depends on as a whole. */
#ifndef CONIC_SCENE_SCALE_H
#define CONIC_SCENE_SCALE_H

#include "conic/render.h"

/* Fills in what of near_z and splat_length is to be found from the splats, so that no frame of several finds it anew.
 * Errors: MEMORY. */
conic_status conic_scene_scale(conic_context *context, const conic_splats *splats, conic_render_options *options);

#endif
