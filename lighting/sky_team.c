#include "lighting/sky_team.h"

#include <string.h>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/threads.h"

/* At a time each process has drawn one direction, which all receivers have a facing and a visible part of; of their own
 * receivers processes then get those of all directions. */
typedef struct sky_team {
  conic_map_room *room;
  const conic_lighting_options *options;
  const conic_team *team;
  conic_light_map map;
  float *drawn;    /* facing, then visible, by receiver */
  float *received; /* by process of the team the same of this one's receivers */
  float *packed;   /* what is sent to one */
  float *facing;   /* of this one's receivers, like the next: the sums */
  float *visible;
} sky_team;

static size_t first_receiver(const sky_team *s, int index) {
  return (size_t)((uint64_t)s->room->receivers->count * (uint64_t)index / (uint64_t)s->team->count);
}

static size_t count_receivers_of(const sky_team *s, int index) {
  return first_receiver(s, index + 1) - first_receiver(s, index);
}

static void receive_drawn(void *data, size_t i_item, int i_thread) {
  const sky_team *s = data;
  const conic_receivers *receivers = s->room->receivers;
  size_t begin = i_item * CONIC_RECEIVED_TOGETHER, n = receivers->count - begin;
  float *facing = s->drawn + begin, *visible = s->drawn + receivers->count + begin;
  n = n < CONIC_RECEIVED_TOGETHER ? n : CONIC_RECEIVED_TOGETHER;
  (void)i_thread;
  s->room->kernels.receive(&s->map, receivers, begin, begin + n, 0, visible, facing);
  for (size_t i = 0; i < n; i++)
    visible[i] *= facing[i];
}

static conic_status draw_direction(sky_team *s, uint64_t i) {
  conic_context *context = s->room->context;
  double direction[3], light[3];
  conic_sky_direction(s->options->sky, s->options->first_direction + i, direction, light);
  conic_status status = conic_progress(context, "light", (double)i / (double)s->options->n_directions);
  if (status == CONIC_OK)
    status = conic_map_room_draw(s->room, direction, &s->map);
  if (status == CONIC_OK)
    conic_parallel_for(context, (s->room->receivers->count + CONIC_RECEIVED_TOGETHER - 1) / CONIC_RECEIVED_TOGETHER,
                       receive_drawn, s);
  return status;
}

/* Gives every process its receivers' part of what was drawn here, and takes this one's of what they drew. */
static void swap_drawn(sky_team *s) {
  const conic_team *team = s->team;
  size_t n_all = s->room->receivers->count, n_own = count_receivers_of(s, team->index);
  for (int round = 0; round < team->count; round++) {
    int partner = conic_team_partner(team, round);
    size_t n = count_receivers_of(s, partner), n_bytes = 0;
    memcpy(s->packed, s->drawn + first_receiver(s, partner), n * sizeof(float));
    memcpy(s->packed + n, s->drawn + n_all + first_receiver(s, partner), n * sizeof(float));
    float *to = s->received + 2 * n_own * (size_t)partner;
    if (partner == team->index) {
      memcpy(to, s->packed, 2 * n * sizeof(float));
      continue;
    }
    void *theirs = conic_team_swap(team, partner, s->packed, 2 * n * sizeof(float), &n_bytes);
    memcpy(to, theirs, 2 * n_own * sizeof(float));
    team->release(team->data, theirs);
  }
}

/* In the order of the directions, as sums of floats depend on it. */
static void add_received(sky_team *s, int n_drawn) {
  size_t n = count_receivers_of(s, s->team->index);
  for (int i = 0; i < n_drawn; i++) {
    const float *facing = s->received + 2 * n * (size_t)i, *visible = facing + n;
    for (size_t k = 0; k < n; k++) {
      s->facing[k] += facing[k];
      s->visible[k] += visible[k];
    }
  }
}

/* All directions, as many at a time as there are processes. */
static conic_status add_directions(sky_team *s) {
  const conic_team *team = s->team;
  uint64_t n_directions = s->options->n_directions, count = (uint64_t)team->count;
  conic_status status = CONIC_OK;
  for (uint64_t first = 0; first < n_directions && status == CONIC_OK; first += count) {
    uint64_t i = first + (uint64_t)team->index;
    double start = conic_seconds_now();
    status = conic_team_agree(team, i < n_directions ? draw_direction(s, i) : CONIC_OK);
    if (status != CONIC_OK)
      return status;
    swap_drawn(s);
    add_received(s, (int)(n_directions - first < count ? n_directions - first : count));
    conic_team_note(team, "direction", start, s->room->receivers->count);
  }
  return status;
}

static void bring_visible(const sky_team *s, float *visible) {
  const conic_team *team = s->team;
  const conic_sky_sums sums = {.facing = s->facing, .visible = s->visible};
  size_t sizes[CONIC_MOST_IN_TEAM], n = count_receivers_of(s, team->index);
  for (size_t i = 0; i < n; i++)
    s->packed[i] = conic_sky_sums_share(&sums, i);
  void *all = team->collect(team->data, s->packed, n * sizeof(float), sizes);
  memcpy(visible, all, s->room->receivers->count * sizeof *visible);
  team->release(team->data, all);
}

conic_status conic_sky_share_visible(conic_map_room *room, const conic_lighting_options *options,
                                     const conic_team *team, float *visible) {
  conic_context *context = room->context;
  sky_team s = {.room = room, .options = options, .team = team};
  size_t n_all = room->receivers->count, n_own = count_receivers_of(&s, team->index),
         most = n_all / (size_t)team->count + 1;
  s.drawn = conic_memory_allocate_zeroed(context, 2 * n_all, sizeof(float));
  s.received = conic_memory_allocate(context, 2 * n_own, (size_t)team->count * sizeof(float));
  s.packed = conic_memory_allocate(context, 2 * most, sizeof(float));
  s.facing = conic_memory_allocate_zeroed(context, 2 * n_own, sizeof(float));
  s.visible = s.facing ? s.facing + n_own : NULL;
  conic_status status = s.drawn && s.received && s.packed && s.facing ? CONIC_OK : CONIC_ERROR_MEMORY;
  status = conic_team_agree(team, status);
  if (status == CONIC_OK)
    status = add_directions(&s);
  if (status == CONIC_OK)
    bring_visible(&s, visible);
  conic_memory_release(context, s.drawn);
  conic_memory_release(context, s.received);
  conic_memory_release(context, s.packed);
  conic_memory_release(context, s.facing);
  return status;
}
