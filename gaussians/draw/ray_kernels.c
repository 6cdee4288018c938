/* Filtered rays, and rays of any camera, in plain C: docs/reference/gaussians.md. */
#include "gaussians/draw/ray_kernels.h"

#include <math.h>

#include "core/splats/kernel.h"

CONIC_DEFINE_KERNELS(conic_ray_kernels)

typedef struct filtered {
  float half_q, z, opacity;
} filtered;

static float dot_of_floats(const float a[3]) {
  return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

/* The order of operations here is that of docs/reference/gaussians.md. */
static filtered meet_filtered(const conic_gaussian_list *list, uint32_t i_footprint, int x, int y) {
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
  float squares = dot_of_floats(g), one_over = 1.0f / squares;
  float z = (r->e[0] + r->e[1] * dx + r->e[2] * dy) * one_over, t = (list->is_parallel ? 1.0f : z * z) * one_over;
  float turn_x = f->turn[0] - f->turn[2] * dy, turn_y = f->turn[1] + f->turn[2] * dx, area = t * f->area;
  float S = 1.0f + (t * (dot_of_floats(by_x) + dot_of_floats(by_y)) + area * area * squares);
  float q = (dot_of_floats(c) * one_over + t * (turn_x * turn_x + turn_y * turn_y)) / S;
  return (filtered){squares > 0.0f ? 0.5f * q : -1.0f, z, at->opacity / sqrtf(S)};
}

/* The order of operations here is that of docs/reference/gaussians.md. */
static filtered meet_seen(const conic_gaussian_list *list, uint32_t i_footprint, size_t at) {
  const conic_gaussian_sight *r = &list->sights[i_footprint];
  const conic_tile_rays *rays = list->tile_rays;
  float d[3], g[3], c[3];
  for (int k = 0; k < 3; k++)
    d[k] = (rays->high[k][at] - r->high[k]) + (rays->low[k][at] - r->low[k]);
  for (int k = 0; k < 3; k++) {
    g[k] = r->g[k][0] + r->g[k][1] * d[0] + r->g[k][2] * d[1] + r->g[k][3] * d[2];
    c[k] = r->c[k][0] + r->c[k][1] * d[0] + r->c[k][2] * d[1] + r->c[k][3] * d[2];
  }
  float squares = dot_of_floats(g), one_over = 1.0f / squares, half_q = 0.5f * (dot_of_floats(c) * one_over);
  return (filtered){squares > 0.0f ? half_q : -1.0f,
                    (r->e[0] + r->e[1] * d[0] + r->e[2] * d[1] + r->e[3] * d[2]) * one_over,
                    list->footprints[i_footprint].opacity};
}

static void composite_by(const conic_gaussian_list *list, conic_gaussian_tile *tile, int is_seen) {
  const conic_gaussian_rules *rules = list->rules;
  for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++) {
    int x = tile->x + (int)at % CONIC_GAUSSIAN_TILE, y = tile->y + (int)at / CONIC_GAUSSIAN_TILE;
    size_t n = 0;
    for (size_t i = 0; i < list->n; i++) {
      const conic_gaussian_footprint *f = &list->footprints[list->entries[i]];
      if (x < f->box[0][0] || x > f->box[1][0] || y < f->box[0][1] || y > f->box[1][1])
        continue;
      filtered m = is_seen ? meet_seen(list, list->entries[i], at) : meet_filtered(list, list->entries[i], x, y);
      float alpha = m.opacity * conic_exp_negative(-m.half_q);
      alpha = alpha < rules->alpha_most ? alpha : rules->alpha_most;
      if (m.z > 0.0f && m.half_q >= 0.0f && alpha >= rules->alpha_least)
        list->hits[n++] = (conic_gaussian_hit){m.z, alpha, list->entries[i]};
    }
    conic_gaussian_composite_hits(list, list->hits, n, tile, at);
  }
}

static void composite_filtered(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  composite_by(list, tile, 0);
}

static void composite_seen(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  composite_by(list, tile, 1);
}

void conic_ray_kernels_scalar(conic_ray_kernels *kernels) {
  kernels->composite_filtered = composite_filtered;
  kernels->composite_seen = composite_seen;
}
