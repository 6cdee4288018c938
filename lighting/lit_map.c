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
  if (!c->draw || c->epsilon_is_drawn > 1 || !conic_is_zero(c->reserved, sizeof c->reserved))
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
  map->epsilon = (float)room->casters->epsilon;
  map->flat_epsilon = room->casters->epsilon_is_drawn ? 0.0f : map->epsilon;
  conic_status status = room->casters->draw(room->casters->cookie, camera, near_z, &depth);
  if (room->sharing)
    room->sharing->i_map++;
  return status;
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
  const unsigned char *reached; /* a bit a receiver: another process has looked into the map; null: nobody has */
  float light[3];
  const conic_sky_sums *sums;
} sky_adding;

static size_t end_of_receivers(const conic_map_room *room, size_t begin) {
  size_t end = begin + CONIC_RECEIVED_TOGETHER;
  return end < room->receivers->count ? end : room->receivers->count;
}

static void add_sky_light(void *data, size_t i_item, int i_thread) {
  const sky_adding *a = data;
  const conic_sky_sums *sums = a->sums;
  float visible[CONIC_RECEIVED_TOGETHER], facing[CONIC_RECEIVED_TOGETHER];
  size_t begin = i_item * CONIC_RECEIVED_TOGETHER, count = end_of_receivers(a->room, begin) - begin;
  (void)i_thread;
  a->room->kernels.receive(a->map, a->room->receivers, begin, begin + count, 0, visible, facing);
  for (size_t i = 0; i < count && a->reached; i++)
    visible[i] = a->reached[(begin + i) / 8] >> (begin + i) % 8 & 1 ? 1.0f : 0.0f;
  for (size_t i = 0; i < count; i++) {
    sums->facing[begin + i] += facing[i];
    sums->visible[begin + i] += facing[i] * visible[i];
  }
  for (int c = 0; c < 3 && sums->color[0]; c++)
    for (size_t i = 0; i < count; i++)
      sums->color[c][begin + i] += a->light[c] * (facing[i] * (sums->takes_hidden ? 1.0f - visible[i] : visible[i]));
}

/* --- by several processes --- */

/* What a process says of a map to the first one: the nearest texel's answer is yes or no. */
typedef struct sky_looking {
  const conic_map_room *room;
  const conic_light_map *map;
  unsigned char *reached;
} sky_looking;

static void look_into_map(void *data, size_t i_item, int i_thread) {
  const sky_looking *l = data;
  float visible[CONIC_RECEIVED_TOGETHER], facing[CONIC_RECEIVED_TOGETHER];
  size_t begin = i_item * CONIC_RECEIVED_TOGETHER, end = end_of_receivers(l->room, begin);
  (void)i_thread;
  l->room->kernels.receive(l->map, l->room->receivers, begin, end, 0, visible, facing);
  for (size_t i = begin; i < end; i++)
    l->reached[i / 8] |= (unsigned char)((visible[i - begin] > 0.0f) << i % 8);
}

/* A map in which nothing hides anything: how receivers face the light, without looking. */
static void open_map(conic_light_map *map) {
  static const float nothing;
  map->z = &nothing;
  map->width = map->height = 1;
}

/* One map a process and round, so that none waits for long. */
typedef struct sky_round {
  conic_map_room *room;
  const conic_team *team;
  size_t n_items, n_bytes; /* of the bits of all receivers */
  sky_adding *adding;
} sky_round;

/* In the others: what is made of direction `own`. */
static conic_status draw_own_map(const sky_round *r, const double direction[3], unsigned char *reached) {
  conic_light_map map;
  sky_looking looking = {r->room, &map, reached};
  memset(reached, 0, r->n_bytes);
  conic_status status = conic_map_room_draw(r->room, direction, &map);
  if (status == CONIC_OK)
    conic_parallel_for(r->room->context, r->n_items, look_into_map, &looking);
  return status;
}

/* --- all directions --- */

typedef struct sky_walk {
  conic_map_room *room;
  const conic_lighting_options *options;
  conic_direction_light *light;
  const void *cookie;
  size_t n_items;
  sky_adding adding;
  conic_light_map map;
} sky_walk;

/* What comes from direction i. */
static conic_status turn_to_direction(sky_walk *w, uint64_t i, double direction[3]) {
  double from_there[3];
  conic_sky_direction(w->options->sky, w->options->first_direction + i, direction, from_there);
  if (w->light)
    w->light(w->cookie, direction, from_there);
  for (int c = 0; c < 3; c++)
    w->adding.light[c] = (float)from_there[c];
  return conic_progress(w->room->context, "light", (double)i / (double)w->options->n_directions);
}

static void add_direction(sky_walk *w, const unsigned char *reached) {
  w->adding.reached = reached;
  conic_parallel_for(w->room->context, w->n_items, add_sky_light, &w->adding);
}

static conic_status walk_alone(sky_walk *w) {
  conic_status status = CONIC_OK;
  for (uint64_t i = 0; i < w->options->n_directions && status == CONIC_OK; i++) {
    double direction[3];
    status = turn_to_direction(w, i, direction);
    if (status == CONIC_OK)
      status = conic_map_room_draw(w->room, direction, &w->map);
    if (status == CONIC_OK)
      add_direction(w, NULL);
  }
  return status;
}

/* The first process adds what the others say of their directions, in the order of these. */
static conic_status take_directions(sky_walk *w, const sky_round *r, uint64_t first) {
  conic_status status = CONIC_OK;
  for (int other = 1; other < r->team->count && first + (uint64_t)other < w->options->n_directions; other++) {
    conic_camera camera;
    double direction[3], near_z;
    size_t n_bytes;
    unsigned char *reached = r->team->receive(r->team->data, other, &n_bytes);
    conic_status turned = turn_to_direction(w, first + (uint64_t)other, direction);
    status = status == CONIC_OK ? turned : status;
    conic_light_map_place(w->room->casters, w->room->receivers, direction, w->room->texel, w->room->most_texels,
                          &camera, &near_z, &w->map);
    open_map(&w->map);
    add_direction(w, reached);
    r->team->release(r->team->data, reached);
  }
  return status;
}

/* A process's own map of a round. */
static conic_status draw_in_round(sky_walk *w, const sky_round *r, uint64_t i, unsigned char *reached) {
  double direction[3];
  conic_light_sharing *sharing = w->room->sharing;
  if (i >= w->options->n_directions)
    return CONIC_OK;
  sharing->i_map = i;
  conic_status status = turn_to_direction(w, i, direction);
  if (status != CONIC_OK || r->team->index > 0)
    return status == CONIC_OK ? draw_own_map(r, direction, reached) : status;
  status = conic_map_room_draw(w->room, direction, &w->map);
  if (status == CONIC_OK)
    add_direction(w, NULL);
  return status;
}

/* Round by round: all draw a map, all know that none failed, and the first one takes what the others found. */
static conic_status walk_rounds(sky_walk *w, const sky_round *r, unsigned char *reached) {
  const conic_team *team = r->team;
  conic_status status = conic_team_agree(team, reached ? CONIC_OK : CONIC_ERROR_MEMORY), taken = CONIC_OK;
  for (uint64_t first = 0; first < w->options->n_directions && status == CONIC_OK; first += (uint64_t)team->count) {
    uint64_t own = first + (uint64_t)team->index;
    status = conic_team_agree(team, taken == CONIC_OK ? draw_in_round(w, r, own, reached) : taken);
    if (status == CONIC_OK && team->index > 0 && own < w->options->n_directions)
      team->send(team->data, 0, reached, r->n_bytes);
    else if (status == CONIC_OK && team->index == 0)
      taken = take_directions(w, r, first);
  }
  return status == CONIC_OK ? conic_team_agree(team, taken) : status;
}

static conic_status walk_together(sky_walk *w) {
  conic_light_sharing *sharing = w->room->sharing;
  const sky_round r = {w->room, sharing->team, w->n_items, (w->room->receivers->count + 7) / 8};
  unsigned char *reached = conic_memory_allocate(w->room->context, r.n_bytes, 1);
  sharing->is_apart = 1;
  conic_status status = walk_rounds(w, &r, reached);
  sharing->is_apart = 0;
  sharing->i_map = w->options->n_directions;
  conic_memory_release(w->room->context, reached);
  return status;
}

conic_status conic_sky_sums_add(conic_map_room *room, const conic_lighting_options *options,
                                conic_direction_light *light, const void *cookie, conic_sky_sums *sums) {
  sky_walk walk = {.room = room,
                   .options = options,
                   .light = light,
                   .cookie = cookie,
                   .n_items = (room->receivers->count + CONIC_RECEIVED_TOGETHER - 1) / CONIC_RECEIVED_TOGETHER};
  walk.adding = (sky_adding){.room = room, .map = &walk.map, .sums = sums};
  if (walk.n_items == 0)
    return CONIC_OK;
  return room->sharing ? walk_together(&walk) : walk_alone(&walk);
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

/* A surface sees one half of all directions: of what has no normal, that much counts as all. */
static float share_of_splat(const conic_receivers *r, float share, size_t i) {
  int has_none = r->normal[0][i] == 0.0f && r->normal[1][i] == 0.0f && r->normal[2][i] == 0.0f;
  return !has_none ? share : share < 0.5f ? 2.0f * share : 1.0f;
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
  for (size_t i = 0; i < splats->count && status == CONIC_OK; i++)
    ao[i] = share_of_splat(&receivers, ao[i], i);
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
