/* A tile's list, cut up by blocks of 4 × 4 pixels: which of them a Gaussian may cover, and what it needs there. */
#pragma once

#include "core/lanes/lanes.h"
#include "gaussians/draw/gaussian_tile.h"

/* A footprint as a tile sees it: a line of the cache. */
typedef struct gaussian_record {
  float x, y; /* from the footprint's pixel to the tile's first */
  float dx, dy, form[3], opacity, z, color[3];
  float first[2], last[2]; /* of its box, from the tile's first pixel */
} gaussian_record;

CONIC_INLINE gaussian_record record_of(const conic_gaussian_tile *tile,
                                       const CONIC_STORED conic_gaussian_footprint *f) {
  return (gaussian_record){(float)(tile->x - f->x),
                           (float)(tile->y - f->y),
                           f->dx,
                           f->dy,
                           {f->form[0], f->form[1], f->form[2]},
                           f->opacity,
                           f->z,
                           {f->color[0], f->color[1], f->color[2]},
                           {(float)((int)f->box[0][0] - tile->x), (float)((int)f->box[0][1] - tile->y)},
                           {(float)((int)f->box[1][0] - tile->x), (float)((int)f->box[1][1] - tile->y)}};
}

/* The pixels of a vector, from the tile's first. */
typedef struct places {
  lanes column, row;
} places;

CONIC_INLINE places places_at(size_t pixel) {
  return (places){lanes_of_ints(lanes_columns() + conic_gaussian_column(pixel)),
                  lanes_of_ints(lanes_rows() + conic_gaussian_row(pixel))};
}

CONIC_INLINE lanes_mask within_box(const gaussian_record *r, places at) {
  return lanes_at_least(at.column, lanes_of(r->first[0])) & lanes_at_least(lanes_of(r->last[0]), at.column) &
         lanes_at_least(at.row, lanes_of(r->first[1])) & lanes_at_least(lanes_of(r->last[1]), at.row);
}

/* The blocks that a box meets, as bits. */
CONIC_INLINE unsigned blocks_of_box(const conic_gaussian_tile *tile, const CONIC_STORED conic_gaussian_footprint *f) {
  int first_column = (int)f->box[0][0] - tile->x, last_column = (int)f->box[1][0] - tile->x;
  int first_row = (int)f->box[0][1] - tile->y, last_row = (int)f->box[1][1] - tile->y;
  unsigned columns = 0xfu, rows = 0xffffu;
  if (first_column > 0)
    columns &= 0xfu << first_column / CONIC_GAUSSIAN_BLOCK;
  if (last_column < CONIC_GAUSSIAN_TILE)
    columns &= 0xfu >> (3 - last_column / CONIC_GAUSSIAN_BLOCK);
  if (first_row > 0)
    rows &= 0xffffu << first_row / CONIC_GAUSSIAN_BLOCK * 4;
  if (last_row < CONIC_GAUSSIAN_TILE)
    rows &= 0xffffu >> (3 - last_row / CONIC_GAUSSIAN_BLOCK) * 4;
  return columns * 0x1111u & rows;
}

/* Those of them in which half_q may come down to `half_reach`. It is convex, so that its gradient at the block's middle
 * tells what it is at least; what the roundings of all that can be is well below 2⁻¹⁸ of the terms. Not a number, or an
 * ellipse of zeros, leaves out none. */
CONIC_INLINE unsigned blocks_of_ellipse(const gaussian_record *r, float half_reach) {
  const float half = 0.5f * (CONIC_GAUSSIAN_BLOCK - 1);
  unsigned met = 0;
  for (int first = 0; first < CONIC_GAUSSIAN_BLOCKS; first += CONIC_LANES) {
    const int_lanes block = ints_of_indices(lanes_ascending((uint32_t)first));
    lanes x = (lanes_of_ints(block % 4 * 4) + (half + r->x)) + r->dx;
    lanes y = (lanes_of_ints(block / 4 * 4) + (half + r->y)) + r->dy;
    lanes by_x = r->form[0] * x + r->form[1] * y, by_y = r->form[1] * x + r->form[2] * y;
    lanes least = 0.5f * (by_x * x + by_y * y) - half * (lanes_absolute(by_x) + lanes_absolute(by_y));
    lanes far_x = lanes_absolute(x) + half, far_y = lanes_absolute(y) + half;
    lanes terms = r->form[0] * far_x * far_x + r->form[2] * far_y * far_y;
    met |= lanes_bits(lanes_not(lanes_less(half_reach + 0x1p-18f * terms, least))) << first;
  }
  return met & 0xffffu;
}

/* Entry i's footprint, where they are taken in order; asks for those that follow, since they lie all over the memory.
 */
CONIC_INLINE const CONIC_STORED conic_gaussian_footprint *footprint_of_entry(const conic_gaussian_list *list,
                                                                             size_t i) {
  enum { AHEAD = 32 };
  for (size_t next = i > 0 ? i + AHEAD : 1; next < list->n && next <= i + AHEAD; next++)
    __builtin_prefetch(&list->footprints[list->entries[next]]);
  return &list->footprints[list->entries[i]];
}

/* Which of n entries have the block's bit. */
CONIC_INLINE size_t list_block(const uint32_t *blocks, size_t n, int block, uint32_t *listed) {
  size_t n_listed = 0;
  for (size_t i = 0; i < n; i += CONIC_LANES) /* what is behind the last has no bits */
    n_listed += lanes_append(listed + n_listed, lanes_has_bits(lanes_load_indices(blocks + i), 1u << block),
                             lanes_ascending((uint32_t)i));
  return n_listed;
}
