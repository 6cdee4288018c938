/* What of a scene its picture depends on as a whole. */
#ifndef CONIC_SCENE_SCALE_H
#define CONIC_SCENE_SCALE_H

#include "conic/render.h"

/* Finds near_z and splat_length from the splats, where they are not given, so that several frames find them once.
 * Errors: MEMORY. */
conic_status conic_scene_scale(conic_context *context, const conic_splats *splats, conic_render_options *options);

#endif
