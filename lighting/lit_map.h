/* One map after the other, drawn and received. */
#ifndef CONIC_LIT_MAP_H
#define CONIC_LIT_MAP_H

#include "lighting/light_sharing.h"
#include "lighting/lighting_loops.h"

/* What maps are drawn into and received by. */
typedef struct conic_map_room {
  conic_context *context;
  const conic_casters *casters;
  const conic_receivers *receivers;
  conic_lighting_loops loops;
  double texel; /* in world units, wanted */
  int most_texels;
  float *z;
  size_t n_room;                /* floats of it */
  conic_light_sharing *sharing; /* null: all maps are drawn here */
} conic_map_room;

/* `options` are whole. Errors: ARGUMENT (the casters, the options), UNSUPPORTED. */
conic_status conic_map_room_init(conic_context *context, const char *who, const conic_casters *casters,
                                 const conic_lighting_options *options, conic_map_room *room);

/* Draws the map that a camera sees, nothing nearer than near_z. Errors: MEMORY, the drawer's. */
conic_status conic_map_room_fill(conic_map_room *room, const conic_camera *camera, double near_z, conic_light_map *map);

/* Draws the map of the light from a direction. Errors: as conic_map_room_fill. */
conic_status conic_map_room_draw(conic_map_room *room, const double direction[3], conic_light_map *map);

/* Collective where the light is shared, before what all do together: conic_team_agree, and whether all have as many
 * receivers. Errors: ARGUMENT where this process has others than the first; CANCELLED where another one has, or failed.
 */
conic_status conic_map_room_agree(const conic_map_room *room, conic_status status);

void conic_map_room_release(conic_map_room *room);

/* So many receivers are one thread's at a time. */
enum { CONIC_RECEIVED_TOGETHER = 2048 };

/* Sums over directions, an array of receivers each; null: not wanted. */
typedef struct conic_sky_sums {
  float *facing, *visible; /* Σ max(0, n·d), and of that what nothing hides */
  float *color[3];         /* Σ light · max(0, n·d) of what is visible, or with takes_hidden of what is not */
  int takes_hidden;
} conic_sky_sums;

/* What light comes from a direction: *light is on entry what the sequence says (conic_sky_direction). */
typedef void conic_direction_light(const void *cookie, const double direction[3], double light[3]);

/* Adds the options' directions, whose light is changed by `light`, which may be null. Errors: MEMORY, CANCELLED, the
 * drawer's. Collective where the light is shared: each process draws some of the directions' maps and adds up those of
 * all for some of the receivers, whose number they agree on; all then have all sums. */
conic_status conic_sky_sums_add(conic_map_room *room, const conic_lighting_options *options,
                                conic_direction_light *light, const void *cookie, conic_sky_sums *sums);

/* The part of what faces a receiver that is visible to it: 1 where nothing faces it. */
static inline float conic_sky_sums_share(const conic_sky_sums *sums, size_t i) {
  return sums->facing[i] > 0.0f ? sums->visible[i] / sums->facing[i] : 1.0f;
}

#endif
