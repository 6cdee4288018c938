/* What gaussians/draw/ray_meetings.h says, in lanes. */
#pragma once

#include "core/lanes/lanes.h"
#include "gaussians/draw/gaussian_tile.h"

typedef struct meeting_lanes {
  lanes half_q, z, opacity; /* half_q below 0: nowhere; the opacity is that of CONIC_SHAPE_FILTERED */
} meeting_lanes;

#ifndef CONIC_ON_DEVICE /* which draws neither */

CONIC_INLINE lanes lanes_dot_of_self(const lanes a[3]) {
  return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

CONIC_INLINE meeting_lanes meet_filtered_lanes(const conic_gaussian_list *list, uint32_t i_footprint, lanes dx,
                                               lanes dy) {
  const conic_gaussian_ray *r = &list->rays[i_footprint];
  const conic_gaussian_filter *f = &list->filters[i_footprint];
  lanes g[3], c[3], by_x[3], by_y[3];
  for (int k = 0; k < 3; k++) {
    g[k] = r->g[0][k] + r->g[1][k] * dx + r->g[2][k] * dy;
    c[k] = r->c[0][k] + r->c[1][k] * dx + r->c[2][k] * dy;
    by_x[k] = f->x[k] - f->both[k] * dy;
    by_y[k] = f->y[k] + f->both[k] * dx;
  }
  lanes squares = lanes_dot_of_self(g), one_over = 1.0f / squares;
  lanes z = (r->e[0] + r->e[1] * dx + r->e[2] * dy) * one_over;
  lanes t = (list->is_parallel ? lanes_of(1.0f) : z * z) * one_over, area = t * f->area;
  lanes turn_x = f->turn[0] - f->turn[2] * dy, turn_y = f->turn[1] + f->turn[2] * dx;
  lanes S = 1.0f + (t * (lanes_dot_of_self(by_x) + lanes_dot_of_self(by_y)) + area * area * squares);
  lanes q = (lanes_dot_of_self(c) * one_over + t * (turn_x * turn_x + turn_y * turn_y)) / S;
  return (meeting_lanes){lanes_select(lanes_less(lanes_of(0.0f), squares), 0.5f * q, lanes_of(-1.0f)), z,
                         list->footprints[i_footprint].opacity / lanes_sqrt(S)};
}

CONIC_INLINE meeting_lanes meet_sight_lanes(const conic_gaussian_list *list, uint32_t i_footprint, size_t at) {
  const conic_gaussian_sight *r = &list->sights[i_footprint];
  const conic_sight_rays *rays = list->tile_rays;
  lanes d[3], g[3], c[3];
  for (int k = 0; k < 3; k++)
    d[k] = (lanes_load(&rays->high[k][at]) - r->high[k]) + (lanes_load(&rays->low[k][at]) - r->low[k]);
  for (int k = 0; k < 3; k++) {
    g[k] = r->g[k][0] + r->g[k][1] * d[0] + r->g[k][2] * d[1] + r->g[k][3] * d[2];
    c[k] = r->c[k][0] + r->c[k][1] * d[0] + r->c[k][2] * d[1] + r->c[k][3] * d[2];
  }
  lanes e = r->e[0] + r->e[1] * d[0] + r->e[2] * d[1] + r->e[3] * d[2];
  if (r->unit > 0.0f) {
    lanes o[3], a[3];
    for (int k = 0; k < 3; k++)
      o[k] = (lanes_load(&rays->origin_high[k][at]) - r->origin_high[k]) +
             (lanes_load(&rays->origin_low[k][at]) - r->origin_low[k]);
    for (int k = 0; k < 3; k++)
      a[k] = r->g[k][1] * o[0] + r->g[k][2] * o[1] + r->g[k][3] * o[2];
    for (int k = 0; k < 3; k++)
      c[k] = c[k] - r->unit * (g[(k + 1) % 3] * a[(k + 2) % 3] - g[(k + 2) % 3] * a[(k + 1) % 3]);
    e = e - (g[0] * a[0] + g[1] * a[1] + g[2] * a[2]);
  }
  lanes squares = lanes_dot_of_self(g), one_over = 1.0f / squares;
  lanes half_q = 0.5f * (lanes_dot_of_self(c) * one_over);
  return (meeting_lanes){.half_q = lanes_select(lanes_less(lanes_of(0.0f), squares), half_q, lanes_of(-1.0f)),
                         .z = e * one_over};
}

#endif
