/* Where rays meet Gaussians in plain C: under a filter, and of cameras whose rays are not affine on the screen. */
#pragma once

#include <math.h>

#include "gaussians/draw/gaussian_tile.h"

typedef struct conic_ray_meeting {
  float half_q, z, opacity; /* half_q below 0: nowhere */
} conic_ray_meeting;

static inline float conic_square_of(const float a[3]) {
  return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

/* The order of operations here is that of docs/reference/gaussians.md. */
static inline conic_ray_meeting conic_meet_filtered(const conic_gaussian_list *list, uint32_t i_footprint, int x,
                                                    int y) {
  const conic_gaussian_footprint *at = &list->footprints[i_footprint];
  const conic_gaussian_ray *r = &list->rays[i_footprint];
  const conic_gaussian_filter *f = &list->filters[i_footprint];
  float dx = (float)(x - at->x), dy = (float)(y - at->y), g[3], c[3], by_x[3], by_y[3];
  for (int k = 0; k < 3; k++) {
    g[k] = r->g[0][k] + r->g[1][k] * dx + r->g[2][k] * dy;
    c[k] = r->c[0][k] + r->c[1][k] * dx + r->c[2][k] * dy;
    by_x[k] = f->x[k] - f->both[k] * dy;
    by_y[k] = f->y[k] + f->both[k] * dx;
  }
  float squares = conic_square_of(g), one_over = 1.0f / squares;
  float z = (r->e[0] + r->e[1] * dx + r->e[2] * dy) * one_over, t = (list->is_parallel ? 1.0f : z * z) * one_over;
  float turn_x = f->turn[0] - f->turn[2] * dy, turn_y = f->turn[1] + f->turn[2] * dx, area = t * f->area;
  float S = 1.0f + (t * (conic_square_of(by_x) + conic_square_of(by_y)) + area * area * squares);
  float q = (conic_square_of(c) * one_over + t * (turn_x * turn_x + turn_y * turn_y)) / S;
  return (conic_ray_meeting){squares > 0.0f ? 0.5f * q : -1.0f, z, at->opacity / sqrtf(S)};
}

/* The order of operations here is that of docs/reference/gaussians.md. */
static inline conic_ray_meeting conic_meet_sight(const conic_gaussian_list *list, uint32_t i_footprint, size_t at) {
  const conic_gaussian_sight *r = &list->sights[i_footprint];
  const conic_sight_rays *rays = list->tile_rays;
  float d[3], g[3], c[3];
  for (int k = 0; k < 3; k++)
    d[k] = (rays->high[k][at] - r->high[k]) + (rays->low[k][at] - r->low[k]);
  for (int k = 0; k < 3; k++) {
    g[k] = r->g[k][0] + r->g[k][1] * d[0] + r->g[k][2] * d[1] + r->g[k][3] * d[2];
    c[k] = r->c[k][0] + r->c[k][1] * d[0] + r->c[k][2] * d[1] + r->c[k][3] * d[2];
  }
  float e = r->e[0] + r->e[1] * d[0] + r->e[2] * d[1] + r->e[3] * d[2];
  if (r->unit > 0.0f) {
    float o[3], a[3];
    for (int k = 0; k < 3; k++)
      o[k] = (rays->origin_high[k][at] - r->origin_high[k]) + (rays->origin_low[k][at] - r->origin_low[k]);
    for (int k = 0; k < 3; k++)
      a[k] = r->g[k][1] * o[0] + r->g[k][2] * o[1] + r->g[k][3] * o[2];
    for (int k = 0; k < 3; k++)
      c[k] -= r->unit * (g[(k + 1) % 3] * a[(k + 2) % 3] - g[(k + 2) % 3] * a[(k + 1) % 3]);
    e -= g[0] * a[0] + g[1] * a[1] + g[2] * a[2];
  }
  float squares = conic_square_of(g), one_over = 1.0f / squares, half_q = 0.5f * (conic_square_of(c) * one_over);
  return (conic_ray_meeting){squares > 0.0f ? half_q : -1.0f, e * one_over, list->footprints[i_footprint].opacity};
}
