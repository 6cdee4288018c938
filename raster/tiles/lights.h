/* A frame's lights, from what its options say. */
#pragma once

#include "raster/tiles/finish.h"

static inline int conic_is_grey(const float color[3]) {
  return color[0] == color[1] && color[1] == color[2];
}

/* Errors: ARGUMENT (a light without a direction, a colour out of range …). */
conic_status conic_finish_lights_init(conic_context *context, const conic_camera *camera,
                                      const conic_render_options *options, conic_finish_lights *lights);

/* A picture's, whose lights they become. Errors: as there. */
conic_status conic_finish_init(conic_context *context, const conic_camera *camera, const conic_render_options *options,
                               conic_finish_lights *lights, conic_finish *finish);

/* Lights that move with the camera become lights in the world, as it sees them. */
void conic_lighting_place(const conic_camera *camera, conic_lighting *lighting);
