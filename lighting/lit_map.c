#include "lighting/lit_map.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/base/team_runs.h"
#include "core/splats/columns.h"
#include "lighting/lamps.h"
#include "lighting/sky_team.h"

void conic_lighting_options_init_sized(conic_lighting_options *options, size_t size) {
  static const conic_lighting_options own = {.size = sizeof own, .texels = 1.0, .most_texels = 4096, .samples = 1};
  conic_options_give(options, size, &own);
}

static const char *find_fault(const conic_casters *c, const conic_lighting_options *o) {
  if (!c->draw || !conic_is_zero(c->reserved, sizeof c->reserved))
    return "the casters have nothing that draws them, or their reserved words are not zero";
  for (int axis = 0; axis < 3; axis++)
    if (!(c->minimum[axis] <= c->maximum[axis] && fabs(c->minimum[axis]) < 1e20 && fabs(c->maximum[axis]) < 1e20))
      return "the casters' box is none";
  if (!(c->epsilon >= 0.0 && c->epsilon < 1e20))
    return "the casters' epsilon is out of range";
  if (!(o->texels >= 0.125 && o->texels <= 8.0) || o->most_texels < 16 || o->most_texels > 16384)
    return "a map has 0.125 to 8 texels to a pixel, and its edge 16 to 16384";
  if (o->samples < 1 || o->samples > CONIC_MAX_SAMPLES)
    return "a pixel has 1 to 16 samples";
  return conic_lamps_fault(o);
}

conic_status conic_map_room_init(conic_context *context, const char *who, const conic_casters *casters,
                                 const conic_lighting_options *options, conic_map_room *room) {
  conic_isa isa;
  memset(room, 0, sizeof *room);
  room->context = context;
  room->casters = casters;
  room->most_texels = options->most_texels;
  const char *fault = find_fault(casters, options);
  if (fault)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: %s", who, fault);
  conic_status status = conic_isa_choose(context, options->isa, &isa);
  if (status == CONIC_OK)
    conic_lighting_kernels_init(&room->kernels, isa);
  return status;
}

conic_status conic_map_room_fill(conic_map_room *room, const conic_camera *camera, double near_z,
                                 conic_light_map *map) {
  conic_image depth;
  size_t n = (size_t)camera->width * (size_t)camera->height;
  if (n > room->n_room) {
    conic_memory_release(room->context, room->z);
    room->z = conic_memory_allocate(room->context, n + n / 4, sizeof *room->z);
    room->n_room = room->z ? n + n / 4 : 0;
    if (!room->z)
      return CONIC_ERROR_MEMORY;
    conic_memory_prefer_large_pages(room->context, room->z, room->n_room * sizeof *room->z);
  }
  memset(&depth, 0, sizeof depth);
  depth.width = camera->width;
  depth.height = camera->height;
  depth.planes[CONIC_PLANE_Z] = room->z;
  map->z = room->z;
  return room->casters->draw(room->casters->cookie, camera, near_z, &depth);
}

conic_status conic_map_room_draw(conic_map_room *room, const double direction[3], conic_light_map *map) {
  conic_camera camera;
  double near_z;
  conic_light_map_place(room->casters, room->receivers, direction, room->texel, room->most_texels, &camera, &near_z,
                        map);
  return conic_map_room_fill(room, &camera, near_z, map);
}

void conic_map_room_release(conic_map_room *room) {
  conic_memory_release(room->context, room->z);
  room->z = NULL;
  room->n_room = 0;
}

/* One direction's light, added to all sums. */
typedef struct sky_adding {
  const conic_map_room *room;
  const conic_light_map *map;
  float light[3];
  const conic_sky_sums *sums;
} sky_adding;

static void add_sky_light(void *data, size_t i_item, int i_thread) {
  const sky_adding *a = data;
  const conic_sky_sums *sums = a->sums;
  float visible[CONIC_RECEIVED_TOGETHER], facing[CONIC_RECEIVED_TOGETHER];
  size_t begin = i_item * CONIC_RECEIVED_TOGETHER, count = a->room->receivers->count - begin;
  count = count < CONIC_RECEIVED_TOGETHER ? count : CONIC_RECEIVED_TOGETHER;
  (void)i_thread;
  a->room->kernels.receive(a->map, a->room->receivers, begin, begin + count, 0, visible, facing);
  for (size_t i = 0; i < count; i++) {
    sums->facing[begin + i] += facing[i];
    sums->visible[begin + i] += facing[i] * visible[i];
  }
  for (int c = 0; c < 3 && sums->color[0]; c++)
    for (size_t i = 0; i < count; i++)
      sums->color[c][begin + i] += a->light[c] * (facing[i] * (sums->takes_hidden ? 1.0f - visible[i] : visible[i]));
}

conic_status conic_sky_sums_add(conic_map_room *room, const conic_lighting_options *options,
                                conic_direction_light *light, const void *cookie, conic_sky_sums *sums) {
  conic_light_map map;
  sky_adding adding = {.room = room, .map = &map, .sums = sums};
  size_t n_items = (room->receivers->count + CONIC_RECEIVED_TOGETHER - 1) / CONIC_RECEIVED_TOGETHER;
  conic_status status = CONIC_OK;
  for (uint64_t i = 0; i < options->n_directions && n_items > 0 && status == CONIC_OK; i++) {
    double direction[3], from_there[3];
    conic_sky_direction(options->sky, options->first_direction + i, direction, from_there);
    if (light)
      light(cookie, direction, from_there);
    for (int c = 0; c < 3; c++)
      adding.light[c] = (float)from_there[c];
    status = conic_progress(room->context, "light", (double)i / (double)options->n_directions);
    if (status == CONIC_OK)
      status = conic_map_room_draw(room, direction, &map);
    if (status == CONIC_OK)
      conic_parallel_for(room->context, n_items, add_sky_light, &adding);
  }
  return status;
}

static conic_status sum_up_visible(conic_map_room *room, const conic_lighting_options *options, float *ao) {
  conic_context *context = room->context;
  size_t n = room->receivers->count;
  conic_sky_sums sums = {.visible = ao};
  memset(ao, 0, n * sizeof *ao);
  sums.facing = conic_memory_allocate_zeroed(context, n, sizeof *sums.facing);
  conic_status status = sums.facing ? conic_sky_sums_add(room, options, NULL, NULL, &sums) : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    ao[i] = conic_sky_sums_share(&sums, i);
  conic_memory_release(context, sums.facing);
  return status;
}

/* Maps are drawn by each process of a team alone. */
static conic_status find_visible(conic_map_room *room, const conic_lighting_options *options, float *ao) {
  conic_context *context = room->context;
  const conic_team *team = conic_context_join(context, NULL);
  if (!team)
    return sum_up_visible(room, options, ao);
  conic_status status = conic_sky_share_visible(room, options, team, ao);
  if (status == CONIC_OK)
    conic_context_join(context, team);
  return status;
}

static conic_status occlude_splats(conic_context *context, const conic_casters *casters, const conic_splats *splats,
                                   double spacing, const conic_lighting_options *options, float *ao) {
  conic_receivers receivers;
  conic_map_room room;
  conic_status status = conic_map_room_init(context, "light", casters, options, &room);
  if (status != CONIC_OK)
    return status;
  status = conic_receivers_of_splats(context, splats, spacing, &receivers);
  room.receivers = &receivers;
  room.texel = spacing / options->texels;
  if (status == CONIC_OK)
    status = find_visible(&room, options, ao);
  conic_receivers_release(context, &receivers);
  conic_map_room_release(&room);
  return status;
}

conic_status conic_splats_occlude(conic_context *context, const conic_casters *casters, const conic_splats *splats,
                                  double spacing, const conic_lighting_options *options, float *ao) {
  conic_lighting_options own;
  conic_splats close;
  float *block;
  conic_lighting_options_init(&own);
  if (!casters || !ao || !conic_options_take(&own, options))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "light: an argument is null, or the options were not initialised");
  conic_status status = conic_splats_enter(context, "light", splats, &close, &block);
  if (status != CONIC_OK)
    return status;
  if (!close.tangent_u[0] || !(spacing > 0.0 && spacing < 1e20))
    status =
        conic_fail(context, CONIC_ERROR_ARGUMENT, "light: the splats have no tangent axes, or the spacing is none");
  if (status == CONIC_OK)
    status = occlude_splats(context, casters, &close, spacing, &own, ao);
  conic_memory_release(context, block);
  return status;
}
