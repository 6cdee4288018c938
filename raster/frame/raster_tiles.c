/* The tiles of a frame that is set up. */

#include "core/base/base.h"
#include "raster/frame/raster_frame.h"
#include "raster/view/ticks.h"

static void begin_tile(const conic_raster_frame *f, size_t i_tile, int i_thread, conic_tile *tile) {
  const conic_bins *bins = &f->bins;
  tile->view = &f->view;
  tile->projected = &f->projected;
  tile->n_references = bins->length[i_tile];
  const conic_window *window = &f->part.window;
  tile->x_begin = window->x_begin + (int)(i_tile % (size_t)bins->n_tiles_x) * bins->tile;
  tile->y_begin = window->y_begin + (int)(i_tile / (size_t)bins->n_tiles_x) * bins->tile;
  tile->x_end = tile->x_begin + bins->tile < window->x_end ? tile->x_begin + bins->tile : window->x_end;
  tile->y_end = tile->y_begin + bins->tile < window->y_end ? tile->y_begin + bins->tile : window->y_end;
  tile->first_column = f->part.first_column;
  tile->first_row = f->part.first_row;
  tile->keeps_indices = f->image && (f->image->planes[CONIC_PLANE_COUNT] || f->image->planes[CONIC_PLANE_ID]);
  tile->skips_hidden = f->hiding || f->finish.options->skip_hidden;
  tile->hiding = f->hiding;
  conic_tile_place_scratch(tile, f->scratch + (size_t)i_thread * f->scratch_bytes);
  conic_bins_gather(bins, i_tile, tile->scratch.entries);
  tile->triangles = f->triangles && conic_triangle_frame_meets(f->triangles, i_tile) ? f->triangles : NULL;
  tile->triangle_tile = f->triangles ? &f->triangles->tiles[i_thread] : NULL;
  tile->i_tile = i_tile;
}

/* Tells the caller's progress callback, which runs on its own thread, how far the tiles are. */
static void report_progress(conic_raster_frame *f) {
  size_t done = f->n_tiles_before + atomic_load(&f->n_tiles_done);
  size_t n = f->n_tiles_of_all ? f->n_tiles_of_all : f->n_drawn_tiles;
  if (conic_progress(f->renderer->context, "render", (double)done / (double)n) != CONIC_OK)
    atomic_store(&f->is_cancelled, 1);
}

static void add_ticks(const conic_stage_ticks *ticks, conic_stage_ticks *sum) {
  sum->setup += ticks->setup;
  sum->sort += ticks->sort;
  sum->lists += ticks->lists;
  sum->visibility += ticks->visibility;
  sum->accumulate += ticks->accumulate;
  sum->resolve += ticks->resolve;
}

conic_stage_ticks conic_raster_frame_ticks(conic_raster_frame *f) {
  conic_stage_ticks sum = {.setup = 0};
  size_t n_threads = (size_t)conic_context_threads(f->renderer->context);
  for (size_t i = 0; i < n_threads; i++)
    add_ticks(&f->times[i], &sum);
  memset(f->times, 0, n_threads * sizeof *f->times);
  return sum;
}

/* Tile i of the window's, row by row. */
static size_t listed_tile(const conic_raster_frame *f, size_t i) {
  const conic_window *tiles = &f->drawn_tiles;
  size_t across = (size_t)(tiles->x_end - tiles->x_begin);
  return ((size_t)tiles->y_begin + i / across) * (size_t)f->bins.n_tiles_x + (size_t)tiles->x_begin + i % across;
}

static size_t drawn_tile(const conic_raster_frame *f, size_t i) {
  return f->tile_order ? f->tile_order[i] : listed_tile(f, i);
}

static void tile_task(void *data, size_t i_task, int i_thread) {
  conic_raster_frame *f = data;
  size_t i_tile = drawn_tile(f, i_task);
  f->n_fragments[i_tile] = f->n_covered[i_tile] = 0;
  if (atomic_load(&f->is_cancelled))
    return;
  if (i_thread == 0)
    report_progress(f);
  conic_tile tile;
  conic_tile_report report;
  uint64_t start = conic_ticks();
  begin_tile(f, i_tile, i_thread, &tile);
  tile.ticks = (conic_stage_ticks){.lists = conic_ticks() - start};
  conic_tile_draw(&tile, &f->loops, &f->finish, f->image, &report);
  add_ticks(&tile.ticks, &f->times[i_thread]);
  f->n_fragments[i_tile] = report.n_fragments;
  f->n_covered[i_tile] = report.n_covered;
  atomic_fetch_add(&f->n_triangle_fragments, report.n_triangle_fragments);
  atomic_fetch_add(&f->n_tiles_done, 1);
}

static size_t most_listed_entries(const conic_raster_frame *f) {
  size_t most = 0;
  for (size_t i = 0; i < f->n_drawn_tiles; i++) {
    size_t n = f->bins.length[listed_tile(f, i)];
    most = n > most ? n : most;
  }
  return most;
}

/* Where threads have few tiles each, those with the most entries are drawn first, so that none is left with a long one
 * at the end. Else neighbours stay together, whose records are in the caches. */
static conic_status order_tiles(conic_raster_frame *f) {
  enum { FEW = 32, N_CLASSES = 256 };
  conic_context *context = f->renderer->context;
  size_t n_threads = (size_t)conic_context_threads(context), next[N_CLASSES] = {0}, begin = 0, n = f->n_drawn_tiles;
  size_t most_entries = most_listed_entries(f);
  f->tile_order = NULL;
  if (n_threads == 1 || n >= FEW * n_threads || !most_entries)
    return CONIC_OK;
  uint32_t *order = conic_keep_room(context, &f->renderer->tile_order, n, sizeof *order);
  if (!order)
    return CONIC_ERROR_MEMORY;
  double scale = (N_CLASSES - 1) / (double)most_entries;
  for (size_t i = 0; i < n; i++)
    next[(size_t)(scale * (double)f->bins.length[listed_tile(f, i)])]++;
  for (size_t class = N_CLASSES; class -- > 0;) {
    size_t n_before = next[class];
    next[class] = begin;
    begin += n_before;
  }
  for (size_t i = 0; i < n; i++)
    order[next[(size_t)(scale * (double)f->bins.length[listed_tile(f, i)])]++] = (uint32_t)listed_tile(f, i);
  f->tile_order = order;
  return CONIC_OK;
}

/* The wall-clock, shared out by what the tiles' stages took on all threads. */
static void share_out_tiles(conic_raster_frame *f, double tiles_ms, conic_render_milliseconds *ms) {
  conic_stage_ticks sum = conic_raster_frame_ticks(f);
  double of_tiles = (double)(sum.lists + sum.visibility + sum.accumulate + sum.resolve);
  double scale = of_tiles > 0.0 ? tiles_ms / of_tiles : 0.0;
  ms->bin += (double)sum.lists * scale;
  ms->visibility += (double)sum.visibility * scale;
  ms->accumulate += (double)sum.accumulate * scale;
  ms->resolve += (double)sum.resolve * scale;
}

static void choose_tiles(conic_raster_frame *f, const conic_window *window) {
  const conic_window *all = &f->part.window;
  int x = window->x_begin - all->x_begin, y = window->y_begin - all->y_begin, tile = f->bins.tile;
  f->drawn_tiles = (conic_window){x / tile, (window->x_end - all->x_begin + tile - 1) / tile, y / tile,
                                  (window->y_end - all->y_begin + tile - 1) / tile};
  f->n_drawn_tiles =
      (size_t)(f->drawn_tiles.x_end - f->drawn_tiles.x_begin) * (size_t)(f->drawn_tiles.y_end - f->drawn_tiles.y_begin);
}

conic_status conic_raster_frame_draw(conic_raster_frame *f, const conic_window *window, conic_image *image,
                                     conic_render_statistics *statistics) {
  conic_context *context = f->renderer->context;
  f->image = image;
  choose_tiles(f, window);
  atomic_store(&f->n_tiles_done, 0);
  atomic_store(&f->n_triangle_fragments, 0);
  conic_status status = order_tiles(f);
  if (status != CONIC_OK)
    return status;
  double start = conic_seconds_now();
  conic_parallel_for(context, f->n_drawn_tiles, tile_task, f);
  share_out_tiles(f, 1e3 * (conic_seconds_now() - start), &statistics->ms);
  for (size_t i = 0; i < f->n_drawn_tiles; i++) {
    size_t i_tile = listed_tile(f, i);
    statistics->fragments += f->finish.options->skip_hidden ? 0 : f->n_fragments[i_tile];
    statistics->pixels_covered += f->n_covered[i_tile];
  }
  statistics->triangle_fragments += atomic_load(&f->n_triangle_fragments);
  f->n_tiles_before += f->n_tiles_of_all ? f->n_drawn_tiles : 0;
  if (atomic_load(&f->is_cancelled))
    return CONIC_ERROR_CANCELLED;
  return f->n_tiles_before < f->n_tiles_of_all ? CONIC_OK : conic_progress(context, "render", 1.0);
}
