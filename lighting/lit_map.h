/* Draws maps and receives their light, one after the other. */
#pragma once

#include "lighting/light_map.h"
#include "lighting/light_sharing.h"

/* The memory and options of drawing and receiving maps. */
typedef struct conic_map_room {
  conic_context *context;
  const conic_casters *casters;
  const conic_receivers *receivers;
  conic_lighting_loops loops;
  double texel; /* the wanted one, in world units */
  int most_texels;
  float *z;
  size_t n_room;                /* floats that it has room for */
  conic_light_sharing *sharing; /* null: this process draws all maps */
} conic_map_room;

/* `options` have every member. Errors: ARGUMENT (the casters, the options), UNSUPPORTED. */
conic_status conic_map_room_init(conic_context *context, const char *who, const conic_casters *casters,
                                 const conic_lighting_options *options, conic_map_room *room);

/* Draws the map that a camera sees, without anything nearer than near_z. Errors: MEMORY, the drawer's. */
conic_status conic_map_room_fill(conic_map_room *room, const conic_camera *camera, double near_z, conic_light_map *map);

/* Draws the map of the light from a direction. Errors: as conic_map_room_fill. */
conic_status conic_map_room_draw(conic_map_room *room, const double direction[3], conic_light_map *map);

/* Collective where the light is shared, to be called before collective work: conic_team_agree, and a check that all
 * processes have as many receivers. Errors: ARGUMENT where this process has another number than the first; CANCELLED
 * where another process has, or failed. */
conic_status conic_map_room_agree(const conic_map_room *room, conic_status status);

void conic_map_room_release(conic_map_room *room);

/* A thread takes so many receivers at a time. */
enum { CONIC_RECEIVED_TOGETHER = 2048 };

/* Sums over directions, each an array with one value a receiver; null: not wanted. */
typedef struct conic_sky_sums {
  float *facing, *visible; /* Σ max(0, n·d), and the unhidden part of it */
  float *color[3];         /* Σ light · max(0, n·d) of the visible directions, or with takes_hidden of the hidden
                              ones */
  int takes_hidden;
} conic_sky_sums;

/* Changes the light from a direction: *light is on entry what the sequence says (conic_sky_direction). */
typedef void conic_direction_light(const void *cookie, const double direction[3], double light[3]);

/* Adds the light of the options' directions, changed by `light`, which may be null. Errors: MEMORY, CANCELLED, the
 * drawer's. Collective where the light is shared: each process draws some of the maps, and adds up all directions for
 * some of the receivers, whose number all agree on; in the end all have all sums. */
conic_status conic_sky_sums_add(conic_map_room *room, const conic_lighting_options *options,
                                conic_direction_light *light, const void *cookie, conic_sky_sums *sums);

/* The visible part of the light that a receiver faces: 1 where it faces none. */
static inline float conic_sky_sums_share(const conic_sky_sums *sums, size_t i) {
  /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): there are sums of every receiver */
  return sums->facing[i] > 0.0f ? sums->visible[i] / sums->facing[i] : 1.0f;
}
