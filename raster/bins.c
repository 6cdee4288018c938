#include "raster/bins.h"

#include <string.h>

#include "raster/clip_lines.h"
#include "raster/tile_kernels.h"

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

/* The first and the last of a tile's pixels, along one axis, that are among begin … end - 1. */
static uint32_t first_pixel(int begin, int tile_begin) {
  return begin > tile_begin ? (uint32_t)(begin - tile_begin) : 0;
}

static uint32_t last_pixel(int end, int tile_begin, int tile) {
  return (uint32_t)(end - 1 < tile_begin + tile - 1 ? end - 1 - tile_begin : tile - 1);
}

/* The word of a box in the tile at (x, y). */
static uint32_t word_in(const conic_bins *bins, const conic_box *box, int x, int y) {
  int tile = bins->tile, left = x * tile, top = y * tile;
  uint32_t first = first_pixel(box->x_begin, left), last = last_pixel(box->x_end, left, tile);
  uint32_t first_row = first_pixel(box->y_begin, top), last_row = last_pixel(box->y_end, top, tile);
  if (bins->by_pixels)
    return conic_pixel_word_of(first, last, first_row, last_row);
  return conic_word_of(first / CONIC_BLOCK_EDGE, last / CONIC_BLOCK_EDGE, first_row / CONIC_BLOCK_EDGE,
                       last_row / CONIC_BLOCK_EDGE);
}

static size_t rounded(size_t bytes) {
  return (bytes + 63) / 64 * 64;
}

size_t conic_sorter_bytes(const conic_bins *bins, size_t chunk_size, int has_clips) {
  size_t n = chunk_size + CONIC_PROJECT_SLACK;
  return rounded(n * sizeof(conic_footprint)) + rounded(n * sizeof(conic_surface)) + rounded(n * sizeof(conic_box)) +
         4 * rounded(n * sizeof(uint32_t)) + 2 * rounded((bins->n_tiles + 1) * sizeof(uint32_t)) +
         (has_clips ? rounded(chunk_size * sizeof(conic_clip_record)) : 0);
}

/* Takes so many bytes from what is left of the memory. */
static void *take(char **memory, size_t bytes) {
  void *taken = *memory;
  *memory += rounded(bytes);
  return taken;
}

void conic_sorter_place(const conic_bins *bins, size_t chunk_size, int has_clips, conic_ray *rays, void *memory,
                        conic_sorter *sorter) {
  size_t n = chunk_size + CONIC_PROJECT_SLACK;
  char *left = memory;
  conic_projected *projected = &sorter->projected;
  memset(sorter, 0, sizeof *sorter);
  projected->n_chunks = 1;
  projected->chunk_size = chunk_size;
  projected->chunks = &sorter->chunk;
  projected->rays = rays;
  projected->footprints = take(&left, n * sizeof *projected->footprints);
  projected->surfaces = take(&left, n * sizeof *projected->surfaces);
  projected->boxes = take(&left, n * sizeof *projected->boxes);
  sorter->tile = take(&left, n * sizeof(uint32_t));
  sorter->word = take(&left, n * sizeof(uint32_t));
  sorter->beyond = take(&left, n * sizeof(uint32_t));
  sorter->order = take(&left, n * sizeof(uint32_t));
  sorter->next_record = take(&left, (bins->n_tiles + 1) * sizeof(uint32_t));
  sorter->next_entry = take(&left, (bins->n_tiles + 1) * sizeof(uint32_t));
  if (has_clips)
    projected->clips = take(&left, chunk_size * sizeof *projected->clips);
}

/* The tiles beyond a record's home, the next in x, in y and in both; n_tiles for those that it does not meet. It is no
 * matter of branches, which could not foresee them. */
static inline void tiles_beyond(const conic_bins *bins, uint32_t home, uint32_t beyond, uint32_t tiles[3]) {
  uint32_t none = (uint32_t)bins->n_tiles, below = home + (uint32_t)bins->n_tiles_x;
  tiles[0] = beyond & CONIC_BEYOND_X ? home + 1 : none;
  tiles[1] = beyond & CONIC_BEYOND_Y ? below : none;
  tiles[2] = (beyond & CONIC_BEYOND_X) && (beyond & CONIC_BEYOND_Y) ? below + 1 : none;
}

static __attribute__((noinline)) void count_beyond(const conic_bins *bins, const conic_sorter *sorter, size_t i) {
  uint32_t tiles[3];
  if (__builtin_expect(!(sorter->beyond[i] & CONIC_BEYOND_MORE), 1)) {
    tiles_beyond(bins, sorter->tile[i], sorter->beyond[i], tiles);
    for (int k = 0; k < 3; k++)
      sorter->next_entry[tiles[k]]++;
    return;
  }
  tile_range range = tiles_of(bins, &sorter->projected.boxes[i]);
  for (int y = range.y_begin; y < range.y_end; y++)
    for (int x = range.x_begin; x < range.x_end; x++)
      sorter->next_entry[y * bins->n_tiles_x + x] += x != range.x_begin || y != range.y_begin;
}

/* Counts records by their tile, and the entries of other tiles. */
static void count(const conic_bins *bins, const conic_sorter *sorter) {
  uint32_t *next_record = sorter->next_record;
  memset(next_record, 0, (bins->n_tiles + 1) * sizeof *next_record);
  memset(sorter->next_entry, 0, (bins->n_tiles + 1) * sizeof *sorter->next_entry);
  for (size_t i = 0, n = sorter->chunk.n_drawn; i < n; i++) {
    next_record[sorter->tile[i]]++;
    if (__builtin_expect(sorter->beyond[i] != 0, 0))
      count_beyond(bins, sorter, i);
  }
}

/* Turns counts into places; returns how many entries there are. */
static uint32_t place(const conic_bins *bins, conic_sorter *sorter, uint32_t *tile_begin) {
  uint32_t n_records = 0, n_entries = 0;
  for (size_t i_tile = 0; i_tile < bins->n_tiles; i_tile++) {
    uint32_t records = sorter->next_record[i_tile], entries = records + sorter->next_entry[i_tile];
    sorter->next_record[i_tile] = n_records;
    sorter->next_entry[i_tile] = tile_begin[i_tile] = n_entries;
    n_records += records;
    n_entries += entries;
  }
  tile_begin[bins->n_tiles] = sorter->next_entry[bins->n_tiles] = n_entries;
  return n_entries;
}

/* The entries of a record in all of its tiles, which are many. Kept out of the loop, which needs the registers. */
static __attribute__((noinline)) void enter_all(const conic_bins *bins, const conic_box *box, uint32_t i_record,
                                                uint32_t *next, conic_tile_entry *entries) {
  tile_range range = tiles_of(bins, box);
  for (int y = range.y_begin; y < range.y_end; y++)
    for (int x = range.x_begin; x < range.x_end; x++)
      entries[next[y * bins->n_tiles_x + x]++] = (conic_tile_entry){i_record, word_in(bins, box, x, y)};
}

/* Those beyond its home; what it does not meet is written to the place behind all. */
static __attribute__((noinline)) void enter_beyond(const conic_bins *bins, const conic_sorter *sorter, size_t i,
                                                   uint32_t i_record, conic_tile_entry *entries) {
  uint32_t *next = sorter->next_entry, tiles[3], word = sorter->word[i], beyond = sorter->beyond[i];
  uint32_t columns = (beyond & 0xff) << 8, last_row = beyond >> 8 & 0xff;
  uint32_t rows = bins->by_pixels ? last_row << 24 : ((UINT32_C(2) << last_row) - 1) << 16;
  uint32_t words[3] = {columns | (word & 0xffff0000), (word & 0xffff) | rows, columns | rows};
  tiles_beyond(bins, sorter->tile[i], beyond, tiles);
  for (int k = 0; k < 3; k++) {
    entries[next[tiles[k]]] = (conic_tile_entry){i_record, words[k]};
    next[tiles[k]] += tiles[k] < bins->n_tiles;
  }
}

/* Finds each record's place, and makes the entries that refer to it. */
static void enter(const conic_bins *bins, const conic_sorter *sorter, size_t first, conic_tile_entry *entries) {
  uint32_t *next_record = sorter->next_record, *next_entry = sorter->next_entry, *order = sorter->order;
  const uint32_t *tile = sorter->tile, *word = sorter->word, *beyond = sorter->beyond;
  for (size_t i = 0, n = sorter->chunk.n_drawn; i < n; i++) {
    uint32_t at = next_record[tile[i]]++, i_record = (uint32_t)first + at;
    order[at] = (uint32_t)i;
    if (__builtin_expect((beyond[i] & CONIC_BEYOND_MORE) != 0, 0)) {
      enter_all(bins, &sorter->projected.boxes[i], i_record, next_entry, entries);
      continue;
    }
    entries[next_entry[tile[i]]++] = (conic_tile_entry){i_record, word[i]};
    if (__builtin_expect(beyond[i] != 0, 0))
      enter_beyond(bins, sorter, i, i_record, entries);
  }
}

/* The clip lines of the records that are marked. */
static void copy_clips(const conic_sorter *sorter, size_t first, conic_projected *to) {
  const conic_projected *from = &sorter->projected;
  for (size_t at = 0; from->clips && at < sorter->chunk.n_drawn; at++)
    if (conic_is_clipped(&from->footprints[sorter->order[at]]))
      to->clips[first + at] = from->clips[sorter->order[at]];
}

void conic_bins_sort(conic_bins *bins, const conic_tile_kernels *kernels, conic_sorter *sorter, size_t i_chunk,
                     conic_projected *projected) {
  conic_chunk *chunk = &projected->chunks[i_chunk];
  size_t first = atomic_fetch_add(&bins->n_records, sorter->chunk.n_drawn);
  kernels->keys(sorter->projected.boxes, sorter->chunk.n_drawn, bins->tile_bits, bins->n_tiles_x, bins->by_pixels,
                sorter->tile, sorter->word, sorter->beyond);
  count(bins, sorter);
  size_t n_entries = place(bins, sorter, bins->tile_begin + i_chunk * (bins->n_tiles + 1));
  n_entries++; /* one place behind all */
  size_t begin = atomic_fetch_add(&bins->n_used, n_entries);
  *chunk = sorter->chunk;
  chunk->first = first;
  bins->chunk_begin[i_chunk] = begin;
  if (begin + n_entries > bins->n_room)
    return;
  enter(bins, sorter, first, bins->entries + begin);
  kernels->move(&sorter->projected, sorter->order, chunk->n_drawn, &projected->footprints[first],
                &projected->surfaces[first]);
  copy_clips(sorter, first, projected);
}

size_t conic_bins_measure(conic_bins *bins) {
  size_t greatest = 0;
  memset(bins->length, 0, bins->n_tiles * sizeof *bins->length);
  for (size_t i = 0; i < bins->n_chunks; i++) {
    const uint32_t *begin = bins->tile_begin + i * (bins->n_tiles + 1);
    for (size_t i_tile = 0; i_tile < bins->n_tiles; i_tile++)
      bins->length[i_tile] += begin[i_tile + 1] - begin[i_tile];
  }
  for (size_t i_tile = 0; i_tile < bins->n_tiles; i_tile++)
    greatest = bins->length[i_tile] > greatest ? bins->length[i_tile] : greatest;
  return greatest;
}

void conic_bins_gather(const conic_bins *bins, size_t i_tile, conic_tile_entry *entries) {
  for (size_t i = 0; i < bins->n_chunks; i++) {
    const uint32_t *begin = bins->tile_begin + i * (bins->n_tiles + 1) + i_tile;
    const conic_tile_entry *from = bins->entries + bins->chunk_begin[i] + begin[0];
    size_t n = begin[1] - begin[0];
    /* Pairs in place of a call: a chunk has some dozen entries in a tile. There is a place behind all. */
    for (size_t k = 0; k < n; k += 2)
      memcpy(entries + k, from + k, 2 * sizeof *entries);
    entries += n;
  }
}
