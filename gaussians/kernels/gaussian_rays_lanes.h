/* Gaussians along the rays of pixels, ordered pixel by pixel: of a vector of pixels first where all meet it, then those
 * in their order. */
#ifndef CONIC_GAUSSIAN_RAYS_LANES_H
#define CONIC_GAUSSIAN_RAYS_LANES_H

#include "gaussians/kernels/gaussian_blocks_lanes.h"
#include "gaussians/kernels/gaussian_pixels_lanes.h"

CONIC_INLINE lanes lanes_alpha(const scene *s, const record *r, lanes half_q) {
  return lanes_min(r->opacity * lanes_exp_negative(-half_q), s->most);
}

CONIC_INLINE void add_planes_of_footprint(const conic_gaussian_list *list, uint32_t footprint, response *to) {
  to->index = lanes_of_index(list->footprints[footprint].index);
  for (int k = 0; k < 3; k++)
    to->normal[k] = list->normals ? lanes_of(list->normals[footprint][k]) : lanes_of(0.0f);
}

#ifdef CONIC_ON_DEVICE
typedef struct meeting_lanes {
  lanes half_q, z;
} meeting_lanes;
#else
#include "gaussians/kernels/ray_meetings_lanes.h"
#endif

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
#include "gaussians/kernels/gaussian_order_lanes.h"

CONIC_INLINE meeting_lanes meet_by_shape(const conic_gaussian_list *list, uint32_t footprint, const record *r,
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
  record *records;
  uint32_t *blocks, *listed;
  look *looks;             /* of the Gaussians that meet a ray of the vector, */
  lanes_row *z, *alpha;    /* where they do; alpha 0: not that ray */
  lanes_row *keys;         /* which come first */
  lanes nearest, farthest; /* z at each ray */
} meetings;

static meetings meetings_in_room(const conic_gaussian_list *list) {
  const size_t n = list->n + CONIC_SORTED_TOGETHER;
  meetings m = {.records = list->room};
  m.z = (lanes_row *)(void *)(m.records + n);
  m.alpha = m.z + n;
  m.keys = m.alpha + n;
  m.looks = (look *)(void *)(m.keys + n);
  m.blocks = (uint32_t *)(void *)(m.looks + n);
  m.listed = m.blocks + n;
  return m;
}

/* Where the vector's rays meet the Gaussians of its block; returns how many they do. */
CONIC_INLINE size_t meet_all(const scene *s, meetings *to, size_t n_listed, size_t pixel, conic_gaussian_shape shape) {
  const places at = places_at(pixel);
  const conic_gaussian_list *list = s->list;
  size_t n = 0;
  to->nearest = lanes_of(__builtin_inff());
  to->farthest = lanes_of(0.0f);
  for (size_t i = 0; i < n_listed; i++) {
    const record *r = &to->records[to->listed[i]];
    const uint32_t footprint = list->entries[to->listed[i]];
    const meeting_lanes m = meet_by_shape(list, footprint, r, pixel, shape);
    lanes alpha = shape == CONIC_SHAPE_FILTERED ? lanes_min(m.opacity * lanes_exp_negative(-m.half_q), s->most)
                                                : lanes_alpha(s, r, m.half_q);
    lanes_mask covered = within_box(r, at) & lanes_less(lanes_of(0.0f), m.z) &
                         lanes_at_least(m.half_q, lanes_of(0.0f)) & lanes_at_least(alpha, s->least);
    if (!lanes_any(covered))
      continue;
    lanes_store(to->z[n], m.z);
    lanes_store(to->alpha[n], lanes_keep(covered, alpha));
    to->looks[n++] = (look){{r->color[0], r->color[1], r->color[2]}, footprint};
    to->nearest = lanes_select(covered, lanes_min(m.z, to->nearest), to->nearest);
    to->farthest = lanes_max(lanes_keep(covered, m.z), to->farthest);
  }
  return n;
}

CONIC_INLINE response response_in_order(const scene *s, const meetings *m, index_lanes which, int wants_all) {
  const conic_gaussian_list *list = s->list;
  const index_lanes at = which * (uint32_t)(sizeof(look) / sizeof(float));
  const index_lanes at_pixel = which * (uint32_t)CONIC_LANES + lanes_ascending(0);
  response to = {.alpha = lanes_gather(m->alpha[0], at_pixel)};
  for (uint32_t k = 0; k < 3; k++)
    to.color[k] = lanes_gather(m->looks[0].color, at + k);
  if (!wants_all)
    return to;
  to.z = lanes_gather(m->z[0], at_pixel);
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    const uint32_t footprint = m->looks[which[lane]].footprint;
    to.index[lane] = list->footprints[footprint].index;
    for (int k = 0; k < 3; k++)
      to.normal[k][lane] = list->normals ? list->normals[footprint][k] : 0.0f;
  }
  return to;
}

CONIC_INLINE void composite_rays_in_vector(const scene *s, meetings *m, size_t n_listed, size_t pixel,
                                           conic_gaussian_shape shape, int wants_all) {
  const size_t n = meet_all(s, m, n_listed, pixel, shape);
  const uint32_t numbers = sort_by_depth(m->z, m->alpha, n, m->nearest, m->farthest, m->keys);
  pixels p = take_pixels(s->tile, ~0u, pixel, wants_all);
  for (size_t i = 0; i < n; i++) {
    lanes key = lanes_load(m->keys[i]);
    lanes_mask is_there = lanes_less(key, lanes_of(__builtin_inff()));
    if (!lanes_any(is_there & p.goes_on))
      break;
    response to = response_in_order(s, m, lanes_to_bits(key) & numbers, wants_all);
    to.covered = is_there;
    composite_lanes(s, &to, &p, wants_all);
  }
  put_pixels(s->tile, &p, pixel, wants_all);
}

CONIC_INLINE void composite_rays_block_by_block(const conic_gaussian_list *list, conic_gaussian_tile *tile,
                                                conic_gaussian_shape shape, int wants_all) {
  const scene s = scene_of(list, tile);
  meetings m = meetings_in_room(list);
  for (size_t i = 0; i < list->n; i++) {
    const conic_gaussian_footprint *f = footprint_of_entry(list, i);
    m.records[i] = record_of(tile, f);
    m.blocks[i] = blocks_of_box(tile, f) & blocks_of_ellipse(&m.records[i], f->half_reach);
  }
  memset(m.blocks + list->n, 0, CONIC_LANES * sizeof *m.blocks);
  for (int block = 0; block < CONIC_GAUSSIAN_BLOCKS; block++) {
    size_t n_listed = list_block(m.blocks, list->n, block, m.listed);
    for (size_t part = 0; part < CONIC_PARTS; part++)
      composite_rays_in_vector(&s, &m, n_listed, (size_t)block * CONIC_GAUSSIAN_BLOCK_PIXELS + part * CONIC_LANES,
                               shape, wants_all);
  }
}

static void composite_rays_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  if (list->wants_all)
    composite_rays_block_by_block(list, tile, CONIC_SHAPE_RAY, 1);
  else
    composite_rays_block_by_block(list, tile, CONIC_SHAPE_RAY, 0);
}

static void composite_filtered_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  composite_rays_block_by_block(list, tile, CONIC_SHAPE_FILTERED, list->wants_all);
}

static void composite_sights_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  composite_rays_block_by_block(list, tile, CONIC_SHAPE_SIGHT, list->wants_all);
}

#endif
#endif
