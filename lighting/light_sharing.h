/* conic_image_light by several processes: each draws the maps of some directions, and tells which receivers their light
 * reaches. */
#pragma once

#include "conic/lighting.h"
#include "core/base/team.h"

typedef struct conic_light_sharing {
  const conic_team *team;
  /* For the drawer of maps: */
  int is_apart;   /* only this process draws the map; else all draw the same map, which the first process needs */
  uint64_t i_map; /* how many maps all processes drew before */
} conic_light_sharing;

/* Collective: conic_image_light by a team. Afterwards the first process has the picture, with the bits of a single
 * process. Every process has the picture's planes Z and N; the other processes' planes are undefined afterwards. Null
 * `sharing`: this process works alone. Errors: as conic_image_light; CANCELLED where another process failed. */
conic_status conic_image_light_shared(conic_context *context, const conic_casters *casters, const conic_camera *camera,
                                      const conic_render_options *render, const conic_lighting_options *options,
                                      conic_light_sharing *sharing, conic_image *image);
