/* A chunk's records into the order of their tiles, with their entries. Included by the tables of loops, which define
 * how stream_record copies half a cache line or a whole one, both so aligned, past the caches. */
#include "raster/tiles/bins_tiles.h"

/* The entries of a record in all of its tiles, which are many. Kept out of the loop, which needs the registers. */
static __attribute__((noinline)) void enter_all(const conic_bins *bins, const conic_box *box, uint32_t i_record,
                                                uint32_t *next, conic_tile_entry *entries) {
  conic_tile_range range = conic_tiles_of(bins->tile_bits, box);
  for (int y = range.y_begin; y < range.y_end; y++)
    for (int x = range.x_begin; x < range.x_end; x++)
      entries[next[y * bins->n_tiles_x + x]++] = (conic_tile_entry){i_record, conic_word_in(bins, box, x, y)};
}

/* Those beyond its home; what it does not meet is written to the place behind all. */
static __attribute__((noinline)) void enter_beyond(const conic_bins *bins, const conic_sorter *sorter, size_t i,
                                                   uint32_t i_record, conic_tile_entry *entries) {
  uint32_t *next = sorter->next_entry, tiles[3], word = sorter->word[i], beyond = sorter->beyond[i];
  uint32_t columns = (beyond & 0xff) << 8, last_row = beyond >> 8 & 0xff;
  uint32_t rows = bins->by_pixels ? last_row << 24 : ((UINT32_C(2) << last_row) - 1) << 16;
  uint32_t words[3] = {columns | (word & 0xffff0000), (word & 0xffff) | rows, columns | rows};
  conic_tiles_beyond(bins, sorter->tile[i], beyond, tiles);
  for (int k = 0; k < 3; k++) {
    entries[next[tiles[k]]] = (conic_tile_entry){i_record, words[k]};
    next[tiles[k]] += tiles[k] < bins->n_tiles;
  }
}

/* Finds each record's place, copies its footprint there, and makes the entries that refer to it. */
static void enter(const conic_bins *bins, const conic_sorter *sorter, size_t first, conic_tile_entry *entries,
                  conic_footprint *footprints) {
  uint32_t *next_record = sorter->next_record, *next_entry = sorter->next_entry, *order = sorter->order;
  const uint32_t *tile = sorter->tile, *word = sorter->word, *beyond = sorter->beyond;
  for (size_t i = 0, n = sorter->chunk.n_drawn; i < n; i++) {
    uint32_t at = next_record[tile[i]]++, i_record = (uint32_t)first + at;
    order[at] = (uint32_t)i;
    stream_record(&footprints[at], &sorter->projected.footprints[i], sizeof *footprints);
    if (__builtin_expect((beyond[i] & CONIC_BEYOND_MORE) != 0, 0)) {
      enter_all(bins, &sorter->projected.boxes[i], i_record, next_entry, entries);
      continue;
    }
    entries[next_entry[tile[i]]++] = (conic_tile_entry){i_record, word[i]};
    if (__builtin_expect(beyond[i] != 0, 0))
      enter_beyond(bins, sorter, i, i_record, entries);
  }
}

/* Past the caches: a frame's records are more than they hold. Footprints, whole cache lines, go wherever their place is
 * while entries are made; of surfaces two share a line, and follow in the order of their places. */
static void sort(const conic_bins *bins, conic_sorter *sorter, size_t first, conic_tile_entry *entries,
                 conic_footprint *footprints, conic_projected_surface *surfaces) {
  enter(bins, sorter, first, entries, footprints);
  for (size_t i = 0, n = sorter->chunk.n_drawn; i < n; i++)
    stream_record(&surfaces[i], &sorter->projected.surfaces[sorter->order[i]], sizeof *surfaces);
  conic_stream_fence();
}
