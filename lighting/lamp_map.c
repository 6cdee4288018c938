#include "lighting/lamp_map.h"

#include <math.h>
#include <string.h>

#include "core/base/vectors.h"

int conic_lamp_side_of(const float position[3]) {
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

void conic_lamp_side_init(conic_lamp_side *side) {
  *side = (conic_lamp_side){.low = {HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL}, .nearest = HUGE_VAL};
}

void conic_lamp_side_add(conic_lamp_side *side, int i_side, const float position[3]) {
  const double p[3] = {(double)position[0], (double)position[1], (double)position[2]};
  double rows[3][3];
  rows_of_side(i_side, rows);
  double z = conic_dot(rows[2], p);
  if (!(z > 0.0))
    return;
  for (int i = 0; i < 2; i++) {
    double place = conic_dot(rows[i], p) / z;
    side->low[i] = place < side->low[i] ? place : side->low[i];
    side->high[i] = place > side->high[i] ? place : side->high[i];
  }
  side->nearest = z < side->nearest ? z : side->nearest;
  side->farthest = z > side->farthest ? z : side->farthest;
  side->sum_z += z;
  side->count++;
}

void conic_lamp_side_join(conic_lamp_side *side, const conic_lamp_side *other) {
  for (int i = 0; i < 2; i++) {
    side->low[i] = other->low[i] < side->low[i] ? other->low[i] : side->low[i];
    side->high[i] = other->high[i] > side->high[i] ? other->high[i] : side->high[i];
  }
  side->nearest = other->nearest < side->nearest ? other->nearest : side->nearest;
  side->farthest = other->farthest > side->farthest ? other->farthest : side->farthest;
  side->sum_z += other->sum_z;
  side->count += other->count;
}

/* The near distance of a side. Splats that practically contain the lamp do not hide anything; and floats cannot tell
 * smaller distances apart. */
static double near_of_side(double epsilon, const conic_lamp_side *side) {
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

void conic_lamp_map_place(double epsilon, const double place[3], int i_side, const conic_lamp_side *side, double texel,
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
