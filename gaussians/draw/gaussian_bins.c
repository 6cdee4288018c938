/* A counting sort by tile, share by share of the footprints: each share counts, the counts become places, each share
 * puts its entries there. Then each tile's list, which fits into a cache, is sorted by itself. So the order within a
 * tile is the same whatever the threads. */
#include "gaussians/draw/gaussian_bins.h"

#include "core/base/base.h"
#include "core/base/radix.h"

typedef struct bin_job {
  const conic_gaussian_runs *runs;
  size_t a_share, n_shares; /* runs */
  conic_gaussian_bins *bins;
  size_t *places; /* n_shares × n_tiles: counts, then places */
} bin_job;

/* Of the window's tiles along an axis, the first that a box meets, and where it ends. */
static size_t first_in(size_t first_pixel, size_t first_tile) {
  size_t tile = first_pixel / CONIC_GAUSSIAN_TILE;
  return tile > first_tile ? tile - first_tile : 0;
}

static size_t end_in(size_t last_pixel, size_t first_tile, size_t n_tiles) {
  size_t end = last_pixel / CONIC_GAUSSIAN_TILE + 1 - first_tile;
  return end < n_tiles ? end : n_tiles;
}

static int meets_window(const conic_gaussian_footprint *f, const conic_gaussian_bins *bins) {
  const size_t first[2] = {bins->first_x, bins->first_y}, n[2] = {bins->n_tiles_x, bins->n_tiles / bins->n_tiles_x};
  for (int axis = 0; axis < 2; axis++)
    if (f->box[0][axis] / CONIC_GAUSSIAN_TILE >= first[axis] + n[axis] ||
        f->box[1][axis] / CONIC_GAUSSIAN_TILE < first[axis])
      return 0;
  return 1;
}

static void visit(const bin_job *j, size_t i_share, size_t i_footprint, int writes) {
  const conic_gaussian_footprint *f = &j->runs->footprints[i_footprint];
  const conic_gaussian_bins *bins = j->bins;
  size_t *places = &j->places[i_share * bins->n_tiles];
  if (!meets_window(f, bins))
    return;
  const size_t x_begin = first_in(f->box[0][0], bins->first_x),
               x_end = end_in(f->box[1][0], bins->first_x, bins->n_tiles_x);
  const size_t y_begin = first_in(f->box[0][1], bins->first_y),
               y_end = end_in(f->box[1][1], bins->first_y, bins->n_tiles / bins->n_tiles_x);
  for (size_t y = y_begin; y < y_end; y++)
    for (size_t x = x_begin; x < x_end; x++) {
      size_t *place = &places[y * bins->n_tiles_x + x];
      if (writes)
        bins->entries[*place] = (uint32_t)i_footprint;
      ++*place;
    }
}

static void visit_share(const bin_job *j, size_t i_share, int writes) {
  const conic_gaussian_runs *runs = j->runs;
  for (size_t run = i_share * j->a_share; run < (i_share + 1) * j->a_share && run < runs->n_runs; run++)
    for (size_t i = 0; i < runs->n_of_run[run]; i++)
      visit(j, i_share, run * runs->a_run + i, writes);
}

static void count_share(void *data, size_t i_share) {
  visit_share(data, i_share, 0);
}

static void fill_share(void *data, size_t i_share) {
  visit_share(data, i_share, 1);
}

static size_t place_counts(const bin_job *j) {
  size_t sum = 0;
  for (size_t tile = 0; tile < j->bins->n_tiles; tile++) {
    j->bins->tile_begin[tile] = sum;
    for (size_t share = 0; share < j->n_shares; share++) {
      size_t *place = &j->places[share * j->bins->n_tiles + tile], count = *place;
      *place = sum;
      sum += count;
    }
  }
  return j->bins->tile_begin[j->bins->n_tiles] = sum;
}

conic_status conic_gaussian_bins_make(conic_context *context, const conic_gaussian_runs *runs,
                                      const conic_gaussian_window *window, conic_gaussian_bins *bins) {
  enum { LEAST_SHARE = 8, MOST_SHARES = 64 };
  bin_job j = {.runs = runs, .bins = bins};
  bins->first_x = (size_t)window->begin[0] / CONIC_GAUSSIAN_TILE;
  bins->first_y = (size_t)window->begin[1] / CONIC_GAUSSIAN_TILE;
  bins->n_tiles_x = ((size_t)window->end[0] + CONIC_GAUSSIAN_TILE - 1) / CONIC_GAUSSIAN_TILE - bins->first_x;
  bins->n_tiles =
      bins->n_tiles_x * (((size_t)window->end[1] + CONIC_GAUSSIAN_TILE - 1) / CONIC_GAUSSIAN_TILE - bins->first_y);
  j.a_share = runs->n_runs / MOST_SHARES + 1 > LEAST_SHARE ? runs->n_runs / MOST_SHARES + 1 : LEAST_SHARE;
  j.n_shares = (runs->n_runs + j.a_share - 1) / j.a_share;
  if (conic_memory_allocate_these(context, CONIC_ROOM(bins->tile_begin, bins->n_tiles + 1),
                                  CONIC_ZEROED(j.places, j.n_shares * bins->n_tiles)) != CONIC_OK) {
    conic_memory_release(context, j.places);
    return CONIC_ERROR_MEMORY;
  }
  conic_parallel_for(context, j.n_shares, count_share, &j);
  bins->entries = conic_memory_allocate(context, place_counts(&j), sizeof *bins->entries);
  if (bins->entries)
    conic_parallel_for(context, j.n_shares, fill_share, &j);
  conic_memory_release(context, j.places);
  return bins->entries ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* --- each list --- */

typedef struct sort_job {
  const float *keys;
  conic_gaussian_bins *bins;
  conic_radix_item *rooms; /* by thread: twice the longest list */
  size_t longest;
} sort_job;

enum { SORTED_TOGETHER = 16 };

/* Keys are depths over 0, or of a mean behind the eye below: ordered as their bits are, once those below are turned. */
static uint32_t key_of(float key) {
  uint32_t bits = conic_bits_of_float(key);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

static void sort_list(const float *keys, uint32_t *entries, size_t n, conic_radix_item *items, conic_radix_item *room) {
  for (size_t i = 0; i < n; i++)
    items[i] = (conic_radix_item){key_of(keys[entries[i]]), entries[i]};
  const conic_radix_item *sorted = conic_radix_sort_in(items, room, n, 32);
  for (size_t i = 0; i < n; i++)
    entries[i] = sorted[i].value;
}

static void sort_lists(void *data, size_t i_item, int i_thread) {
  const sort_job *j = data;
  conic_radix_item *room = j->rooms + 2 * j->longest * (size_t)i_thread;
  for (size_t tile = i_item * SORTED_TOGETHER; tile < (i_item + 1) * SORTED_TOGETHER && tile < j->bins->n_tiles; tile++)
    sort_list(j->keys, j->bins->entries + j->bins->tile_begin[tile],
              j->bins->tile_begin[tile + 1] - j->bins->tile_begin[tile], room, room + j->longest);
}

size_t conic_gaussian_bins_longest(const conic_gaussian_bins *bins) {
  size_t longest = 0;
  for (size_t tile = 0; tile < bins->n_tiles; tile++) {
    size_t n = bins->tile_begin[tile + 1] - bins->tile_begin[tile];
    longest = n > longest ? n : longest;
  }
  return longest;
}

conic_status conic_gaussian_bins_sort(conic_context *context, const conic_gaussian_runs *runs,
                                      conic_gaussian_bins *bins) {
  sort_job j = {.keys = runs->keys, .bins = bins, .longest = conic_gaussian_bins_longest(bins)};
  j.rooms = conic_memory_allocate(context, 2 * j.longest * (size_t)conic_context_threads(context), sizeof *j.rooms);
  if (!j.rooms)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(context, (bins->n_tiles + SORTED_TOGETHER - 1) / SORTED_TOGETHER, sort_lists, &j);
  conic_memory_release(context, j.rooms);
  return CONIC_OK;
}

void conic_gaussian_bins_release(conic_context *context, conic_gaussian_bins *bins) {
  conic_memory_release(context, bins->tile_begin);
  conic_memory_keep(context, bins->entries);
  memset(bins, 0, sizeof *bins);
}
