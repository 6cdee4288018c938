/* What kernels share that find hits row by row, as many pixels at a time as there are lanes. */
#ifndef CONIC_HITS_LANES_H
#define CONIC_HITS_LANES_H

#include "core/lanes/lanes.h"
#include "gaussians/draw/gaussian_tile.h"

/* The rows, and the first of the columns, that the footprint's box meets in the tile; none where first is over last. */
typedef struct hit_part {
  int first_row, last_row, first_column, last_column;
} hit_part;

CONIC_INLINE hit_part hit_part_of(const conic_gaussian_tile *tile, const conic_gaussian_footprint *f) {
  hit_part p = {f->box[0][1] - tile->y, f->box[1][1] - tile->y, f->box[0][0] - tile->x, f->box[1][0] - tile->x};
  p.first_row = p.first_row > 0 ? p.first_row : 0;
  p.first_column = p.first_column > 0 ? p.first_column / CONIC_LANES * CONIC_LANES : 0;
  p.last_row = p.last_row < CONIC_GAUSSIAN_TILE ? p.last_row : CONIC_GAUSSIAN_TILE - 1;
  p.last_column = p.last_column < CONIC_GAUSSIAN_TILE ? p.last_column : CONIC_GAUSSIAN_TILE - 1;
  return p;
}

/* Columns of the picture, and which of them the footprint's box holds. */
CONIC_INLINE int_lanes hit_columns(const conic_gaussian_tile *tile, const conic_gaussian_footprint *f, int column,
                                   lanes_mask *within) {
  int_lanes x = ints_of_indices(lanes_ascending(0)) + (tile->x + column);
  *within = lanes_not(lanes_less_int(x, lanes_of_int(f->box[0][0]))) &
            lanes_not(lanes_less_int(lanes_of_int(f->box[1][0]), x));
  return x;
}

/* Appends the lanes that the mask has to their pixels' hits. */
CONIC_INLINE void keep_hits(const conic_gaussian_list *list, uint32_t i_footprint, lanes_mask covered, lanes z,
                            lanes alpha, size_t column, size_t *n_hits) {
  float depths[CONIC_LANES], alphas[CONIC_LANES];
  lanes_store(depths, z);
  lanes_store(alphas, alpha);
  for (unsigned bits = lanes_bits(covered); bits; bits &= bits - 1) {
    size_t lane = (size_t)__builtin_ctz(bits), pixel = column + lane;
    list->hits[pixel * list->n + n_hits[pixel]++] = (conic_gaussian_hit){depths[lane], alphas[lane], i_footprint};
  }
}

/* What a row's pixels have found, composited. */
CONIC_INLINE void composite_hit_row(const conic_gaussian_list *list, const size_t *n_hits, conic_gaussian_tile *tile,
                                    int row) {
  for (size_t pixel = 0; pixel < CONIC_GAUSSIAN_TILE; pixel++)
    conic_gaussian_composite_hits(list, list->hits + pixel * list->n, n_hits[pixel], tile,
                                  (size_t)row * CONIC_GAUSSIAN_TILE + pixel);
}

#endif
