#include "raster/frame/raster_frame.h"

#include "core/base/base.h"
#include "raster/project/clip_lines.h"
#include "raster/tiles/lights.h"
#include "raster/view/ticks.h"

/* conic_keep_room for what fills up from its beginning. */
static void *dense_room(conic_renderer *renderer, conic_kept_memory *memory, size_t count, size_t size) {
  size_t before = memory->bytes;
  void *pointer = conic_keep_room(renderer->context, memory, count, size);
  if (memory->bytes != before)
    conic_memory_prefer_large_pages(renderer->context, pointer, memory->bytes);
  return pointer;
}

/* Chunks of splats are what set-up and binning share out: enough of them for balance, small enough for their records to
 * stay in a core's cache until they are sorted, few enough for their tables. */
static void choose_chunks(conic_raster_frame *f) {
  enum { LEAST = 2048, GREATEST = 8192 };
  size_t greatest = f->view.cull_back ? 3 * GREATEST : GREATEST; /* most of them are not drawn */
  size_t n = f->splats->count, size = n / (8 * (size_t)conic_context_threads(f->renderer->context)) + 1;
  size = size < LEAST ? LEAST : size > greatest ? greatest : size;
  while ((n / size + 1) * f->bins.n_tiles > ((size_t)1 << 22) && size < n)
    size *= 2;
  size_t countable = (UINT32_MAX - 1) / f->bins.n_tiles; /* a chunk's entries are, even if all splats meet all tiles */
  size = size < countable ? size : countable;
  f->projected.chunk_size = size;
  f->projected.n_chunks = f->bins.n_chunks = n / size + (n % size > 0);
}

static conic_status plan_records(conic_raster_frame *f) {
  if (!f->projected.band) /* else they stay what they were */
    choose_chunks(f);
  conic_renderer *renderer = f->renderer;
  conic_context *context = renderer->context;
  conic_projected *projected = &f->projected;
  size_t n = f->splats->count;
  projected->chunks = conic_keep_room(context, &renderer->chunks, projected->n_chunks, sizeof *projected->chunks);
  size_t n_named = n ? n : 1; /* where nothing is, sums name the first */
  projected->footprints = dense_room(renderer, &renderer->footprints, n_named, sizeof *projected->footprints);
  projected->surfaces = dense_room(renderer, &renderer->surfaces, n_named, sizeof *projected->surfaces);
  projected->rays = conic_keep_room(context, &renderer->rays, n, sizeof *projected->rays);
  if (!projected->chunks || !projected->footprints || !projected->surfaces || !projected->rays)
    return CONIC_ERROR_MEMORY;
  if (n == 0 || !projected->band) { /* lanes read what sums name, even where triangles hide it */
    memset(projected->footprints, 0, sizeof *projected->footprints);
    memset(projected->surfaces, 0, sizeof *projected->surfaces);
  }
  projected->clips = NULL;
  if (f->splats->n_clips && n) /* only the marked footprints' records are ever touched */
    projected->clips = conic_keep_room(context, &renderer->clips, n, sizeof *projected->clips);
  return f->splats->n_clips && n && !projected->clips ? CONIC_ERROR_MEMORY : CONIC_OK;
}

static conic_status plan_bins(conic_raster_frame *f) {
  conic_renderer *renderer = f->renderer;
  conic_context *context = renderer->context;
  conic_bins *bins = &f->bins;
  size_t n = f->splats->count, n_threads = (size_t)conic_context_threads(context);
  f->sorter_bytes = conic_sorter_bytes(bins, f->projected.chunk_size, f->splats->n_clips > 0);
  f->sorters = conic_keep_room(context, &renderer->sorters, n_threads, f->sorter_bytes);
  bins->chunk_begin = conic_keep_room(context, &renderer->chunk_begin, bins->n_chunks, sizeof *bins->chunk_begin);
  bins->tile_begin =
      conic_keep_room(context, &renderer->tile_begin, bins->n_chunks * (bins->n_tiles + 1), sizeof *bins->tile_begin);
  bins->entries = dense_room(renderer, &renderer->entries, n + n / 4 + bins->n_tiles, sizeof *bins->entries);
  bins->n_room = renderer->entries.bytes / sizeof *bins->entries;
  bins->length = conic_keep_room(context, &renderer->lengths, bins->n_tiles, sizeof *bins->length);
  f->n_fragments = conic_keep_room(context, &renderer->tile_counts, bins->n_tiles * 2, sizeof *f->n_fragments);
  if (!f->sorters || !bins->chunk_begin || !bins->tile_begin || !bins->length || !bins->entries || !f->n_fragments)
    return CONIC_ERROR_MEMORY;
  f->n_covered = f->n_fragments + bins->n_tiles;
  return CONIC_OK;
}

static conic_status plan_tiles(conic_raster_frame *f, int tile) {
  conic_renderer *renderer = f->renderer;
  conic_context *context = renderer->context;
  size_t n_threads = (size_t)conic_context_threads(context);
  f->bins.tile = tile;
  f->bins.tile_bits = __builtin_ctz((unsigned)tile);
  f->bins.by_pixels = f->finish.options->passes == 1 && !f->hiding;
  f->bins.n_tiles_x = (f->part.window.x_end - f->part.window.x_begin + tile - 1) / tile;
  f->bins.n_tiles_y = (f->part.window.y_end - f->part.window.y_begin + tile - 1) / tile;
  f->bins.n_tiles = (size_t)f->bins.n_tiles_x * (size_t)f->bins.n_tiles_y;
  f->times = conic_keep_room(context, &renderer->times, n_threads, sizeof *f->times);
  f->others = conic_keep_room(context, &renderer->others, n_threads, sizeof *f->others);
  if (!f->times || !f->others)
    return CONIC_ERROR_MEMORY;
  memset(f->times, 0, n_threads * sizeof *f->times);
  return CONIC_OK;
}

static void project_chunk(conic_raster_frame *f, size_t begin, size_t end, int i_thread, conic_sorter *sorter) {
  conic_projected *projected = &sorter->projected;
  projected->bands = f->projected.bands;
  projected->band = f->projected.band;
  f->loops.project.project(&f->view, f->splats, begin, end, projected, &sorter->chunk);
  if (projected->clips)
    conic_clip_chunk(&f->view, f->splats, begin, projected, &sorter->chunk);
  if (f->part.is_counted)
    conic_chunk_count_others(&f->view, f->splats, begin, end, f->part.is_counted, projected, &sorter->chunk,
                             &f->others[i_thread]);
  if (projected->bands && !projected->band)
    conic_chunk_find_bands(f->band_bits, projected, &sorter->chunk);
  if (f->is_part)
    conic_chunk_keep_window(&f->part.window, projected, &sorter->chunk);
}

static void project_task(void *data, size_t i_chunk, int i_thread) {
  conic_raster_frame *f = data;
  unsigned bands = f->projected.band ? f->projected.chunks[i_chunk].bands : 0;
  conic_sorter sorter;
  size_t n = f->splats->count, begin = i_chunk * f->projected.chunk_size, end = begin + f->projected.chunk_size;
  uint64_t start = conic_ticks();
  end = end < n ? end : n;
  conic_sorter_place(&f->bins, f->projected.chunk_size, f->splats->n_clips > 0, f->projected.rays,
                     f->sorters + (size_t)i_thread * f->sorter_bytes, &sorter);
  sorter.chunk.first_ray = begin;
  sorter.chunk.bands = bands;
  if (!f->projected.band || f->projected.band & bands)
    project_chunk(f, begin, end, i_thread, &sorter);
  uint64_t projected = conic_ticks();
  conic_bins_sort(&f->bins, &f->loops.bins, &sorter, i_chunk, &f->projected);
  f->times[i_thread].setup += projected - start;
  f->times[i_thread].sort += conic_ticks() - projected;
}

/* Sets the splats up and sorts them. How many entries that makes is known afterwards: where they had no room, again. */
static conic_status project_and_sort(conic_raster_frame *f) {
  conic_renderer *renderer = f->renderer;
  conic_context *context = renderer->context;
  conic_bins *bins = &f->bins;
  for (;;) {
    atomic_store(&bins->n_used, 0);
    atomic_store(&bins->n_records, 0);
    memset(f->others, 0, (size_t)conic_context_threads(context) * sizeof *f->others);
    conic_parallel_for(context, f->projected.n_chunks, project_task, f);
    size_t n_used = atomic_load(&bins->n_used);
    if (n_used <= bins->n_room)
      break;
    bins->entries = dense_room(renderer, &renderer->entries, n_used, sizeof *bins->entries);
    bins->n_room = n_used;
    if (!bins->entries)
      return CONIC_ERROR_MEMORY;
  }
  size_t most_entries = conic_bins_measure(bins);
  f->scratch_bytes = conic_tile_bytes(most_entries);
  f->scratch = conic_keep_room(context, &renderer->scratch, (size_t)conic_context_threads(context), f->scratch_bytes);
  return f->scratch ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* The wall-clock, shared out by what set-up and sorting took on all threads. */
static void share_out_chunks(conic_raster_frame *f, double chunks_ms, conic_render_milliseconds *ms) {
  conic_stage_ticks sum = conic_raster_frame_ticks(f);
  double of_chunks = (double)(sum.setup + sum.sort), scale = of_chunks > 0.0 ? chunks_ms / of_chunks : 0.0;
  ms->setup += (double)sum.setup * scale;
  ms->bin += (double)sum.sort * scale;
}

conic_status conic_raster_frame_set_up(conic_raster_frame *f, unsigned planes, conic_render_milliseconds *ms) {
  const conic_render_options *options = f->finish.options;
  int blends = options->passes != 1 || f->hiding;
  f->view.needs_nearness = blends;
  f->view.needs_slope = blends || planes >> CONIC_PLANE_Z & 1;
  conic_status status = plan_tiles(f, options->tile);
  if (status == CONIC_OK)
    status = plan_records(f);
  if (status == CONIC_OK)
    status = plan_bins(f);
  double start = conic_seconds_now();
  if (status == CONIC_OK)
    status = project_and_sort(f);
  if (status != CONIC_OK)
    return status;
  double sorted = conic_seconds_now();
  share_out_chunks(f, 1e3 * (sorted - start), ms);
  if (f->triangles)
    status = conic_triangle_frame_prepare(f->triangles, &f->loops.triangles);
  ms->setup += 1e3 * (conic_seconds_now() - sorted);
  return status;
}

/* The drawing's triangles, if there are any. */
static conic_status begin_triangles(conic_raster_frame *f, const conic_whole_drawing *drawing,
                                    const conic_camera *camera, const conic_render_options *options) {
  conic_context *context = f->renderer->context;
  if (!drawing->triangles)
    return CONIC_OK;
  if (drawing->triangles->count > UINT32_MAX - 1 - f->splats->count)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "render: there are more than 4,294,967,294 splats and triangles");
  f->triangles = &f->renderer->triangles;
  f->triangles->first_id = (uint32_t)f->splats->count;
  conic_triangle_frame_begin(f->triangles, context, drawing->triangles, &f->view, camera);
  conic_triangle_frame_tiles(f->triangles, options->tile);
  return CONIC_OK;
}

conic_status conic_raster_frame_begin(conic_raster_frame *f, const conic_whole_drawing *drawing,
                                      const conic_camera *camera, const conic_render_options *options) {
  conic_context *context = f->renderer->context;
  conic_render_options scaled = *options;
  conic_status status = conic_isa_choose(context, options->isa, &f->isa);
  if (status != CONIC_OK)
    return status;
  conic_raster_loops_init(&f->loops, f->isa);
  status = conic_whole_drawing_scale(context, drawing, &scaled);
  if (status == CONIC_OK)
    status = conic_view_init(context, f->splats, camera, options, scaled.near_z, scaled.splat_length, &f->view);
  f->view.slips = f->renderer->slips;
  if (f->view.slips)
    f->loops.project.project = conic_project_range;
  if (status == CONIC_OK)
    status = conic_finish_init(context, camera, options, &f->lights, &f->finish);
  return status == CONIC_OK ? begin_triangles(f, drawing, camera, options) : status;
}
