/* Which splats may touch which tile. A chunk's records are brought into the order of their tiles, so that what a tile
 * reads lies together; its entries stay in file order. */
#ifndef RASTER_BINS_H
#define RASTER_BINS_H

#include <stdatomic.h>

#include "raster/band.h"

struct conic_tile_kernels;

typedef struct conic_bins {
  int tile;      /* edge in pixels */
  int tile_bits; /* its binary logarithm */
  int n_tiles_x, n_tiles_y;
  size_t n_tiles, n_chunks;
  uint32_t *tile_begin; /* [chunk][n_tiles + 1]: where a tile's entries begin among the chunk's */
  size_t *chunk_begin;  /* [chunk]: where the chunk's entries begin */
  conic_tile_entry *entries;
  size_t n_room;        /* so many entries */
  atomic_size_t n_used; /* or needed, where that is more than there is room for */
} conic_bins;

/* What a thread sorts a chunk in: its records as set-up leaves them, and where they go. */
typedef struct conic_sorter {
  conic_projected projected; /* one chunk */
  conic_chunk chunk;
  uint32_t *tile, *word;              /* of each record: as conic_key_of */
  uint32_t *order;                    /* of each place in the order of tiles: the record that goes there */
  uint32_t *next_record, *next_entry; /* [n_tiles] */
} conic_sorter;

/* The tile that holds a box's first pixel; and the word of its entry where that is all the tiles it meets, else 0. */
static inline void conic_key_of(const conic_box *box, int tile_bits, int n_tiles_x, uint32_t *tile, uint32_t *word) {
  uint32_t x_begin = box->x_begin, x_last = box->x_end - 1u, y_begin = box->y_begin, y_last = box->y_end - 1u;
  uint32_t in_tile = (1u << tile_bits) - 1;
  *tile = (y_begin >> tile_bits) * (uint32_t)n_tiles_x + (x_begin >> tile_bits);
  *word = 0;
  if (((x_begin ^ x_last) | (y_begin ^ y_last)) >> tile_bits == 0)
    *word = conic_word_of((x_begin & in_tile) / CONIC_BLOCK_EDGE, (x_last & in_tile) / CONIC_BLOCK_EDGE,
                          (y_begin & in_tile) / CONIC_BLOCK_EDGE, (y_last & in_tile) / CONIC_BLOCK_EDGE);
}

/* The bytes of a sorter for chunks of so many splats; with clip lines if has_clips. */
size_t conic_sorter_bytes(const conic_bins *bins, size_t chunk_size, int has_clips);

/* Points a sorter into `memory`, a multiple of 64, of conic_sorter_bytes. Rays go to `rays` at once. */
void conic_sorter_place(const conic_bins *bins, size_t chunk_size, int has_clips, conic_ray *rays, void *memory,
                        conic_sorter *sorter);

/* Copies the sorter's chunk to `projected`, in the order of the tiles, as chunk i_chunk, whose `first` is set; and
 * makes its entries. Where these have no room, nothing is written, and n_used tells what is needed. */
void conic_bins_sort(conic_bins *bins, const struct conic_tile_kernels *kernels, conic_sorter *sorter, size_t i_chunk,
                     conic_projected *projected);

/* How many entries a tile has. */
size_t conic_bins_length(const conic_bins *bins, size_t i_tile);

/* Writes them to `entries`, in file order. */
void conic_bins_gather(const conic_bins *bins, size_t i_tile, conic_tile_entry *entries);

#endif
