/* A counting sort by tile, run by run of footprints: each run counts, the counts become places, each run puts its
 * entries there. The order within a tile is so that of the footprints, whatever the threads. */
#include "gaussians/draw/gaussian_bins.h"

#include "core/base/base.h"

typedef struct bin_job {
  const conic_gaussian_footprint *footprints;
  const conic_radix_item *order;
  size_t n, a_run, n_runs;
  conic_gaussian_bins *bins;
  size_t *places; /* n_runs × n_tiles: counts, then places */
} bin_job;

enum { AHEAD = 16 };

/* Of the window's tiles along an axis, the first that a box meets, and where it ends. */
static size_t first_in(size_t first_pixel, size_t first_tile) {
  size_t tile = first_pixel / CONIC_GAUSSIAN_TILE;
  return tile > first_tile ? tile - first_tile : 0;
}

static size_t end_in(size_t last_pixel, size_t first_tile, size_t n_tiles) {
  size_t end = last_pixel / CONIC_GAUSSIAN_TILE + 1 - first_tile;
  return end < n_tiles ? end : n_tiles;
}

static void visit(const bin_job *j, size_t i_run, int writes) {
  size_t *places = &j->places[i_run * j->bins->n_tiles], across = j->bins->n_tiles_x,
         down = j->bins->n_tiles / j->bins->n_tiles_x;
  size_t end = (i_run + 1) * j->a_run < j->n ? (i_run + 1) * j->a_run : j->n;
  for (size_t i = i_run * j->a_run; i < end; i++) {
    const conic_gaussian_footprint *f = &j->footprints[j->order[i].value];
    if (i + AHEAD < end) /* they lie all over the memory */
      __builtin_prefetch(j->footprints[j->order[i + AHEAD].value].box);
    const size_t x_begin = first_in(f->box[0][0], j->bins->first_x),
                 x_end = end_in(f->box[1][0], j->bins->first_x, across);
    const size_t y_begin = first_in(f->box[0][1], j->bins->first_y),
                 y_end = end_in(f->box[1][1], j->bins->first_y, down);
    for (size_t y = y_begin; y < y_end; y++)
      for (size_t x = x_begin; x < x_end; x++) {
        size_t *place = &places[y * across + x];
        if (writes)
          j->bins->entries[*place] = j->order[i].value;
        ++*place;
      }
  }
}

static void count_run(void *data, size_t i_run) {
  visit(data, i_run, 0);
}

static void fill_run(void *data, size_t i_run) {
  visit(data, i_run, 1);
}

static size_t place_counts(const bin_job *j) {
  size_t sum = 0;
  for (size_t tile = 0; tile < j->bins->n_tiles; tile++) {
    j->bins->tile_begin[tile] = sum;
    for (size_t run = 0; run < j->n_runs; run++) {
      size_t *place = &j->places[run * j->bins->n_tiles + tile], count = *place;
      *place = sum;
      sum += count;
    }
  }
  return j->bins->tile_begin[j->bins->n_tiles] = sum;
}

conic_status conic_gaussian_bins_make(conic_context *context, const conic_gaussian_footprint *footprints,
                                      const conic_radix_item *order, size_t n, const conic_gaussian_window *window,
                                      conic_gaussian_bins *bins) {
  enum { LEAST_RUN = 16384, MOST_RUNS = 64 };
  bin_job j = {.footprints = footprints, .order = order, .n = n, .bins = bins};
  bins->first_x = (size_t)window->begin[0] / CONIC_GAUSSIAN_TILE;
  bins->first_y = (size_t)window->begin[1] / CONIC_GAUSSIAN_TILE;
  bins->n_tiles_x = ((size_t)window->end[0] + CONIC_GAUSSIAN_TILE - 1) / CONIC_GAUSSIAN_TILE - bins->first_x;
  bins->n_tiles =
      bins->n_tiles_x * (((size_t)window->end[1] + CONIC_GAUSSIAN_TILE - 1) / CONIC_GAUSSIAN_TILE - bins->first_y);
  j.a_run = n / MOST_RUNS + 1 > LEAST_RUN ? n / MOST_RUNS + 1 : LEAST_RUN;
  j.n_runs = (n + j.a_run - 1) / j.a_run;
  if (conic_memory_allocate_these(context, CONIC_ROOM(bins->tile_begin, bins->n_tiles + 1),
                                  CONIC_ZEROED(j.places, j.n_runs * bins->n_tiles)) != CONIC_OK) {
    conic_memory_release(context, j.places);
    return CONIC_ERROR_MEMORY;
  }
  conic_parallel_for(context, j.n_runs, count_run, &j);
  bins->entries = conic_memory_allocate(context, place_counts(&j), sizeof *bins->entries);
  if (bins->entries)
    conic_parallel_for(context, j.n_runs, fill_run, &j);
  conic_memory_release(context, j.places);
  return bins->entries ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void conic_gaussian_bins_release(conic_context *context, conic_gaussian_bins *bins) {
  conic_memory_release_these(context, bins->tile_begin, bins->entries);
  memset(bins, 0, sizeof *bins);
}
