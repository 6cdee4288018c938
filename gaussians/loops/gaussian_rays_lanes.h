/* Gaussians along the rays of pixels, ordered pixel by pixel. A vector of pixels first finds where its rays meet each
 * Gaussian, then goes through the meetings in each ray's order. */
#pragma once

#include "gaussians/loops/gaussian_blocks_lanes.h"
#include "gaussians/loops/gaussian_pixels_lanes.h"
#include "gaussians/loops/ray_meetings_lanes.h"

CONIC_INLINE lanes lanes_alpha_of_fall(const scene *s, const gaussian_record *r, lanes fall) {
  if (s->falls_to_zero)
    fall = (fall - s->list->rules->fall_end) * s->list->rules->fall_factor;
  return lanes_min(r->opacity * fall, s->most);
}

CONIC_INLINE lanes lanes_alpha(const scene *s, const gaussian_record *r, lanes half_q) {
  return lanes_alpha_of_fall(s, r, lanes_exp_negative(-half_q));
}

CONIC_INLINE void add_planes_of_footprint(const conic_gaussian_list *list, uint32_t footprint, response *to) {
  to->index = lanes_of_index(list->footprints[footprint].index);
  for (int k = 0; k < 3; k++)
    to->normal[k] = list->normals ? lanes_of(list->normals[footprint][k]) : lanes_of(0.0f);
}

enum { BATCH = 256, RAYS_AHEAD = 6 }; /* entries that are taken at a time; how far memory is asked for */
enum { SORTED_AT_ONCE = 512 };        /* rows, of many that have come */

CONIC_INLINE meeting_lanes meet_lanes(const CONIC_STORED conic_gaussian_ray *r, lanes dx, lanes dy) {
  lanes g[3], c[3];
  for (int k = 0; k < 3; k++) {
    g[k] = r->g[0][k] + r->g[1][k] * dx + r->g[2][k] * dy;
    c[k] = r->c[0][k] + r->c[1][k] * dx + r->c[2][k] * dy;
  }
  lanes squares = g[0] * g[0] + g[1] * g[1] + g[2] * g[2], one_over = 1.0f / squares;
  lanes half_q = 0.5f * ((c[0] * c[0] + c[1] * c[1] + c[2] * c[2]) * one_over);
  return (meeting_lanes){.half_q = lanes_select(lanes_less(lanes_of(0.0f), squares), half_q, lanes_of(-1.0f)),
                         .z = (r->e[0] + r->e[1] * dx + r->e[2] * dy) * one_over};
}

#ifndef CONIC_ON_DEVICE /* which has opencl/gaussian_rays.cl */
#include "gaussians/draw/ray_hits.h"
#include "gaussians/loops/gaussian_order_lanes.h"

CONIC_INLINE meeting_lanes meet_by_shape(const conic_gaussian_list *list, uint32_t footprint, const gaussian_record *r,
                                         size_t pixel, conic_gaussian_shape shape) {
  const places at = places_at(pixel);
  if (shape == CONIC_SHAPE_FILTERED)
    return meet_filtered_lanes(list, footprint, at.column + r->x, at.row + r->y);
  if (shape == CONIC_SHAPE_SIGHT)
    return meet_sight_lanes(list, footprint, pixel);
  return meet_lanes(&list->rays[footprint], at.column + r->x, at.row + r->y);
}

/* What a Gaussian looks like wherever it meets a ray. */
typedef struct look {
  float color[3];
  uint32_t footprint;
} look;

/* Arrays of the room of a list. */
typedef struct meetings {
  gaussian_record *records;
  uint32_t *blocks;
  float *bounds;           /* of each batch: no z that follows it is below */
  conic_ray_hit *hits;     /* of one ray, twice */
  size_t n_taken;          /* entries that have a gaussian_record */
  look *looks;             /* of the Gaussians that meet a ray of the vector, */
  lanes_row *z, *alpha;    /* where they do; alpha 0: not that ray */
  lanes_row *keys;         /* which of them wait, nearest first */
  size_t n, n_waiting;     /* rows of the two */
  lanes nearest, farthest; /* z of all that wait is between */
  depth_keys by;
} meetings;

static meetings meetings_in_room(const conic_gaussian_list *list) {
  const size_t n = list->n + CONIC_SORTED_TOGETHER;
  meetings m = {.records = list->room};
  m.z = (lanes_row *)(void *)(m.records + n);
  m.alpha = m.z + n;
  m.keys = m.alpha + n;
  m.looks = (look *)(void *)(m.keys + n);
  m.blocks = (uint32_t *)(void *)(m.looks + n);
  m.bounds = (float *)(void *)(m.blocks + n);
  m.hits = (conic_ray_hit *)(void *)(m.bounds + n);
  return m;
}

static void take_records(const conic_gaussian_list *list, const conic_gaussian_tile *tile, size_t end, meetings *m) {
  if (m->n_taken >= end)
    return;
  for (; m->n_taken < end; m->n_taken++) {
    const conic_gaussian_footprint *f = footprint_of_entry(list, m->n_taken);
    gaussian_record *r = &m->records[m->n_taken];
    *r = record_of(tile, f);
    m->blocks[m->n_taken] = blocks_of_box(tile, f) & blocks_of_ellipse(r, f->half_reach);
  }
  memset(m->blocks + end, 0, CONIC_LANES * sizeof *m->blocks);
}

/* Where the vector's rays meet the Gaussians of entries that are listed, counted from `first`. */
CONIC_INLINE void meet_listed(const scene *s, meetings *m, size_t first, const uint32_t *listed, size_t n_listed,
                              size_t pixel, conic_gaussian_shape shape) {
  const places at = places_at(pixel);
  const conic_gaussian_list *list = s->list;
  for (size_t i = 0; i < n_listed; i++) {
    const gaussian_record *r = &m->records[first + listed[i]];
    const uint32_t footprint = list->entries[first + listed[i]];
    if (shape == CONIC_SHAPE_RAY && i + RAYS_AHEAD < n_listed) { /* a ray takes two lines of the cache */
      const char *next = (const char *)&list->rays[list->entries[first + listed[i + RAYS_AHEAD]]];
      __builtin_prefetch(next);
      __builtin_prefetch(next + sizeof *list->rays - 1);
    }
    const meeting_lanes met = meet_by_shape(list, footprint, r, pixel, shape);
    lanes alpha = shape == CONIC_SHAPE_FILTERED ? lanes_min(met.opacity * lanes_exp_negative(-met.half_q), s->most)
                                                : lanes_alpha(s, r, met.half_q);
    lanes_mask covered = within_box(r, at) & lanes_less(lanes_of(0.0f), met.z) &
                         lanes_at_least(met.half_q, lanes_of(0.0f)) & lanes_at_least(alpha, s->least);
    if (!lanes_any(covered))
      continue;
    const int is_solid = shape == CONIC_SHAPE_SIGHT && list->rules->shape == CONIC_SHAPE_SOLID;
    const lanes z = is_solid ? lanes_of(r->z) : met.z;
    lanes_store(m->z[m->n], z);
    lanes_store(m->alpha[m->n], lanes_keep(covered, alpha));
    m->looks[m->n++] = (look){{r->color[0], r->color[1], r->color[2]}, footprint};
    m->nearest = lanes_select(covered, lanes_min(z, m->nearest), m->nearest);
    m->farthest = lanes_max(lanes_keep(covered, z), m->farthest);
  }
}

CONIC_INLINE index_lanes at_pixels(index_lanes which) {
  return which * (uint32_t)CONIC_LANES + lanes_ascending(0);
}

/* Of Gaussians at one depth the order is that of the list. */
static int is_behind(const meetings *m, uint32_t a, uint32_t b, size_t lane) {
  return m->z[a][lane] > m->z[b][lane] || (m->z[a][lane] == m->z[b][lane] && a > b);
}

/* The same ray by ray, where depths are equal. */
static void mend_equals(meetings *m, size_t n) {
  for (size_t lane = 0; lane < CONIC_LANES; lane++)
    for (size_t i = 1; i < n && m->keys[i][lane] < __builtin_inff(); i++) {
      const float key = m->keys[i][lane];
      const uint32_t which = conic_bits_of_float(key) & m->by.numbers;
      size_t at = i;
      for (; at > 0; at--) {
        if (!is_behind(m, conic_bits_of_float(m->keys[at - 1][lane]) & m->by.numbers, which, lane))
          break;
        m->keys[at][lane] = m->keys[at - 1][lane];
      }
      m->keys[at][lane] = key;
    }
}

/* Puts in order what lies side by side and has keys that cannot tell; returns whether anything did not. Tells where
 * equal depths are not in the list's order, too. */
CONIC_INLINE int swap_neighbours(meetings *m, size_t n, int *has_equals) {
  int has_swapped = 0;
  *has_equals = 0;
  lanes second = lanes_load(m->keys[0]);
  for (size_t i = 1; i < n; i++) {
    lanes first = second;
    second = lanes_load(m->keys[i]);
    index_lanes both = lanes_to_bits(first) ^ lanes_to_bits(second);
    lanes_mask is_unclear =
        lanes_less(second, lanes_of(__builtin_inff())) & lanes_not(lanes_has_bits(both, ~m->by.numbers));
    if (!lanes_any(is_unclear))
      continue;
    lanes z_first = lanes_gather(m->z[0], at_pixels(lanes_to_bits(first) & m->by.numbers));
    lanes z_second = lanes_gather(
        m->z[0], at_pixels(lanes_select_indices(is_unclear, lanes_to_bits(second) & m->by.numbers, (index_lanes){0})));
    lanes_mask is_wrong = is_unclear & lanes_less(z_second, z_first);
    lanes_mask is_equal = is_unclear & lanes_not(is_wrong) & lanes_not(lanes_less(z_first, z_second));
    *has_equals |= lanes_any(is_equal & lanes_less(second, first)); /* keys without depths that differ: places */
    lanes_store(m->keys[i - 1], lanes_select(is_wrong, second, first));
    second = lanes_select(is_wrong, first, second);
    lanes_store(m->keys[i], second);
    has_swapped |= lanes_any(is_wrong);
  }
  return has_swapped;
}

/* Puts in order what the keys could not tell apart. */
CONIC_INLINE void mend_order(meetings *m, size_t n) {
  int has_equals = 0;
  if (n == 0)
    return;
  while (swap_neighbours(m, n, &has_equals))
    ;
  if (has_equals)
    mend_equals(m, n);
}

/* Of what waits, and n rows that have come: those that are named, or from `first` on. */
CONIC_INLINE void sort_meetings(meetings *m, const conic_ray_hit *named, size_t first, size_t n) {
  const depth_keys before = m->by;
  const lanes infinity = lanes_of(__builtin_inff());
  m->by = keys_between(m->nearest, m->farthest, m->n);
  for (size_t i = 0; i < m->n_waiting; i++) {
    lanes key = lanes_load(m->keys[i]);
    lanes_mask is_there = lanes_less(key, infinity);
    index_lanes which = lanes_to_bits(key) & before.numbers;
    key = key_of_depth(&m->by, lanes_gather(m->z[0], at_pixels(which)), which);
    lanes_store(m->keys[i], lanes_select(is_there, key, infinity));
  }
  for (size_t i = 0; i < n; i++) {
    const size_t row = named ? named[i].which : first + i;
    lanes_mask is_there = lanes_less(lanes_of(0.0f), lanes_load(m->alpha[row]));
    lanes key = key_of_depth(&m->by, lanes_load(m->z[row]), lanes_of_index((uint32_t)row));
    lanes_store(m->keys[m->n_waiting++], lanes_select(is_there, key, infinity));
  }
  sort_rows(m->keys, m->n_waiting);
  mend_order(m, m->n_waiting);
}

CONIC_INLINE response response_in_order(const scene *s, const meetings *m, index_lanes which, int wants) {
  const conic_gaussian_list *list = s->list;
  const index_lanes at = which * (uint32_t)(sizeof(look) / sizeof(float));
  const lanes none = lanes_of(0.0f); /* a list of initial values would go through memory */
  response to;
  to.covered = lanes_mask_of(0);
  to.index = (index_lanes){0};
  to.z = to.normal[0] = to.normal[1] = to.normal[2] = none;
  to.alpha = lanes_gather(m->alpha[0], at_pixels(which));
  for (uint32_t k = 0; k < 3; k++)
    to.color[k] = lanes_gather(m->looks[0].color, at + k);
  if (wants != CONIC_GAUSSIAN_COLORS || conic_gaussian_list_surface(list, 0))
    to.z = lanes_gather(m->z[0], at_pixels(which));
  if (wants != CONIC_GAUSSIAN_ALL)
    return to;
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    const uint32_t footprint = m->looks[which[lane]].footprint;
    to.index[lane] = list->footprints[footprint].index;
    for (int k = 0; k < 3; k++)
      to.normal[k][lane] = list->normals ? list->normals[footprint][k] : 0.0f;
  }
  return to;
}

/* Composites what lies before `bound`, as far as keys tell, all of infinity; the rest waits. */
CONIC_INLINE void composite_before(const scene *s, meetings *m, float bound, pixels *p, int wants) {
  const float border = key_border(&m->by, bound);
  const lanes infinity = lanes_of(__builtin_inff()),
              key_of_bound = lanes_of(bound < __builtin_inff() ? least_key_at(&m->by, border) : bound);
  const size_t n = m->n_waiting;
  m->n_waiting = 0;
  for (size_t i = 0; i < n; i++) {
    lanes key = lanes_load(m->keys[i]);
    lanes_mask is_there = lanes_less(key, infinity) & p->goes_on, is_before = lanes_less(key, key_of_bound);
    if (!lanes_any(is_there))
      break;
    if (lanes_any(is_before & is_there)) {
      response to = response_in_order(s, m, lanes_to_bits(key) & m->by.numbers, wants);
      to.covered = is_there & is_before;
      composite_lanes(s, &to, p, wants);
    }
    is_there = is_there & lanes_not(is_before);
    if (lanes_any(is_there))
      lanes_store(m->keys[m->n_waiting++], lanes_select(is_there, key, infinity));
  }
  m->nearest = m->n_waiting > 0 ? lanes_of(border) : infinity;
}

/* The same of many rows that have come, from `first` on: of rays side by side they are at about the same depths, so
 * that those with the nearest come first, and most are composited before the next are sorted. */
CONIC_INLINE void composite_in_parts(const scene *s, meetings *m, size_t first, float bound, pixels *p, int wants) {
  const size_t n = m->n - first;
  for (size_t i = 0; i < n; i++) {
    lanes_row z;
    float least = __builtin_inff();
    lanes_store(z, lanes_select(lanes_less(lanes_of(0.0f), lanes_load(m->alpha[first + i])),
                                lanes_load(m->z[first + i]), lanes_of(least)));
    for (int lane = 0; lane < CONIC_LANES; lane++)
      least = z[lane] < least ? z[lane] : least;
    m->hits[i] = (conic_ray_hit){.z = least, .which = (uint32_t)(first + i)};
  }
  conic_sort_hits(m->hits, n);
  for (size_t begin = 0, end; begin < n && lanes_any(p->goes_on); begin = end) {
    end = begin + (m->n_waiting / 2 > SORTED_AT_ONCE ? m->n_waiting / 2 : SORTED_AT_ONCE);
    end = end < n ? end : n;
    m->nearest = lanes_min(m->nearest, lanes_of(m->hits[begin].z));
    sort_meetings(m, m->hits + begin, 0, end - begin);
    composite_before(s, m, end < n && m->hits[end].z < bound ? m->hits[end].z : bound, p, wants);
  }
}

static void find_bounds(const conic_gaussian_list *list, conic_gaussian_shape shape, const meetings *m) {
  float bound = __builtin_inff();
  for (size_t i = list->n; i-- > 0;) {
    if (i % BATCH == BATCH - 1 || i == list->n - 1)
      m->bounds[i / BATCH] = bound;
    if (i >= RAYS_AHEAD)
      __builtin_prefetch(&list->footprints[list->entries[i - RAYS_AHEAD]]);
    const float z = shape == CONIC_SHAPE_RAY ? list->footprints[list->entries[i]].z : 0.0f;
    bound = z < bound ? z : bound;
  }
}

/* Batch by batch, as far as nothing nearer can follow. */
CONIC_INLINE void composite_rays_in_vector(const scene *s, meetings *m, size_t pixel, conic_gaussian_shape shape,
                                           int wants) {
  const conic_gaussian_list *list = s->list;
  const int block = (int)(pixel / CONIC_GAUSSIAN_BLOCK_PIXELS);
  pixels p = take_pixels(s, ~0u, pixel, wants);
  uint32_t listed[BATCH + CONIC_LANES];
  m->n = m->n_waiting = 0;
  m->nearest = lanes_of(__builtin_inff());
  m->farthest = lanes_of(0.0f);
  size_t n_sorted = 0;
  for (size_t first = 0; first < list->n && lanes_any(p.goes_on); first += BATCH) {
    const size_t end = first + BATCH < list->n ? first + BATCH : list->n;
    const float bound = m->bounds[first / BATCH];
    take_records(list, s->tile, end, m);
    meet_listed(s, m, first, listed, list_block(m->blocks + first, end - first, block, listed), pixel, shape);
    if (end < list->n &&
        (m->n - n_sorted < m->n_waiting / 2 || !lanes_any(p.goes_on & lanes_less(m->nearest, lanes_of(bound)))))
      continue; /* else what waits would be sorted with every batch */
    if (m->n - n_sorted > SORTED_AT_ONCE)
      composite_in_parts(s, m, n_sorted, bound, &p, wants);
    else {
      sort_meetings(m, NULL, n_sorted, m->n - n_sorted);
      composite_before(s, m, bound, &p, wants);
    }
    n_sorted = m->n;
  }
  put_pixels(s->tile, &p, pixel, wants);
}

CONIC_INLINE void composite_rays_block_by_block(const conic_gaussian_list *list, conic_gaussian_tile *tile,
                                                conic_gaussian_shape shape, int wants) {
  const scene s = scene_of(list, tile);
  meetings m = meetings_in_room(list);
  find_bounds(list, shape, &m);
  for (size_t pixel = 0; pixel < CONIC_GAUSSIAN_TILE_PIXELS; pixel += CONIC_LANES)
    composite_rays_in_vector(&s, &m, pixel, shape, wants);
}

static void composite_rays_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  CONIC_BY_WANTS(composite_rays_block_by_block, list, tile, CONIC_SHAPE_RAY);
}

static void composite_filtered_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  composite_rays_block_by_block(list, tile, CONIC_SHAPE_FILTERED, list->wants);
}

static void composite_sights_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  composite_rays_block_by_block(list, tile, CONIC_SHAPE_SIGHT, list->wants);
}

#endif
