/* The receiving of lighting/light_map.h in plain C, which compilers put in lanes. */
#include <math.h>

#include "core/lanes/lanes.h"
#include "lighting/light_map.h"

/* A receiver as the map sees it. */
typedef struct received {
  float column, row;   /* in the map, in texels */
  float height, texel; /* its z from the map's distance on, and the length of a texel's edge there */
  float n[3];          /* the normal in the map's camera space; z is below 0 for a receiver that faces the light */
  float bias;
} received;

/* How much of the light of one texel's ray reaches the plane of the receiver. The depths are compared where that ray
 * meets the plane. So slopes do not hide themselves, and need no tolerance that would let light through at contacts. */
CONIC_INLINE float ray_reaches_plane(const conic_light_map *map, const received *r, float column, float row,
                                     int has_through) {
  float x = column > 0.0f ? column : 0.0f, y = row > 0.0f ? row : 0.0f;
  float last_x = (float)(map->width - 1), last_y = (float)(map->height - 1);
  x = x < last_x ? x : last_x;
  y = y < last_y ? y : last_y;
  int i_texel = (int)y * map->width + (int)x;
  float z = map->z[i_texel], through = has_through ? map->through[i_texel] : 1.0f;
  float to_x = r->column - (x + 0.5f), to_y = r->row - (y + 0.5f);
  float ray_x = ((x + 0.5f) - map->center_x) * map->angle, ray_y = ((y + 0.5f) - map->center_y) * map->angle;
  float along = (r->n[0] * ray_x + r->n[1] * ray_y) + r->n[2];
  along = along < -CONIC_LIGHT_MAP_GRAZING ? along : -CONIC_LIGHT_MAP_GRAZING;
  float plane = r->height + r->texel * ((r->n[0] * to_x + r->n[1] * to_y) / along);
  int is_nearer = (z > 0.0f) & ((z - map->distance) + r->bias < plane);
  return is_nearer ? 0.0f : through;
}

CONIC_INLINE float nearest_texel(const conic_light_map *map, const received *r, int has_through) {
  return ray_reaches_plane(map, r, (float)(int)r->column, (float)(int)r->row, has_through);
}

CONIC_INLINE float four_texels(const conic_light_map *map, const received *r, int has_through) {
  float x = r->column + 0.5f, y = r->row + 0.5f; /* at least 0.5, so that cutting off is rounding down */
  float left = (float)(int)x - 1.0f, top = (float)(int)y - 1.0f;
  float right_part = x - (left + 1.0f), bottom_part = y - (top + 1.0f);
  float above = ray_reaches_plane(map, r, left, top, has_through) * (1.0f - right_part) +
                ray_reaches_plane(map, r, left + 1.0f, top, has_through) * right_part;
  float below = ray_reaches_plane(map, r, left, top + 1.0f, has_through) * (1.0f - right_part) +
                ray_reaches_plane(map, r, left + 1.0f, top + 1.0f, has_through) * right_part;
  return above * (1.0f - bottom_part) + below * bottom_part;
}

CONIC_INLINE float clamp_to_map(float place, int size) {
  float last = (float)size;
  place = place > 0.0f ? place : 0.0f;
  return place < last ? place : last;
}

/* How far, along a ray, the map's depth may be off its surface; `slope` is the tangent of the slope. */
CONIC_INLINE float bias_of(const conic_light_map *map, float texel, float slope) {
  return (map->flat_epsilon + texel * CONIC_LIGHT_MAP_FLAT) + (map->epsilon + texel) * (CONIC_LIGHT_MAP_SLOPE * slope);
}

/* How the receiver faces the parallel rays of a map, and its tolerance along them. */
CONIC_INLINE float face_sun(const conic_light_map *map, received *r) {
  float cosine = -r->n[2], flat = cosine > CONIC_LIGHT_MAP_GRAZING ? cosine : CONIC_LIGHT_MAP_GRAZING;
  float slope = sqrtf(r->n[0] * r->n[0] + r->n[1] * r->n[1]) / flat;
  r->bias = bias_of(map, r->texel, slope);
  return cosine;
}

/* The same for the ray to `at`, which is longer than its z. */
CONIC_INLINE float face_lamp(const conic_light_map *map, const float at[3], received *r) {
  float distance = sqrtf((at[0] * at[0] + at[1] * at[1]) + at[2] * at[2]);
  float cosine = -((r->n[0] * at[0] + r->n[1] * at[1]) + r->n[2] * at[2]) / distance;
  float flat = cosine > CONIC_LIGHT_MAP_GRAZING ? cosine : CONIC_LIGHT_MAP_GRAZING;
  float square = 1.0f - cosine * cosine, slope = sqrtf(square > 0.0f ? square : 0.0f) / flat;
  r->bias = bias_of(map, r->texel, slope) * (at[2] / distance);
  return cosine;
}

CONIC_INLINE void receive_one(const conic_light_map *map, const conic_receivers *from, size_t i, int is_smooth,
                              int is_lamp, int has_through, float *visible, float *facing) {
  float p[3] = {from->position[0][i], from->position[1][i], from->position[2][i]};
  float n[3] = {from->normal[0][i], from->normal[1][i], from->normal[2][i]};
  float at[3];
  received r;
  for (int axis = 0; axis < 3; axis++) {
    const float *row = map->rotation[axis];
    at[axis] = (row[0] * p[0] + row[1] * p[1]) + row[2] * p[2];
    r.n[axis] = (row[0] * n[0] + row[1] * n[1]) + row[2] * n[2];
  }
  int has_none = (n[0] == 0.0f) & (n[1] == 0.0f) & (n[2] == 0.0f);
  r.n[2] = has_none ? -1.0f : r.n[2];
  float z = map->distance + at[2], scale = map->focal / z;
  r.column = clamp_to_map(at[0] * scale + map->center_x, map->width);
  r.row = clamp_to_map(at[1] * scale + map->center_y, map->height);
  r.height = at[2];
  r.texel = z * map->angle;
  float cosine = is_lamp ? face_lamp(map, at, &r) : face_sun(map, &r);
  float seen = is_smooth ? four_texels(map, &r, has_through) : nearest_texel(map, &r, has_through);
  *visible = cosine > 0.0f ? seen : 0.0f;
  *facing = cosine > 0.0f ? cosine : 0.0f;
}

static void receive(const conic_light_map *map, const conic_receivers *receivers, size_t begin, size_t end,
                    int is_smooth, float *restrict visible, float *restrict facing) {
  const conic_light_map m = *map;
  const conic_receivers from = *receivers;
  if (m.through)
    for (size_t i = begin; i < end; i++)
      receive_one(&m, &from, i, is_smooth || m.is_lamp, m.is_lamp, 1, &visible[i - begin], &facing[i - begin]);
  else if (m.is_lamp)
    for (size_t i = begin; i < end; i++)
      receive_one(&m, &from, i, 1, 1, 0, &visible[i - begin], &facing[i - begin]);
  else if (is_smooth)
    for (size_t i = begin; i < end; i++)
      receive_one(&m, &from, i, 1, 0, 0, &visible[i - begin], &facing[i - begin]);
  else
    for (size_t i = begin; i < end; i++)
      receive_one(&m, &from, i, 0, 0, 0, &visible[i - begin], &facing[i - begin]);
}
