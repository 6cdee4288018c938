#include "raster/bins.h"

#include <string.h>

/* The tiles that a box touches. */
typedef struct tile_range {
  int x_begin, x_end, y_begin, y_end;
} tile_range;

static tile_range tiles_of(const conic_bins *bins, const conic_box *box) {
  int shift = bins->tile_bits;
  tile_range range = {box->x_begin >> shift, ((box->x_end - 1) >> shift) + 1, box->y_begin >> shift,
                      ((box->y_end - 1) >> shift) + 1};
  return range;
}

/* Most splats are in one tile. */
static int is_single(const tile_range *range) {
  return range->x_end - range->x_begin == 1 && range->y_end - range->y_begin == 1;
}

void conic_bins_count(conic_bins *bins, const conic_projected *projected, size_t i_chunk) {
  const conic_chunk *chunk = &projected->chunks[i_chunk];
  uint32_t *counts = bins->counts + i_chunk * bins->n_tiles;
  memset(counts, 0, bins->n_tiles * sizeof *counts);
  for (size_t i = 0; i < chunk->n_drawn; i++) {
    tile_range range = tiles_of(bins, &projected->boxes[chunk->first + i]);
    if (is_single(&range)) {
      counts[range.y_begin * bins->n_tiles_x + range.x_begin]++;
      continue;
    }
    for (int y = range.y_begin; y < range.y_end; y++)
      for (int x = range.x_begin; x < range.x_end; x++)
        counts[y * bins->n_tiles_x + x]++;
  }
}

size_t conic_bins_place(conic_bins *bins, const conic_projected *projected) {
  size_t total = 0;
  for (size_t i_tile = 0; i_tile < bins->n_tiles; i_tile++) {
    uint32_t in_tile = 0;
    bins->tile_begin[i_tile] = total;
    for (size_t i_chunk = 0; i_chunk < projected->n_chunks; i_chunk++) {
      uint32_t *count = &bins->counts[i_chunk * bins->n_tiles + i_tile];
      uint32_t of_chunk = *count;
      *count = in_tile;
      in_tile += of_chunk;
    }
    total += in_tile;
  }
  bins->tile_begin[bins->n_tiles] = total;
  return total;
}

/* Bits first … last of 16: blocks of a tile. */
static uint32_t bits(int first, int last) {
  return (UINT32_C(2) << last) - (UINT32_C(1) << first);
}

/* The blocks of a tile, along one axis, that the pixels begin … end - 1 meet. */
static uint32_t blocks_met(int begin, int end, int tile_begin, int tile) {
  int first = begin > tile_begin ? begin - tile_begin : 0;
  int last = end - 1 < tile_begin + tile - 1 ? end - 1 - tile_begin : tile - 1;
  return bits(first / 4, last / 4);
}

/* Appends a footprint to the list of tile (x, y). */
static inline void refer(const conic_bins *bins, uint32_t *next, size_t i, int x, int y, uint32_t word) {
  size_t i_tile = (size_t)y * (size_t)bins->n_tiles_x + (size_t)x;
  bins->references[bins->tile_begin[i_tile] + next[i_tile]++] = (conic_tile_entry){(uint32_t)i, word};
}

/* The word of a box within one tile. */
static inline uint32_t single_word(const conic_bins *bins, const conic_box *box) {
  int in_tile = bins->tile - 1;
  return bits((box->x_begin & in_tile) >> 2, ((box->x_end - 1) & in_tile) >> 2) |
         bits((box->y_begin & in_tile) >> 2, ((box->y_end - 1) & in_tile) >> 2) << 16;
}

static void refer_to_all(const conic_bins *bins, uint32_t *next, const conic_box *box, size_t i,
                         const tile_range *range) {
  for (int y = range->y_begin; y < range->y_end; y++)
    for (int x = range->x_begin; x < range->x_end; x++)
      refer(bins, next, i, x, y,
            blocks_met(box->x_begin, box->x_end, x * bins->tile, bins->tile) |
                blocks_met(box->y_begin, box->y_end, y * bins->tile, bins->tile) << 16);
}

void conic_bins_fill(conic_bins *bins, const conic_projected *projected, size_t i_chunk) {
  const conic_bins own = *bins; /* what is stored could be anything of theirs, as far as a compiler can tell */
  const conic_chunk *chunk = &projected->chunks[i_chunk];
  uint32_t *next = own.counts + i_chunk * own.n_tiles;
  for (size_t i = chunk->first, end = chunk->first + chunk->n_drawn; i < end; i++) {
    const conic_box *box = &projected->boxes[i];
    tile_range range = tiles_of(&own, box);
    if (is_single(&range))
      refer(&own, next, i, range.x_begin, range.y_begin, single_word(&own, box));
    else
      refer_to_all(&own, next, box, i, &range);
  }
}
