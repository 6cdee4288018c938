/* Which tiles a box meets, and by which words: what counting and sorting ask alike. */
#pragma once

#include "raster/tiles/bins.h"

/* The tiles of 2^shift pixels that a box touches. */
typedef struct conic_tile_range {
  int x_begin, x_end, y_begin, y_end;
} conic_tile_range;

static inline conic_tile_range conic_tiles_of(int shift, const conic_box *box) {
  conic_tile_range range = {box->x_begin >> shift, ((box->x_end - 1) >> shift) + 1, box->y_begin >> shift,
                            ((box->y_end - 1) >> shift) + 1};
  return range;
}

/* The first and the last of a tile's pixels, along one axis, that are among begin … end - 1. */
static inline uint32_t conic_first_pixel(int begin, int tile_begin) {
  return begin > tile_begin ? (uint32_t)(begin - tile_begin) : 0;
}

static inline uint32_t conic_last_pixel(int end, int tile_begin, int tile) {
  return (uint32_t)(end - 1 < tile_begin + tile - 1 ? end - 1 - tile_begin : tile - 1);
}

/* The word of a box in the tile at (x, y). */
static inline uint32_t conic_word_in(const conic_bins *bins, const conic_box *box, int x, int y) {
  int tile = bins->tile, left = x * tile, top = y * tile;
  uint32_t first = conic_first_pixel(box->x_begin, left), last = conic_last_pixel(box->x_end, left, tile);
  uint32_t first_row = conic_first_pixel(box->y_begin, top), last_row = conic_last_pixel(box->y_end, top, tile);
  if (bins->by_pixels)
    return conic_pixel_word_of(first, last, first_row, last_row);
  return conic_word_of(first / CONIC_BLOCK_EDGE, last / CONIC_BLOCK_EDGE, first_row / CONIC_BLOCK_EDGE,
                       last_row / CONIC_BLOCK_EDGE);
}

/* The tiles beyond a record's home, the next in x, in y and in both. One that it does not meet is n_tiles. There are no
 * branches, because no machine could foresee them. */
static inline void conic_tiles_beyond(const conic_bins *bins, uint32_t home, uint32_t beyond, uint32_t tiles[3]) {
  uint32_t none = (uint32_t)bins->n_tiles, below = home + (uint32_t)bins->n_tiles_x;
  tiles[0] = beyond & CONIC_BEYOND_X ? home + 1 : none;
  tiles[1] = beyond & CONIC_BEYOND_Y ? below : none;
  tiles[2] = (beyond & CONIC_BEYOND_X) && (beyond & CONIC_BEYOND_Y) ? below + 1 : none;
}
