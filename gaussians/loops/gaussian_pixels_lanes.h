/* Pixels in registers while Gaussians are composited in them: a vector of a block. */
#pragma once

#include "core/lanes/lanes.h"
#include "gaussians/draw/gaussian_tile.h"

/* Calls a function whose last argument is a constant: what the list wants. */
#define CONIC_BY_WANTS(composite, list, tile, shape)                                                                   \
  do {                                                                                                                 \
    if ((list)->wants == CONIC_GAUSSIAN_ALL)                                                                           \
      composite(list, tile, shape, CONIC_GAUSSIAN_ALL);                                                                \
    else if ((list)->wants == CONIC_GAUSSIAN_DEPTHS)                                                                   \
      composite(list, tile, shape, CONIC_GAUSSIAN_DEPTHS);                                                             \
    else                                                                                                               \
      composite(list, tile, shape, CONIC_GAUSSIAN_COLORS);                                                             \
  } while (0)

/* What of a tile's list does not change. */
typedef struct scene {
  const conic_gaussian_list *list;
  conic_gaussian_tile *tile;
  lanes most, least, greatest;
  lanes stop; /* compositing ends below */
  int falls_to_zero;
} scene;

CONIC_INLINE scene scene_of(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  const conic_gaussian_rules *rules = list->rules;
  return (scene){list,
                 tile,
                 lanes_of(rules->alpha_most),
                 lanes_of(rules->alpha_least),
                 lanes_of(rules->greatest_half_q > 0.0f ? rules->greatest_half_q : __builtin_inff()),
                 rules->is_beyond_stop ? lanes_of_bits(lanes_to_bits(lanes_of(rules->stop)) + 1u)
                                       : lanes_of(rules->stop),
                 rules->fall_end > 0.0f};
}

typedef struct pixels {
  lanes_mask goes_on; /* compositing has not ended */
  lanes surface_z;    /* where the list has it */
  lanes T, rgb[3];
  lanes sum, sum_of_z, inverse_z, median_z, heaviest, normal[3];
  index_lanes count, id, last;
} pixels;

/* Of a Gaussian, at each of them. */
typedef struct response {
  lanes_mask covered;
  lanes alpha, z, color[3], normal[3];
  index_lanes index;
} response;

CONIC_INLINE pixels take_pixels(const scene *s, unsigned going, size_t at, int wants) {
  const conic_gaussian_tile *tile = s->tile;
  const float *surface_z = conic_gaussian_list_surface(s->list, at);
  pixels p = {.goes_on = lanes_mask_of(going),
              .surface_z = surface_z ? lanes_load(surface_z) : lanes_of(0.0f),
              .T = lanes_load(tile->T + at),
              .rgb = {lanes_load(tile->rgb[0] + at), lanes_load(tile->rgb[1] + at), lanes_load(tile->rgb[2] + at)},
              .count = lanes_load_indices(tile->count + at)};
  if (wants == CONIC_GAUSSIAN_COLORS)
    return p;
  p.sum = lanes_load(tile->sum + at);
  p.sum_of_z = lanes_load(tile->sum_of_z + at);
  if (wants != CONIC_GAUSSIAN_ALL)
    return p;
  p.inverse_z = lanes_load(tile->inverse_z + at);
  p.median_z = lanes_load(tile->median_z + at);
  p.heaviest = lanes_load(tile->heaviest + at);
  for (int k = 0; k < 3; k++)
    p.normal[k] = lanes_load(tile->normal[k] + at);
  p.id = lanes_load_indices(tile->id + at);
  p.last = lanes_load_indices(tile->last + at);
  return p;
}

CONIC_INLINE void put_pixels(conic_gaussian_tile *tile, const pixels *p, size_t at, int wants) {
  lanes_store(tile->T + at, p->T);
  for (int k = 0; k < 3; k++)
    lanes_store(tile->rgb[k] + at, p->rgb[k]);
  lanes_store_indices(tile->count + at, p->count);
  if (wants == CONIC_GAUSSIAN_COLORS)
    return;
  lanes_store(tile->sum + at, p->sum);
  lanes_store(tile->sum_of_z + at, p->sum_of_z);
  if (wants != CONIC_GAUSSIAN_ALL)
    return;
  lanes_store(tile->inverse_z + at, p->inverse_z);
  lanes_store(tile->median_z + at, p->median_z);
  lanes_store(tile->heaviest + at, p->heaviest);
  for (int k = 0; k < 3; k++)
    lanes_store(tile->normal[k] + at, p->normal[k]);
  lanes_store_indices(tile->id + at, p->id);
  lanes_store_indices(tile->last + at, p->last);
}

/* What is wanted beside colour and depth. */
CONIC_INLINE void composite_planes_in_lanes(const scene *s, const response *r, lanes_mask goes, lanes w, lanes after,
                                            pixels *p) {
  lanes_mask crosses = goes & lanes_less(lanes_of(0.5f), p->T);
  if (!s->list->rules->has_late_median)
    crosses = crosses & lanes_at_least(lanes_of(0.5f), after);
  p->inverse_z = p->inverse_z + lanes_keep(goes, w / r->z);
  p->median_z = lanes_select(crosses, r->z, p->median_z);
  lanes_mask is_heavier = goes & lanes_less(p->heaviest, w);
  p->heaviest = lanes_select(is_heavier, w, p->heaviest);
  p->id = lanes_select_indices(is_heavier, r->index, p->id);
  p->last = lanes_select_indices(goes, r->index, p->last);
  for (int k = 0; k < 3; k++)
    p->normal[k] = p->normal[k] + lanes_keep(goes, w * r->normal[k]);
}

/* What is before all surfaces. */
CONIC_INLINE void composite_response(const scene *s, const response *r, pixels *p, int wants) {
  const lanes_mask covered = r->covered & p->goes_on;
  lanes after = p->T * (1.0f - r->alpha), w = r->alpha * p->T;
  const lanes_mask ends = lanes_less(after, s->stop);
  const lanes_mask goes = covered & lanes_not(ends);
  p->goes_on = p->goes_on & lanes_not(covered & ends);
  for (int k = 0; k < 3; k++)
    p->rgb[k] = p->rgb[k] + lanes_keep(goes, w * r->color[k]);
  if (wants != CONIC_GAUSSIAN_COLORS) {
    p->sum = p->sum + lanes_keep(goes, w);
    p->sum_of_z = p->sum_of_z + lanes_keep(goes, w * r->z);
  }
  if (wants == CONIC_GAUSSIAN_ALL)
    composite_planes_in_lanes(s, r, goes, w, after, p);
  p->count = lanes_increment(goes, p->count);
  p->T = lanes_select(goes, after, p->T);
}

CONIC_INLINE void composite_lanes(const scene *s, const response *r, pixels *p, int wants) {
  response before = *r;
  if (conic_gaussian_list_surface(s->list, 0))
    before.covered = before.covered & lanes_less(r->z, p->surface_z);
  composite_response(s, &before, p, wants);
}

#ifndef CONIC_ON_DEVICE
/* A number of each lane's own record, at `at` from the base. Without optimisation gcc's intrinsics are macros that it
 * warns of. */
CONIC_INLINE lanes lanes_gather(const float *base, index_lanes at) {
#if defined(__AVX512F__) && defined(__OPTIMIZE__)
  return (lanes)_mm512_i32gather_ps((__m512i)at, base, 4);
#elif defined(__AVX2__) && defined(__OPTIMIZE__)
  return (lanes)_mm256_i32gather_ps(base, (__m256i)at, 4);
#else
  lanes value;
  for (int lane = 0; lane < CONIC_LANES; lane++)
    value[lane] = base[at[lane]];
  return value;
#endif
}
#endif
