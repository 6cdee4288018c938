#include "raster/tiles/bins.h"

#include "core/base/base.h"
#include "raster/project/clip_lines.h"
#include "raster/tiles/bins_tiles.h"
#include "raster/tiles/tile_loops.h"

size_t conic_sorter_bytes(const conic_bins *bins, size_t chunk_size, int has_clips) {
  size_t n = chunk_size + CONIC_PROJECT_SLACK;
  return conic_memory_rounded(n * sizeof(conic_footprint)) + conic_memory_rounded(n * sizeof(conic_projected_surface)) +
         conic_memory_rounded(n * sizeof(conic_box)) + 4 * conic_memory_rounded(n * sizeof(uint32_t)) +
         2 * conic_memory_rounded((bins->n_tiles + 1) * sizeof(uint32_t)) +
         (has_clips ? conic_memory_rounded(chunk_size * sizeof(conic_clip_record)) : 0);
}

/* Takes so many bytes from what is left of the memory. */
static void *take(char **memory, size_t bytes) {
  void *taken = *memory;
  *memory += conic_memory_rounded(bytes);
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

static __attribute__((noinline)) void count_beyond(const conic_bins *bins, const conic_sorter *sorter, size_t i) {
  uint32_t tiles[3];
  if (__builtin_expect(!(sorter->beyond[i] & CONIC_BEYOND_MORE), 1)) {
    conic_tiles_beyond(bins, sorter->tile[i], sorter->beyond[i], tiles);
    for (int k = 0; k < 3; k++)
      sorter->next_entry[tiles[k]]++;
    return;
  }
  conic_tile_range range = conic_tiles_of(bins->tile_bits, &sorter->projected.boxes[i]);
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

/* The clip lines of the records that are marked. */
static void copy_clips(const conic_sorter *sorter, size_t first, conic_projected *to) {
  const conic_projected *from = &sorter->projected;
  for (size_t at = 0; from->clips && at < sorter->chunk.n_drawn; at++)
    if (conic_is_clipped(&from->footprints[sorter->order[at]]))
      to->clips[first + at] = from->clips[sorter->order[at]];
}

size_t conic_sorter_count(const conic_bins *bins, const conic_bin_loops *loops, conic_sorter *sorter,
                          uint32_t *tile_begin) {
  loops->keys(sorter->projected.boxes, sorter->chunk.n_drawn, bins->tile_bits, bins->n_tiles_x, bins->by_pixels,
              sorter->tile, sorter->word, sorter->beyond);
  count(bins, sorter);
  return place(bins, sorter, tile_begin) + (size_t)1; /* one place behind all */
}

void conic_bins_sort(conic_bins *bins, const conic_bin_loops *loops, conic_sorter *sorter, size_t i_chunk,
                     conic_projected *projected) {
  conic_chunk *chunk = &projected->chunks[i_chunk];
  size_t first = atomic_fetch_add(&bins->n_records, sorter->chunk.n_drawn);
  size_t n_entries = conic_sorter_count(bins, loops, sorter, bins->tile_begin + i_chunk * (bins->n_tiles + 1));
  size_t begin = atomic_fetch_add(&bins->n_used, n_entries);
  *chunk = sorter->chunk;
  chunk->first = first;
  bins->chunk_begin[i_chunk] = begin;
  if (begin + n_entries > bins->n_room)
    return;
  loops->sort(bins, sorter, first, bins->entries + begin, &projected->footprints[first], &projected->surfaces[first]);
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
