#include "lighting/lit_map.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/base/team_runs.h"
#include "core/splats/columns.h"
#include "lighting/lamps.h"

/* Bytes of bits, one for each receiver. */
enum { BYTES_OF_ITEM = CONIC_RECEIVED_TOGETHER / 8 };

void conic_lighting_options_init_sized(conic_lighting_options *options, size_t size) {
  static const conic_lighting_options own = {.size = sizeof own, .texels = 1.0, .most_texels = 4096, .samples = 1};
  conic_options_give(options, size, &own);
}

static const char *find_fault(const conic_casters *c, const conic_lighting_options *o) {
  if (!c->draw || c->epsilon_is_drawn > 1 || c->lets_through > 1 || !conic_is_zero(c->reserved, sizeof c->reserved))
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
    conic_lighting_loops_init(&room->loops, isa);
  return status;
}

conic_status conic_map_room_fill(conic_map_room *room, const conic_camera *camera, double near_z,
                                 conic_light_map *map) {
  conic_image depth;
  const size_t n_texels = (size_t)camera->width * (size_t)camera->height,
               n = room->casters->lets_through ? 2 * n_texels : n_texels;
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
  if (room->casters->lets_through) {
    depth.planes[CONIC_PLANE_TRANSPARENCY] = room->z + n_texels;
    map->through = room->z + n_texels;
  }
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

conic_status conic_map_room_agree(const conic_map_room *room, conic_status status) {
  const conic_team *team = room->sharing ? room->sharing->team : NULL;
  uint64_t counts[CONIC_MOST_IN_TEAM];
  status = conic_team_agree(team, status);
  if (!team || status != CONIC_OK)
    return status;
  const uint64_t own = room->receivers->count;
  conic_team_collect(team, &own, sizeof own, counts);
  if (own != counts[0])
    return conic_fail(room->context, CONIC_ERROR_ARGUMENT, "light: process %d has %llu receivers, and the first %llu",
                      team->index, (unsigned long long)own, (unsigned long long)counts[0]);
  for (int i = 1; i < team->count && status == CONIC_OK; i++)
    status = counts[i] == own ? CONIC_OK : CONIC_ERROR_CANCELLED;
  return status;
}

/* Adds one direction's light to the sums of the receivers of items from `first_item` on. */
typedef struct sky_adding {
  const conic_map_room *room;
  const conic_light_map *map;
  size_t first_item;
  const unsigned char *reached; /* a bit for each of these receivers, from the process that drew the map; null: to be
                                   looked up here */
  float light[3];
  const conic_sky_sums *sums;
} sky_adding;

static size_t end_of_receivers(const conic_map_room *room, size_t begin) {
  size_t end = begin + CONIC_RECEIVED_TOGETHER;
  return end < room->receivers->count ? end : room->receivers->count;
}

static void add_sky_light(void *data, size_t i_item) {
  const sky_adding *a = data;
  const conic_sky_sums *sums = a->sums;
  const unsigned char *reached = a->reached ? a->reached + i_item * BYTES_OF_ITEM : NULL;
  float visible[CONIC_RECEIVED_TOGETHER], facing[CONIC_RECEIVED_TOGETHER];
  size_t begin = (a->first_item + i_item) * CONIC_RECEIVED_TOGETHER, count = end_of_receivers(a->room, begin) - begin;
  a->room->loops.receive(a->map, a->room->receivers, begin, begin + count, 0, visible, facing);
  for (size_t i = 0; i < count && reached; i++)
    visible[i] = reached[i / 8] >> i % 8 & 1 ? 1.0f : 0.0f;
  for (size_t i = 0; i < count; i++) {
    sums->facing[begin + i] += facing[i];
    sums->visible[begin + i] += facing[i] * visible[i];
  }
  for (int c = 0; c < 3 && sums->color[0]; c++)
    for (size_t i = 0; i < count; i++)
      sums->color[c][begin + i] += a->light[c] * (facing[i] * (sums->takes_hidden ? 1.0f - visible[i] : visible[i]));
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

/* The light from direction i. */
static void turn_to_direction(sky_walk *w, uint64_t i, double direction[3]) {
  double from_there[3];
  conic_sky_direction(w->options->sky, w->options->first_direction + i, direction, from_there);
  if (w->light)
    w->light(w->cookie, direction, from_there);
  for (int c = 0; c < 3; c++)
    w->adding.light[c] = (float)from_there[c];
}

static conic_status draw_direction(sky_walk *w, uint64_t i) {
  double direction[3];
  turn_to_direction(w, i, direction);
  conic_status status = conic_progress(w->room->context, "light", (double)i / (double)w->options->n_directions);
  return status == CONIC_OK ? conic_map_room_draw(w->room, direction, &w->map) : status;
}

static conic_status walk_alone(sky_walk *w) {
  conic_status status = CONIC_OK;
  for (uint64_t i = 0; i < w->options->n_directions && status == CONIC_OK; i++) {
    status = draw_direction(w, i);
    if (status == CONIC_OK)
      conic_parallel_for(w->room->context, w->n_items, add_sky_light, &w->adding);
  }
  return status;
}

/* --- by several processes --- */

/* Each process draws the map of one direction at a time, and looks up in its nearest texels which receivers the light
 * reaches. It sends every other process these answers as bits, for that process's receivers. Each process then adds the
 * light for its own receivers, in the order of the directions, on which sums of floats depend. */
typedef struct sky_team {
  sky_walk *walk;
  const conic_team *team;
  unsigned char *drawn;  /* of all receivers, by this process's map */
  unsigned char *theirs; /* of this process's receivers, by process */
} sky_team;

static size_t first_item(const sky_team *s, int index) {
  return (size_t)((uint64_t)s->walk->n_items * (uint64_t)index / (uint64_t)s->team->count);
}

static size_t count_items_of(const sky_team *s, int index) {
  return first_item(s, index + 1) - first_item(s, index);
}

static void look_into_map(void *data, size_t i_item) {
  const sky_team *s = data;
  const sky_walk *w = s->walk;
  unsigned char *reached = s->drawn + i_item * BYTES_OF_ITEM;
  float visible[CONIC_RECEIVED_TOGETHER], facing[CONIC_RECEIVED_TOGETHER];
  size_t begin = i_item * CONIC_RECEIVED_TOGETHER, end = end_of_receivers(w->room, begin);
  memset(reached, 0, BYTES_OF_ITEM);
  w->room->loops.receive(&w->map, w->room->receivers, begin, end, 0, visible, facing);
  for (size_t i = 0; i < end - begin; i++)
    reached[i / 8] |= (unsigned char)((visible[i] > 0.0f) << i % 8);
}

static conic_status draw_in_round(sky_team *s, uint64_t i) {
  sky_walk *w = s->walk;
  if (i >= w->options->n_directions)
    return CONIC_OK;
  w->room->sharing->i_map = i;
  conic_status status = draw_direction(w, i);
  if (status == CONIC_OK)
    conic_parallel_for(w->room->context, w->n_items, look_into_map, s);
  return status;
}

static void swap_bits(const sky_team *s) {
  const conic_team *team = s->team;
  size_t n_own = count_items_of(s, team->index) * BYTES_OF_ITEM;
  for (int round = 0; round < team->count; round++) {
    int partner = conic_team_partner(team, round);
    size_t n_received = 0;
    const unsigned char *bits = s->drawn + first_item(s, partner) * BYTES_OF_ITEM;
    unsigned char *to = s->theirs + n_own * (size_t)partner;
    if (partner == team->index) {
      memcpy(to, bits, n_own);
      continue;
    }
    void *theirs = conic_team_swap(team, partner, bits, count_items_of(s, partner) * BYTES_OF_ITEM, &n_received);
    if (n_own > 0)
      memcpy(to, theirs, n_own);
    team->release(team->data, theirs);
  }
}

/* A map in which nothing hides anything: gives how receivers face the light, without looking up. */
static void open_map(conic_light_map *map) {
  static const float nothing;
  map->z = &nothing;
  map->width = map->height = 1;
}

static void add_round(const sky_team *s, uint64_t first, uint64_t end) {
  sky_walk *w = s->walk;
  size_t n_items = count_items_of(s, s->team->index);
  w->adding.first_item = first_item(s, s->team->index);
  for (uint64_t i = first; i < end; i++) {
    conic_camera camera;
    double direction[3], near_z;
    turn_to_direction(w, i, direction);
    conic_light_map_place(w->room->casters, w->room->receivers, direction, w->room->texel, w->room->most_texels,
                          &camera, &near_z, &w->map);
    open_map(&w->map);
    w->adding.reached = s->theirs + n_items * BYTES_OF_ITEM * (size_t)(i - first);
    conic_parallel_for(w->room->context, n_items, add_sky_light, &w->adding);
  }
}

static conic_status walk_rounds(sky_team *s) {
  const conic_team *team = s->team;
  uint64_t n_directions = s->walk->options->n_directions, count = (uint64_t)team->count;
  conic_status status = conic_team_agree(team, s->drawn && s->theirs ? CONIC_OK : CONIC_ERROR_MEMORY);
  for (uint64_t first = 0; first < n_directions && status == CONIC_OK; first += count) {
    conic_moment start = conic_moment_now();
    status = conic_team_agree(team, draw_in_round(s, first + (uint64_t)team->index));
    if (status != CONIC_OK)
      return status;
    swap_bits(s);
    add_round(s, first, n_directions - first < count ? n_directions : first + count);
    conic_team_note(team, "direction", start, s->walk->room->receivers->count);
  }
  return status;
}

/* Brings every process's part of a sum to all. */
static void bring_sum(const sky_team *s, float *sum) {
  const conic_team *team = s->team;
  size_t sizes[CONIC_MOST_IN_TEAM], count = s->walk->room->receivers->count;
  size_t begin = first_item(s, team->index) * CONIC_RECEIVED_TOGETHER,
         end = first_item(s, team->index + 1) * CONIC_RECEIVED_TOGETHER;
  end = end < count ? end : count;
  void *all = team->collect(team->data, sum + begin, (end - begin) * sizeof *sum, sizes);
  memcpy(sum, all, count * sizeof *sum);
  team->release(team->data, all);
}

static conic_status walk_together(sky_walk *w) {
  conic_context *context = w->room->context;
  conic_light_sharing *sharing = w->room->sharing;
  const conic_sky_sums *sums = w->adding.sums;
  sky_team s = {.walk = w, .team = sharing->team};
  size_t n_own = count_items_of(&s, s.team->index);
  s.drawn = conic_memory_allocate(context, w->n_items, BYTES_OF_ITEM);
  s.theirs = conic_memory_allocate(context, n_own * (size_t)s.team->count, BYTES_OF_ITEM);
  sharing->is_apart = 1;
  conic_status status = walk_rounds(&s);
  sharing->is_apart = 0;
  sharing->i_map = w->options->n_directions;
  float *const all[] = {sums->facing, sums->visible, sums->color[0], sums->color[1], sums->color[2]};
  for (size_t i = 0; i < sizeof all / sizeof *all && status == CONIC_OK; i++)
    if (all[i])
      bring_sum(&s, all[i]);
  conic_memory_release_these(context, s.drawn, s.theirs);
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
  return room->sharing && !room->casters->lets_through ? walk_together(&walk) : walk_alone(&walk);
}

/* By the context's team, if it has one; its processes draw different maps. */
static conic_status find_visible(conic_map_room *room, const conic_lighting_options *options, float *ao) {
  conic_context *context = room->context;
  conic_light_sharing sharing = {.team = conic_context_join(context, NULL)};
  size_t n = room->receivers->count;
  conic_sky_sums sums = {.visible = ao};
  memset(ao, 0, n * sizeof *ao);
  sums.facing = conic_memory_allocate_zeroed(context, n, sizeof *sums.facing);
  room->sharing = sharing.team ? &sharing : NULL;
  conic_status status = conic_map_room_agree(room, sums.facing ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK)
    status = conic_sky_sums_add(room, options, NULL, NULL, &sums);
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    ao[i] = conic_sky_sums_share(&sums, i);
  conic_memory_release(context, sums.facing);
  room->sharing = NULL;
  if (status == CONIC_OK && sharing.team)
    conic_context_join(context, sharing.team);
  return status;
}

/* A surface sees half of all directions: for a splat without a normal, that much counts as all. */
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
