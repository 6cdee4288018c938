/* Compositing in lanes: 16 pixels of a row, as many at a time as there are lanes. Includes what fills the table. C and
 * OpenCL C share this text. */
#include "core/lanes/lanes.h"
#include "gaussians/draw/gaussian_tile.h"

/* What of a tile's list does not change. */
typedef struct scene {
  const conic_gaussian_list *list;
  conic_gaussian_tile *tile;
  lanes most, least, stop, greatest;
  int is_beyond_stop, has_greatest;
} scene;

CONIC_INLINE scene scene_of(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  const conic_gaussian_rules *rules = list->rules;
  return (scene){list,
                 tile,
                 lanes_of(rules->alpha_most),
                 lanes_of(rules->alpha_least),
                 lanes_of(rules->stop),
                 lanes_of(rules->greatest_half_q),
                 rules->is_beyond_stop,
                 rules->greatest_half_q > 0.0f};
}

CONIC_INLINE lanes lanes_alpha(const scene *s, const CONIC_STORED conic_gaussian_footprint *f, lanes half_q) {
  return lanes_min(f->opacity * lanes_exp_negative(-half_q), s->most);
}

CONIC_INLINE void lanes_accumulate(float *to, lanes_mask mask, lanes value) {
  lanes_store(to, lanes_load(to) + lanes_keep(mask, value));
}

/* What is wanted beside colour. */
CONIC_INLINE void composite_planes_in_lanes(const scene *s, uint32_t i_footprint, lanes_mask goes, lanes z, lanes w,
                                            lanes before, lanes after, size_t at) {
  const conic_gaussian_list *list = s->list;
  conic_gaussian_tile *tile = s->tile;
  index_lanes index = lanes_of_index(list->footprints[i_footprint].index);
  lanes_mask crosses = goes & lanes_less(lanes_of(0.5f), before);
  if (!list->rules->has_late_median)
    crosses = crosses & lanes_at_least(lanes_of(0.5f), after);
  lanes_accumulate(tile->sum + at, goes, w);
  lanes_accumulate(tile->sum_of_z + at, goes, w * z);
  lanes_accumulate(tile->inverse_z + at, goes, w / z);
  lanes_replace(tile->median_z + at, crosses, z);
  lanes_mask is_heavier = goes & lanes_less(lanes_load(tile->heaviest + at), w);
  lanes_replace(tile->heaviest + at, is_heavier, w);
  lanes_replace_indices(tile->id + at, is_heavier, index);
  lanes_replace_indices(tile->last + at, goes, index);
  lanes_store_indices(tile->count + at, lanes_increment(goes, lanes_load_indices(tile->count + at)));
  for (int c = 0; c < 3 && list->normals; c++)
    lanes_accumulate(tile->normal[c] + at, goes, w * list->normals[i_footprint][c]);
}

/* Where compositing ends, T goes to `rest`, and 0 takes its place. */
CONIC_INLINE void end_pixels(conic_gaussian_tile *tile, lanes_mask ends, lanes before, size_t at) {
  ends = ends & lanes_less(lanes_of(0.0f), before);
  lanes_replace(tile->rest + at, ends, before);
  lanes_replace(tile->T + at, ends, lanes_of(0.0f));
}

CONIC_INLINE void composite_lanes(const scene *s, uint32_t i_footprint, lanes_mask covered, lanes z, lanes alpha,
                                  size_t at) {
  const CONIC_STORED conic_gaussian_footprint *f = &s->list->footprints[i_footprint];
  conic_gaussian_tile *tile = s->tile;
  lanes before = lanes_load(tile->T + at), after = before * (1.0f - alpha), w = alpha * before;
  lanes_mask ends = s->is_beyond_stop ? lanes_at_least(s->stop, after) : lanes_less(after, s->stop);
  lanes_mask goes = covered & lanes_not(ends);
  ends = ends & covered;
  lanes_replace(tile->T + at, goes, after);
  for (int c = 0; c < 3; c++)
    lanes_accumulate(tile->rgb[c] + at, goes, w * f->color[c]);
  if (s->list->wants_all)
    composite_planes_in_lanes(s, i_footprint, goes, z, w, before, after, at);
  if (lanes_any(ends))
    end_pixels(tile, ends, before, at);
}

/* Columns of lanes, as offsets from the footprint's pixel; which of them lie within its box. */
CONIC_INLINE lanes columns_of(const scene *s, const CONIC_STORED conic_gaussian_footprint *f, int column,
                              lanes_mask *within) {
  int_lanes x = ints_of_indices(lanes_ascending(0)) + (s->tile->x + column);
  *within = lanes_not(lanes_less_int(x, lanes_of_int((int32_t)f->box[0][0]))) &
            lanes_not(lanes_less_int(lanes_of_int((int32_t)f->box[1][0]), x));
  return lanes_of_ints(x - f->x);
}

/* The part of the tile that the footprint's box meets, in rows and whole lanes. */
typedef struct part {
  int first_row, last_row, first_column, last_column;
} part;

CONIC_INLINE int lesser_of(int a, int b) {
  return a < b ? a : b;
}

CONIC_INLINE int greater_of(int a, int b) {
  return a > b ? a : b;
}

CONIC_INLINE part part_in_tile(const conic_gaussian_tile *tile, const CONIC_STORED conic_gaussian_footprint *f) {
  return (part){greater_of(f->box[0][1] - tile->y, 0), lesser_of(f->box[1][1] - tile->y, CONIC_GAUSSIAN_TILE - 1),
                greater_of(f->box[0][0] - tile->x, 0) / CONIC_LANES * CONIC_LANES,
                lesser_of(f->box[1][0] - tile->x, CONIC_GAUSSIAN_TILE - 1)};
}

static int is_over(const conic_gaussian_tile *tile) {
  lanes most = lanes_load(tile->T);
  for (size_t at = CONIC_LANES; at < CONIC_GAUSSIAN_TILE_PIXELS; at += CONIC_LANES)
    most = lanes_max(most, lanes_load(tile->T + at));
  return !lanes_any(lanes_less(lanes_of(0.0f), most));
}

enum { LOOKS_AGAIN = 64 }; /* entries from one look whether compositing has ended to the next */

static void composite_ellipses_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  const scene s = scene_of(list, tile);
  for (size_t i = 0; i < list->n; i++) {
    const CONIC_STORED conic_gaussian_footprint *f = &list->footprints[list->entries[i]];
    const part p = part_in_tile(tile, f);
    if (i % LOOKS_AGAIN == LOOKS_AGAIN - 1 && is_over(tile))
      return;
    for (int column = p.first_column; column <= p.last_column; column += CONIC_LANES) {
      lanes_mask within;
      lanes dx = columns_of(&s, f, column, &within) + f->dx, first = f->form[0] * dx * dx, mixed = f->form[1] * dx;
      for (int row = p.first_row; row <= p.last_row; row++) {
        float dy = (float)(tile->y + row - f->y) + f->dy;
        lanes half_q = 0.5f * (first + lanes_of(f->form[2] * dy * dy)) + mixed * dy;
        lanes alpha = lanes_alpha(&s, f, half_q);
        lanes_mask covered = within & lanes_at_least(half_q, lanes_of(0.0f)) & lanes_at_least(alpha, s.least);
        if (s.has_greatest)
          covered = covered & lanes_at_least(s.greatest, half_q);
        if (lanes_any(covered))
          composite_lanes(&s, list->entries[i], covered, lanes_of(f->z), alpha,
                          (size_t)(row * CONIC_GAUSSIAN_TILE + column));
      }
    }
  }
}

typedef struct meeting_lanes {
  lanes half_q, z;
} meeting_lanes;

CONIC_INLINE meeting_lanes meet_lanes(const CONIC_STORED conic_gaussian_ray *r, lanes dx, float dy) {
  lanes g[3], c[3];
  for (int k = 0; k < 3; k++) {
    g[k] = r->g[0][k] + r->g[1][k] * dx + r->g[2][k] * dy;
    c[k] = r->c[0][k] + r->c[1][k] * dx + r->c[2][k] * dy;
  }
  lanes squares = g[0] * g[0] + g[1] * g[1] + g[2] * g[2], one_over = 1.0f / squares;
  lanes half_q = 0.5f * ((c[0] * c[0] + c[1] * c[1] + c[2] * c[2]) * one_over);
  return (meeting_lanes){lanes_select(lanes_less(lanes_of(0.0f), squares), half_q, lanes_of(-1.0f)),
                         (r->e[0] + r->e[1] * dx + r->e[2] * dy) * one_over};
}

static void composite_discs_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  const scene s = scene_of(list, tile);
  const float near_z = list->rules->disc_near;
  for (size_t i = 0; i < list->n; i++) {
    const CONIC_STORED conic_gaussian_footprint *f = &list->footprints[list->entries[i]];
    const part p = part_in_tile(tile, f);
    if (i % LOOKS_AGAIN == LOOKS_AGAIN - 1 && is_over(tile))
      return;
    for (int column = p.first_column; column <= p.last_column; column += CONIC_LANES) {
      lanes_mask within;
      lanes x = columns_of(&s, f, column, &within), dx = x + f->dx;
      for (int row = p.first_row; row <= p.last_row; row++) {
        float y = (float)(tile->y + row - f->y), dy = y + f->dy;
        meeting_lanes m = meet_lanes(&list->rays[list->entries[i]], x, y);
        lanes half_q = lanes_min(m.half_q, dx * dx + lanes_of(dy * dy)), alpha = lanes_alpha(&s, f, half_q);
        lanes_mask covered = within & lanes_at_least(half_q, lanes_of(0.0f)) & lanes_at_least(alpha, s.least);
        if (near_z > 0.0f)
          covered = covered & lanes_at_least(m.z, lanes_of(near_z));
        if (lanes_any(covered))
          composite_lanes(&s, list->entries[i], covered, near_z > 0.0f ? m.z : lanes_of(f->z), alpha,
                          (size_t)(row * CONIC_GAUSSIAN_TILE + column));
      }
    }
  }
}

/* Appends the lanes that are covered to their pixels' hits. */
CONIC_INLINE void append_hits(const conic_gaussian_list *list, uint32_t i_footprint, unsigned bits, lanes z,
                              lanes alpha, size_t column, size_t *n_hits) {
  float depths[CONIC_LANES], alphas[CONIC_LANES];
  lanes_store(depths, z);
  lanes_store(alphas, alpha);
  for (; bits; bits &= bits - 1) {
    size_t lane = (size_t)__builtin_ctz(bits), pixel = column + lane;
    list->hits[pixel * list->n + n_hits[pixel]++] = (conic_gaussian_hit){depths[lane], alphas[lane], i_footprint};
  }
}

static void composite_rays_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  const scene s = scene_of(list, tile);
  for (int row = 0; row < CONIC_GAUSSIAN_TILE; row++) {
    size_t n_hits[CONIC_GAUSSIAN_TILE] = {0};
    for (size_t i = 0; i < list->n; i++) {
      const CONIC_STORED conic_gaussian_footprint *f = &list->footprints[list->entries[i]];
      const part p = part_in_tile(tile, f);
      float y = (float)(tile->y + row - f->y);
      if (row < p.first_row || row > p.last_row)
        continue;
      for (int column = p.first_column; column <= p.last_column; column += CONIC_LANES) {
        lanes_mask within;
        lanes x = columns_of(&s, f, column, &within);
        meeting_lanes m = meet_lanes(&list->rays[list->entries[i]], x, y);
        lanes alpha = lanes_alpha(&s, f, m.half_q);
        lanes_mask covered = within & lanes_less(lanes_of(0.0f), m.z) & lanes_at_least(m.half_q, lanes_of(0.0f)) &
                             lanes_at_least(alpha, s.least);
        append_hits(list, list->entries[i], lanes_bits(covered), m.z, alpha, (size_t)column, n_hits);
      }
    }
    for (size_t pixel = 0; pixel < CONIC_GAUSSIAN_TILE; pixel++)
      conic_gaussian_composite_hits(list, list->hits + pixel * list->n, n_hits[pixel], tile,
                                    (size_t)row * CONIC_GAUSSIAN_TILE + pixel);
  }
}

#ifndef CONIC_ON_DEVICE
CONIC_FILL_KERNELS(conic_gaussian_kernels) {
  kernels->composite[CONIC_SHAPE_ELLIPSE] = composite_ellipses_in_lanes;
  kernels->composite[CONIC_SHAPE_RAY] = composite_rays_in_lanes;
  kernels->composite[CONIC_SHAPE_DISC] = composite_discs_in_lanes;
}
#endif
