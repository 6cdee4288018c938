/* The part of a lamp's light that nothing hides: many receivers at a time, with one map for each side. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/threads.h"
#include "core/base/vectors.h"
#include "lighting/lamps.h"

/* --- the six sides of the cube that a lamp sees, and the map of each --- */

enum { LAMP_SIDES = 6, NO_SIDE = 6 };

/* The extent of the points on side 2·axis, or 2·axis + 1 towards lower coordinates. */
typedef struct lamp_side {
  size_t count;
  double low[2], high[2]; /* of x/z and y/z in the side's camera space */
  double nearest, farthest, sum_z;
} lamp_side;

/* The side that a point is on; positions are measured from the lamp's place. */
static int lamp_side_of(const float position[3]) {
  int axis = 0;
  for (int i = 1; i < 3; i++)
    if (fabsf(position[i]) > fabsf(position[axis]))
      axis = i;
  return 2 * axis + (position[axis] < 0.0f);
}

/* The side's camera looks along the side's axis, with the next axis to the right. */
static void rows_of_side(int i_side, double rows[3][3]) {
  int axis = i_side / 2;
  memset(rows, 0, 9 * sizeof(double));
  rows[2][axis] = i_side % 2 ? -1.0 : 1.0;
  rows[0][(axis + 1) % 3] = 1.0;
  conic_cross(rows[2], rows[0], rows[1]);
}

static void lamp_side_init(lamp_side *side) {
  *side = (lamp_side){.low = {HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL}, .nearest = HUGE_VAL};
}

/* Adds a point that lies on the side. */
static void lamp_side_add(lamp_side *side, int i_side, const float position[3]) {
  const double p[3] = {(double)position[0], (double)position[1], (double)position[2]};
  double rows[3][3];
  rows_of_side(i_side, rows);
  double z = conic_dot(rows[2], p);
  if (!(z > 0.0))
    return;
  for (int i = 0; i < 2; i++) {
    double place = conic_dot(rows[i], p) / z;
    CONIC_WIDEN(side->low[i], side->high[i], place, place);
  }
  CONIC_WIDEN(side->nearest, side->farthest, z, z);
  side->sum_z += z;
  side->count++;
}

/* Adds the extent of another. */
static void lamp_side_join(lamp_side *side, const lamp_side *other) {
  for (int i = 0; i < 2; i++)
    CONIC_WIDEN(side->low[i], side->high[i], other->low[i], other->high[i]);
  CONIC_WIDEN(side->nearest, side->farthest, other->nearest, other->farthest);
  side->sum_z += other->sum_z;
  side->count += other->count;
}

/* The near distance of a side. Splats that practically contain the lamp do not hide anything; and floats cannot tell
 * smaller distances apart. */
static double near_of_side(double epsilon, const lamp_side *side) {
  double smallest = 1e-4 * side->farthest, near_z = epsilon > smallest ? epsilon : smallest;
  near_z = near_z < 0.5 * side->nearest ? near_z : 0.5 * side->nearest;
  return near_z > 1e-7 * side->farthest ? near_z : 1e-7 * side->farthest;
}

/* One edge of the map: its number of texels, and the place of its middle. Two texels on each side are beyond all
 * points. */
static int set_edge(double low, double high, double focal, int most, double *center) {
  double texels = (high - low) * focal + 4.0;
  int n = texels < (double)most ? (int)ceil(texels) : most;
  *center = 0.5 * (double)n - 0.5 * (low + high) * focal;
  return n;
}

/* Places a map for all points on a side, at least one, of a lamp in the world; leaves map->z. `texel` is in world
 * units, at the points' mean z; it grows where the map would be larger than `most`. */
static void lamp_map_place(double epsilon, const double place[3], int i_side, const lamp_side *side, double texel,
                           int most, conic_camera *camera, double *near_z, conic_light_map *map) {
  double rows[3][3], x = side->high[0] - side->low[0], y = side->high[1] - side->low[1], widest = x > y ? x : y;
  double focal = side->sum_z / (double)side->count / texel, most_texels = (double)(most - 4);
  focal = widest * focal > most_texels ? most_texels / widest : focal;
  memset(camera, 0, sizeof *camera);
  memset(map, 0, sizeof *map);
  camera->fx = camera->fy = focal;
  camera->width = map->width = set_edge(side->low[0], side->high[0], focal, most, &camera->cx);
  camera->height = map->height = set_edge(side->low[1], side->high[1], focal, most, &camera->cy);
  rows_of_side(i_side, rows);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      camera->cam_from_world[i][j] = rows[i][j];
      map->rotation[i][j] = (float)rows[i][j];
    }
    camera->cam_from_world[i][3] = -conic_dot(rows[i], place);
  }
  *near_z = near_of_side(epsilon, side);
  map->is_lamp = 1;
  map->focal = (float)focal;
  map->angle = (float)(1.0 / focal);
  map->center_x = (float)camera->cx;
  map->center_y = (float)camera->cy;
}

/* --- what splats receive --- */

/* A thread takes so many receivers at a time, and copies them with positions measured from the lamp. */
enum { TOGETHER = 512 };

typedef struct lamp_receiving {
  const conic_map_room *room;
  double from_origin[3]; /* from the receivers' origin to the lamp */
  unsigned char *side;   /* of each receiver */
  lamp_side (*of_items)[LAMP_SIDES];
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

static void find_sides(void *data, size_t i_item) {
  const lamp_receiving *work = data;
  lamp_side *sides = work->of_items[i_item];
  for (int i = 0; i < LAMP_SIDES; i++)
    lamp_side_init(&sides[i]);
  for (size_t i = i_item * TOGETHER; i < end_of_item(work, i_item); i++) {
    float position[3];
    take_position(work, i, position);
    int side = lamp_side_of(position);
    lamp_side_add(&sides[side], side, position);
    work->side[i] = (unsigned char)side;
    work->visible[i] = 0.0f;
  }
}

static void receive_side(void *data, size_t i_item) {
  const lamp_receiving *work = data;
  const conic_receivers *from = work->room->receivers;
  float columns[6][TOGETHER], visible[TOGETHER], facing[TOGETHER];
  conic_receivers near_lamp = {.position = {columns[0], columns[1], columns[2]},
                               .normal = {columns[3], columns[4], columns[5]}};
  size_t places[TOGETHER], n = 0;
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
  for (int i = 0; i < LAMP_SIDES && status == CONIC_OK; i++) {
    lamp_side side;
    conic_camera camera;
    double near_z;
    lamp_side_init(&side);
    for (size_t item = 0; item < n_items; item++)
      lamp_side_join(&side, &work->of_items[item][i]);
    if (side.count == 0)
      continue;
    lamp_map_place(room->casters->epsilon, point->place, i, &side, room->texel, room->most_texels, &camera, &near_z,
                   &map);
    work->i_side = i;
    work->map = &map;
    status = conic_map_room_fill(room, &camera, near_z, &map);
    if (status == CONIC_OK)
      conic_parallel_for(room->context, n_items, receive_side, work);
    work->map = NULL;
  }
  return status;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): threads write to it */
conic_status conic_lamp_receive(conic_map_room *room, const conic_lamp_point *point, float *visible) {
  size_t count = room->receivers->count, n_items = (count + TOGETHER - 1) / TOGETHER;
  lamp_receiving work = {.room = room, .visible = visible};
  if (count == 0)
    return CONIC_OK;
  for (int axis = 0; axis < 3; axis++)
    work.from_origin[axis] = point->place[axis] - room->receivers->origin[axis];
  conic_status status =
      conic_memory_allocate_these(room->context, CONIC_ROOM(work.side, count), CONIC_ROOM(work.of_items, n_items));
  if (status == CONIC_OK)
    status = receive_sides(&work, room, point, n_items);
  conic_memory_release_these(room->context, work.of_items, work.side);
  return status;
}
