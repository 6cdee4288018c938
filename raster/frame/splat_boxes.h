/* Where in a picture splats are, before any of it is drawn: for who deals out its windows. */
#pragma once

#include "raster/project/projected.h"

/* Projects the splats, which have no clip lines, as the picture with these planes does: boxes[i] holds the pixels that
 * splat i may cover, and is empty where it is not drawn. Of `statistics`, sets what became of them. The camera is of
 * one sample a pixel; near_z and splat_length are given. Errors: as conic_render. */
conic_status conic_splats_find_boxes(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                     const conic_render_options *given, unsigned planes, conic_box *boxes,
                                     conic_render_statistics *statistics);
