/* Filtered rays, and rays of any camera, in lanes: what gaussians/draw/ray_kernels.c does, as many pixels at a time as
 * there are lanes. */
#include "core/lanes/lanes_exponential.h"
#include "gaussians/draw/ray_kernels.h"
#include "gaussians/kernels/hits_lanes.h"

typedef struct filtered_lanes {
  lanes half_q, z, opacity;
} filtered_lanes;

CONIC_INLINE lanes lanes_dot_of_self(const lanes a[3]) {
  return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

CONIC_INLINE filtered_lanes meet_filtered_lanes(const conic_gaussian_list *list, uint32_t i_footprint, lanes dx,
                                                float dy) {
  const conic_gaussian_ray *r = &list->rays[i_footprint];
  const conic_gaussian_filter *f = &list->filters[i_footprint];
  lanes g[3], c[3], by_x[3], by_y[3];
  for (int k = 0; k < 3; k++) {
    g[k] = r->g[0][k] + r->g[1][k] * dx + r->g[2][k] * dy;
    c[k] = r->c[0][k] + r->c[1][k] * dx + r->c[2][k] * dy;
    by_x[k] = lanes_of(f->x[k] - f->both[k] * dy);
    by_y[k] = f->y[k] + f->both[k] * dx;
  }
  lanes squares = lanes_dot_of_self(g), one_over = 1.0f / squares;
  lanes z = (r->e[0] + r->e[1] * dx + r->e[2] * dy) * one_over;
  lanes t = (list->is_parallel ? lanes_of(1.0f) : z * z) * one_over, area = t * f->area;
  lanes turn_x = lanes_of(f->turn[0] - f->turn[2] * dy), turn_y = f->turn[1] + f->turn[2] * dx;
  lanes S = 1.0f + (t * (lanes_dot_of_self(by_x) + lanes_dot_of_self(by_y)) + area * area * squares);
  lanes q = (lanes_dot_of_self(c) * one_over + t * (turn_x * turn_x + turn_y * turn_y)) / S;
  return (filtered_lanes){lanes_select(lanes_less(lanes_of(0.0f), squares), 0.5f * q, lanes_of(-1.0f)), z,
                          list->footprints[i_footprint].opacity / lanes_sqrt(S)};
}

CONIC_INLINE filtered_lanes meet_seen_lanes(const conic_gaussian_list *list, uint32_t i_footprint, size_t at) {
  const conic_gaussian_sight *r = &list->sights[i_footprint];
  const conic_tile_rays *rays = list->tile_rays;
  lanes d[3], g[3], c[3];
  for (int k = 0; k < 3; k++)
    d[k] = (lanes_load(&rays->high[k][at]) - r->high[k]) + (lanes_load(&rays->low[k][at]) - r->low[k]);
  for (int k = 0; k < 3; k++) {
    g[k] = r->g[k][0] + r->g[k][1] * d[0] + r->g[k][2] * d[1] + r->g[k][3] * d[2];
    c[k] = r->c[k][0] + r->c[k][1] * d[0] + r->c[k][2] * d[1] + r->c[k][3] * d[2];
  }
  lanes squares = lanes_dot_of_self(g), one_over = 1.0f / squares;
  lanes half_q = 0.5f * (lanes_dot_of_self(c) * one_over);
  return (filtered_lanes){lanes_select(lanes_less(lanes_of(0.0f), squares), half_q, lanes_of(-1.0f)),
                          (r->e[0] + r->e[1] * d[0] + r->e[2] * d[1] + r->e[3] * d[2]) * one_over,
                          lanes_of(list->footprints[i_footprint].opacity)};
}

CONIC_INLINE void composite_by_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile, int is_seen) {
  const lanes most = lanes_of(list->rules->alpha_most), least = lanes_of(list->rules->alpha_least);
  for (int row = 0; row < CONIC_GAUSSIAN_TILE; row++) {
    size_t n_hits[CONIC_GAUSSIAN_TILE] = {0};
    for (size_t i = 0; i < list->n; i++) {
      const conic_gaussian_footprint *f = &list->footprints[list->entries[i]];
      const hit_part p = hit_part_of(tile, f);
      if (row < p.first_row || row > p.last_row)
        continue;
      for (int column = p.first_column; column <= p.last_column; column += CONIC_LANES) {
        lanes_mask within;
        lanes dx = lanes_of_ints(hit_columns(tile, f, column, &within) - f->x);
        filtered_lanes m = is_seen
                               ? meet_seen_lanes(list, list->entries[i], (size_t)(row * CONIC_GAUSSIAN_TILE + column))
                               : meet_filtered_lanes(list, list->entries[i], dx, (float)(tile->y + row - f->y));
        lanes alpha = lanes_min(m.opacity * lanes_exp_negative(-m.half_q), most);
        lanes_mask covered = within & lanes_less(lanes_of(0.0f), m.z) & lanes_at_least(m.half_q, lanes_of(0.0f)) &
                             lanes_at_least(alpha, least);
        keep_hits(list, list->entries[i], covered, m.z, alpha, (size_t)column, n_hits);
      }
    }
    composite_hit_row(list, n_hits, tile, row);
  }
}

static void composite_filtered_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  composite_by_lanes(list, tile, 0);
}

static void composite_seen_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  composite_by_lanes(list, tile, 1);
}

CONIC_FILL_KERNELS(conic_ray_kernels) {
  kernels->composite_filtered = composite_filtered_in_lanes;
  kernels->composite_seen = composite_seen_in_lanes;
}
