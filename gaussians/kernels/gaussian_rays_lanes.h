/* Gaussians along the rays of pixels, ordered pixel by pixel: of a vector of pixels first where all meet it, then what
 * can have nothing before it any more, nearest first. */
#ifndef CONIC_GAUSSIAN_RAYS_LANES_H
#define CONIC_GAUSSIAN_RAYS_LANES_H

#include "gaussians/kernels/gaussian_blocks_lanes.h"
#include "gaussians/kernels/gaussian_pixels_lanes.h"
#include "gaussians/kernels/ray_meetings_lanes.h"

CONIC_INLINE lanes lanes_alpha(const scene *s, const record *r, lanes half_q) {
  return lanes_min(r->opacity * lanes_exp_negative(-half_q), s->most);
}

CONIC_INLINE void add_planes_of_footprint(const conic_gaussian_list *list, uint32_t footprint, response *to) {
  to->index = lanes_of_index(list->footprints[footprint].index);
  for (int k = 0; k < 3; k++)
    to->normal[k] = list->normals ? lanes_of(list->normals[footprint][k]) : lanes_of(0.0f);
}

CONIC_INLINE meeting_lanes meet_lanes(const conic_gaussian_ray *r, lanes dx, lanes dy) {
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

CONIC_INLINE meeting_lanes meet_by_shape(const conic_gaussian_list *list, uint32_t footprint, const record *r,
                                         places at, size_t pixel, conic_gaussian_shape shape) {
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

typedef float vector[CONIC_LANES];

/* Arrays of the room of a list. */
typedef struct queue {
  record *records;
  uint32_t *blocks, *listed;
  look *looks;               /* of the Gaussians that meet a pixel of the vector */
  vector *z, *alpha, *after; /* where they do, and where those of them from this one on do at least; alpha 0: nowhere */
  vector *waiting_z;         /* what has come and has not been composited, sorted by z at each pixel, */
  uint32_t (*waiting)[CONIC_LANES]; /* and which it is */
  size_t head, tail;
} queue;

static queue queue_in_room(const conic_gaussian_list *list) {
  const size_t n = list->n + 1;
  queue q = {.records = list->room};
  q.z = (vector *)(void *)(q.records + n);
  q.alpha = q.z + n;
  q.after = q.alpha + n;
  q.waiting_z = q.after + n;
  q.waiting = (uint32_t(*)[CONIC_LANES])(void *)(q.waiting_z + n);
  q.looks = (look *)(void *)(q.waiting + n);
  q.blocks = (uint32_t *)(void *)(q.looks + n);
  q.listed = q.blocks + n + CONIC_LANES;
  return q;
}

/* Where the vector's rays meet the Gaussians of its block; returns how many they do. */
CONIC_INLINE size_t meet_all(const scene *s, const queue *q, size_t n_listed, size_t pixel,
                             conic_gaussian_shape shape) {
  const places at = places_at(pixel);
  const conic_gaussian_list *list = s->list;
  size_t n = 0;
  for (size_t i = 0; i < n_listed; i++) {
    const record *r = &q->records[q->listed[i]];
    const uint32_t footprint = list->entries[q->listed[i]];
    const meeting_lanes m = meet_by_shape(list, footprint, r, at, pixel, shape);
    lanes alpha = shape == CONIC_SHAPE_FILTERED ? lanes_min(m.opacity * lanes_exp_negative(-m.half_q), s->most)
                                                : lanes_alpha(s, r, m.half_q);
    lanes_mask covered = within_box(r, at) & lanes_less(lanes_of(0.0f), m.z) &
                         lanes_at_least(m.half_q, lanes_of(0.0f)) & lanes_at_least(alpha, s->least);
    if (!lanes_any(covered))
      continue;
    lanes_store(q->z[n], m.z);
    lanes_store(q->alpha[n], lanes_keep(covered, alpha));
    q->looks[n++] = (look){{r->color[0], r->color[1], r->color[2]}, footprint};
  }
  lanes nearest = lanes_of(__builtin_inff());
  lanes_store(q->after[n], nearest);
  for (size_t i = n; i-- > 0;) {
    lanes_mask is_there = lanes_less(lanes_of(0.0f), lanes_load(q->alpha[i]));
    nearest = lanes_select(is_there, lanes_min(lanes_load(q->z[i]), nearest), nearest);
    lanes_store(q->after[i], nearest);
  }
  return n;
}

/* Puts a Gaussian behind all that is not farther. Where it does not meet a ray, it waits behind all that waits. */
CONIC_INLINE void let_wait(queue *q, uint32_t i, lanes *farthest) {
  lanes z = lanes_select(lanes_less(lanes_of(0.0f), lanes_load(q->alpha[i])), lanes_load(q->z[i]), *farthest);
  index_lanes which = lanes_of_index(i);
  size_t at = q->tail++;
  *farthest = lanes_max(*farthest, z);
  for (; at > q->head; at--) {
    lanes before = lanes_load(q->waiting_z[at - 1]);
    index_lanes which_before = lanes_load_indices(q->waiting[at - 1]);
    lanes_mask is_nearer = lanes_less(z, before);
    if (!lanes_any(is_nearer))
      break;
    lanes_store(q->waiting_z[at], lanes_select(is_nearer, before, z));
    lanes_store_indices(q->waiting[at], lanes_select_indices(is_nearer, which_before, which));
    z = lanes_select(is_nearer, z, before);
    which = lanes_select_indices(is_nearer, which, which_before);
  }
  lanes_store(q->waiting_z[at], z);
  lanes_store_indices(q->waiting[at], which);
}

CONIC_INLINE void composite_waiting(const scene *s, const queue *q, pixels *p, int wants_all) {
  const conic_gaussian_list *list = s->list;
  const index_lanes which = lanes_load_indices(q->waiting[q->head]);
  const index_lanes at = which * (uint32_t)(sizeof(look) / sizeof(float));
  const float *looks = q->looks[0].color;
  response to = {.z = lanes_load(q->waiting_z[q->head])};
  to.alpha = lanes_gather(q->alpha[0], which * (uint32_t)CONIC_LANES + lanes_ascending(0));
  to.covered = lanes_less(lanes_of(0.0f), to.alpha);
  for (uint32_t k = 0; k < 3; k++)
    to.color[k] = lanes_gather(looks, at + k);
  if (wants_all)
    for (int lane = 0; lane < CONIC_LANES; lane++) {
      const uint32_t footprint = q->looks[which[lane]].footprint;
      to.index[lane] = list->footprints[footprint].index;
      for (int k = 0; k < 3; k++)
        to.normal[k][lane] = list->normals ? list->normals[footprint][k] : 0.0f;
    }
  composite_lanes(s, &to, p, wants_all);
}

/* Whether nothing from Gaussian i on can come before the first that waits. */
CONIC_INLINE int is_next(const queue *q, size_t i, lanes_mask goes_on) {
  return !lanes_any(goes_on & lanes_less(lanes_load(q->after[i]), lanes_load(q->waiting_z[q->head])));
}

CONIC_INLINE void composite_rays_in_vector(const scene *s, queue *q, size_t n_listed, size_t pixel,
                                           conic_gaussian_shape shape, int wants_all) {
  const size_t n = meet_all(s, q, n_listed, pixel, shape);
  pixels p = take_pixels(s->tile, ~0u, pixel, wants_all);
  lanes farthest = lanes_of(0.0f);
  q->head = q->tail = 0;
  for (size_t i = 0; i < n && lanes_any(p.goes_on); i++) {
    let_wait(q, (uint32_t)i, &farthest);
    for (; q->head < q->tail && is_next(q, i + 1, p.goes_on); q->head++)
      composite_waiting(s, q, &p, wants_all);
  }
  put_pixels(s->tile, &p, pixel, wants_all);
}

CONIC_INLINE void composite_rays_block_by_block(const conic_gaussian_list *list, conic_gaussian_tile *tile,
                                                conic_gaussian_shape shape, int wants_all) {
  const scene s = scene_of(list, tile);
  queue q = queue_in_room(list);
  for (size_t i = 0; i < list->n; i++) {
    const conic_gaussian_footprint *f = &list->footprints[list->entries[i]];
    q.records[i] = record_of(tile, f);
    q.blocks[i] = blocks_of_box(tile, f) & blocks_of_ellipse(&q.records[i], f->half_reach);
  }
  memset(q.blocks + list->n, 0, CONIC_LANES * sizeof *q.blocks);
  for (int block = 0; block < CONIC_GAUSSIAN_BLOCKS; block++) {
    size_t n_listed = list_block(q.blocks, list->n, block, q.listed);
    for (size_t part = 0; part < CONIC_PARTS; part++)
      composite_rays_in_vector(&s, &q, n_listed, (size_t)block * CONIC_GAUSSIAN_BLOCK_PIXELS + part * CONIC_LANES,
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
