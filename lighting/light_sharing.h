/* conic_image_light by several processes: each draws the maps of some directions, and says which receivers they reach.
 */
#ifndef CONIC_LIGHT_SHARING_H
#define CONIC_LIGHT_SHARING_H

#include "conic/lighting.h"
#include "core/base/team.h"

typedef struct conic_light_sharing {
  const conic_team *team;
  /* For the drawer of maps: */
  int is_apart;   /* the map is this process's alone; else all draw the same map, which the first one needs */
  uint64_t i_map; /* how many maps were drawn before, by whomever */
} conic_light_sharing;

/* Collective: conic_image_light, after which the first process has the picture, to the bits of one process. All have
 * its planes Z and N; what becomes of the others' planes is undefined. Null `sharing`: this process alone. Errors: as
 * conic_image_light; CANCELLED where another process failed. */
conic_status conic_image_light_shared(conic_context *context, const conic_casters *casters, const conic_camera *camera,
                                      const conic_render_options *render, const conic_lighting_options *options,
                                      conic_light_sharing *sharing, conic_image *image);

#endif
