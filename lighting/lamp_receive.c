/* The part of a lamp's light that nothing hides: many receivers at a time, with one map for each side. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/threads.h"
#include "lighting/lamp_map.h"
#include "lighting/lamps.h"

/* A thread takes so many receivers at a time, and copies them with positions measured from the lamp. */
enum { TOGETHER = 512 };

typedef struct lamp_receiving {
  const conic_map_room *room;
  double from_origin[3]; /* from the receivers' origin to the lamp */
  unsigned char *side;   /* of each receiver */
  conic_lamp_side (*of_items)[CONIC_LAMP_SIDES];
  int i_side; /* the current one */
  const conic_light_map *map;
  float *visible;
} lamp_receiving;

static void take_position(const lamp_receiving *work, size_t i, float position[3]) {
  for (int axis = 0; axis < 3; axis++)
    position[axis] = (float)((double)work->room->receivers->position[axis][i] - work->from_origin[axis]);
}

static size_t end_of_item(const lamp_receiving *work, size_t i_item) {
  size_t end = (i_item + 1) * TOGETHER, count = work->room->receivers->count;
  return end < count ? end : count;
}

static void find_sides(void *data, size_t i_item, int i_thread) {
  const lamp_receiving *work = data;
  conic_lamp_side *sides = work->of_items[i_item];
  (void)i_thread;
  for (int i = 0; i < CONIC_LAMP_SIDES; i++)
    conic_lamp_side_init(&sides[i]);
  for (size_t i = i_item * TOGETHER; i < end_of_item(work, i_item); i++) {
    float position[3];
    take_position(work, i, position);
    int side = conic_lamp_side_of(position);
    conic_lamp_side_add(&sides[side], side, position);
    work->side[i] = (unsigned char)side;
    work->visible[i] = 0.0f;
  }
}

static void receive_side(void *data, size_t i_item, int i_thread) {
  const lamp_receiving *work = data;
  const conic_receivers *from = work->room->receivers;
  float columns[6][TOGETHER], visible[TOGETHER], facing[TOGETHER];
  conic_receivers near_lamp = {.position = {columns[0], columns[1], columns[2]},
                               .normal = {columns[3], columns[4], columns[5]}};
  size_t places[TOGETHER], n = 0;
  (void)i_thread;
  if (work->of_items[i_item][work->i_side].count == 0)
    return;
  for (size_t i = i_item * TOGETHER; i < end_of_item(work, i_item); i++) {
    float position[3];
    if (work->side[i] != work->i_side)
      continue;
    take_position(work, i, position);
    for (int axis = 0; axis < 3; axis++) {
      columns[axis][n] = position[axis];
      columns[3 + axis][n] = from->normal[axis][i];
    }
    places[n++] = i;
  }
  work->room->loops.receive(work->map, &near_lamp, 0, n, 1, visible, facing);
  for (size_t i = 0; i < n; i++)
    work->visible[places[i]] = visible[i];
}

static conic_status receive_sides(lamp_receiving *work, conic_map_room *room, const conic_lamp_point *point,
                                  size_t n_items) {
  conic_light_map map;
  conic_status status = CONIC_OK;
  conic_parallel_for(room->context, n_items, find_sides, work);
  for (int i = 0; i < CONIC_LAMP_SIDES && status == CONIC_OK; i++) {
    conic_lamp_side side;
    conic_camera camera;
    double near_z;
    conic_lamp_side_init(&side);
    for (size_t item = 0; item < n_items; item++)
      conic_lamp_side_join(&side, &work->of_items[item][i]);
    if (side.count == 0)
      continue;
    conic_lamp_map_place(room->casters->epsilon, point->place, i, &side, room->texel, room->most_texels, &camera,
                         &near_z, &map);
    work->i_side = i;
    work->map = &map;
    status = conic_map_room_fill(room, &camera, near_z, &map);
    if (status == CONIC_OK)
      conic_parallel_for(room->context, n_items, receive_side, work);
  }
  return status;
}

conic_status conic_lamp_receive(conic_map_room *room, const conic_lamp_point *point, float *visible) {
  size_t count = room->receivers->count, n_items = (count + TOGETHER - 1) / TOGETHER;
  lamp_receiving work = {.room = room, .visible = visible};
  if (count == 0)
    return CONIC_OK;
  for (int axis = 0; axis < 3; axis++)
    work.from_origin[axis] = point->place[axis] - room->receivers->origin[axis];
  work.side = conic_memory_allocate(room->context, count, 1);
  work.of_items = conic_memory_allocate(room->context, n_items, sizeof *work.of_items);
  conic_status status = work.side && work.of_items ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = receive_sides(&work, room, point, n_items);
  conic_memory_release_these(room->context, work.of_items, work.side);
  return status;
}
