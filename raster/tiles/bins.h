/* Which splats may touch which tile. A chunk's records are brought into the order of their tiles, so that what a tile
 * reads lies together; its entries stay in file order. */
#pragma once

#include <stdatomic.h>

#include "raster/tiles/band.h"

struct conic_bin_loops;

typedef struct conic_bins {
  int tile;      /* edge in pixels */
  int tile_bits; /* its binary logarithm */
  int n_tiles_x, n_tiles_y;
  int by_pixels; /* words name pixels, not blocks */
  size_t n_tiles, n_chunks;
  uint32_t *tile_begin; /* [chunk][n_tiles + 1]: where a tile's entries begin among the chunk's */
  size_t *chunk_begin;  /* [chunk]: where the chunk's entries begin */
  size_t *length;       /* [n_tiles]: how many entries a tile has */
  conic_tile_entry *entries;
  size_t n_room;           /* so many entries */
  atomic_size_t n_records; /* of the chunks sorted so far: they lie together, in whatever order */
  atomic_size_t n_used;    /* or needed, where that is more than there is room for */
} conic_bins;

/* What a thread sorts a chunk in: its records as set-up leaves them, and where they go. */
typedef struct conic_sorter {
  conic_projected projected; /* one chunk */
  conic_chunk chunk;
  uint32_t *tile, *word, *beyond;     /* of each record: its key */
  uint32_t *order;                    /* of each place in the order of tiles: the record that goes there */
  uint32_t *next_record, *next_entry; /* [n_tiles] */
} conic_sorter;

/* Where a box goes: the tile that holds its first pixel, the word there, and what is beyond that tile: 0 for most
 * boxes. Bits 0 … 7 and 8 … 15 then are the last column and row, of blocks or pixels, that it meets in the next tile
 * along each axis. */
typedef struct conic_key {
  uint32_t tile, word, beyond;
} conic_key;

#define CONIC_BEYOND_X (UINT32_C(1) << 29)    /* it meets the next tile in x … */
#define CONIC_BEYOND_Y (UINT32_C(1) << 30)    /* … in y … */
#define CONIC_BEYOND_MORE (UINT32_C(1) << 31) /* … and tiles after those. */

static inline conic_key conic_key_of(const conic_box *box, int tile_bits, int n_tiles_x, int by_pixels) {
  uint32_t x_begin = box->x_begin, x_last = box->x_end - 1u, y_begin = box->y_begin, y_last = box->y_end - 1u;
  uint32_t in_tile = (1u << tile_bits) - 1, unit = by_pixels ? 1 : CONIC_BLOCK_EDGE, last = in_tile / unit;
  uint32_t n_x = (x_last >> tile_bits) - (x_begin >> tile_bits), n_y = (y_last >> tile_bits) - (y_begin >> tile_bits);
  uint32_t column = (x_last & in_tile) / unit, row = (y_last & in_tile) / unit;
  conic_key key = {(y_begin >> tile_bits) * (uint32_t)n_tiles_x + (x_begin >> tile_bits), 0, 0};
  key.word = (by_pixels ? conic_pixel_word_of : conic_word_of)((x_begin & in_tile) / unit, n_x ? last : column,
                                                               (y_begin & in_tile) / unit, n_y ? last : row);
  if (n_x || n_y)
    key.beyond = column | row << 8 | (n_x ? CONIC_BEYOND_X : 0) | (n_y ? CONIC_BEYOND_Y : 0) |
                 (n_x > 1 || n_y > 1 ? CONIC_BEYOND_MORE : 0);
  return key;
}

/* The bytes of a sorter for chunks of so many splats; with clip lines if has_clips. */
size_t conic_sorter_bytes(const conic_bins *bins, size_t chunk_size, int has_clips);

/* Points a sorter into `memory`, a multiple of 64, of conic_sorter_bytes. Rays go to `rays` at once. */
void conic_sorter_place(const conic_bins *bins, size_t chunk_size, int has_clips, conic_ray *rays, void *memory,
                        conic_sorter *sorter);

/* Finds the sorter's keys and from them where each tile's records and entries begin: next_record, next_entry and the
 * n_tiles + 1 of tile_begin. Returns how many places the entries need. */
size_t conic_sorter_count(const conic_bins *bins, const struct conic_bin_loops *loops, conic_sorter *sorter,
                          uint32_t *tile_begin);

/* Copies the sorter's chunk to `projected`, in the order of the tiles, as chunk i_chunk, behind the chunks that it has.
 * Makes the chunk's entries, too. Where these have no room, nothing is written, and n_used tells what is needed. */
void conic_bins_sort(conic_bins *bins, const struct conic_bin_loops *loops, conic_sorter *sorter, size_t i_chunk,
                     conic_projected *projected);

/* Finds how many entries each tile has; returns the most. */
size_t conic_bins_measure(conic_bins *bins);

/* Writes a tile's entries, in file order; up to CONIC_GATHER_SLACK more places may be written to. */
void conic_bins_gather(const conic_bins *bins, size_t i_tile, conic_tile_entry *entries);

#define CONIC_GATHER_SLACK 1
