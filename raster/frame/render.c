#include "conic/render.h"

#include <stdatomic.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/kept_memory.h"
#include "core/base/message.h"
#include "core/base/threads.h"
#include "core/image/image_common.h"
#include "core/splats/near.h"
#include "raster/frame/backend.h"
#include "raster/frame/drawing.h"
#include "raster/frame/tile.h"
#include "raster/frame/windowed.h"
#include "raster/project/clip_lines.h"
#include "raster/tiles/bins.h"
#include "raster/tiles/lights.h"
#include "raster/view/method.h"
#include "raster/view/part.h"
#include "raster/view/slips.h"
#include "raster/view/ticks.h"

struct conic_renderer {
  conic_context *context;
  conic_backend *backend; /* null: the loops here */
  conic_kept_memory footprints, surfaces, rays, clips, chunks, chunk_begin, tile_begin, tile_counts, entries, sorters,
      scratch, times, lengths, others, tile_order;
  conic_triangle_frame triangles;
  unsigned slips; /* raster/view/slips.h */
};

/* One frame on its way through the stages. */
typedef struct frame {
  conic_renderer *renderer;
  const conic_splats *splats;
  conic_view view;
  conic_projected projected;
  conic_bins bins;
  conic_finish finish;
  conic_finish_lights lights;
  conic_isa isa;
  conic_raster_kernels kernels;
  conic_image *image;
  conic_part part;         /* the pixels that are drawn */
  int is_part;             /* they are not the whole picture */
  conic_chunk *others;     /* a thread: what is not counted */
  float *hiding;           /* in the place of an image; else null */
  char *sorters, *scratch; /* of chunks and of tiles, a thread */
  size_t sorter_bytes, scratch_bytes;
  conic_triangle_frame *triangles;   /* null: there are none */
  conic_stage_ticks *times;          /* a thread: what shares the wall-clock out */
  uint64_t *n_fragments, *n_covered; /* a tile */
  uint32_t *tile_order;              /* null: as they lie */
  atomic_size_t n_triangle_fragments;
  atomic_size_t n_tiles_done;
  atomic_int is_cancelled;
} frame;

conic_status conic_renderer_create(conic_context *context, conic_renderer **renderer) {
  *renderer = conic_memory_allocate_zeroed(context, 1, sizeof **renderer);
  if (!*renderer)
    return CONIC_ERROR_MEMORY;
  (*renderer)->context = context;
  return CONIC_OK;
}

void conic_renderer_give_back(conic_renderer *renderer) {
  conic_kept_memory *all[] = {
      &renderer->footprints,  &renderer->surfaces,   &renderer->rays,        &renderer->clips,   &renderer->chunks,
      &renderer->chunk_begin, &renderer->tile_begin, &renderer->tile_counts, &renderer->entries, &renderer->sorters,
      &renderer->scratch,     &renderer->times,      &renderer->lengths,     &renderer->others,  &renderer->tile_order};
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    conic_memory_release(renderer->context, all[i]->pointer);
    *all[i] = (conic_kept_memory){NULL, 0};
  }
}

void conic_renderer_destroy(conic_renderer *renderer) {
  if (!renderer)
    return;
  conic_renderer_give_back(renderer);
  if (renderer->backend)
    renderer->backend->destroy(renderer->backend);
  conic_triangle_frame_release(renderer->context, &renderer->triangles);
  conic_memory_release(renderer->context, renderer);
}

void conic_renderer_take(conic_renderer *renderer, conic_backend *backend) {
  renderer->backend = backend;
}

conic_backend *conic_renderer_backend(const conic_renderer *renderer) {
  return renderer->backend;
}

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
static void choose_chunks(frame *f) {
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

static conic_status plan_records(frame *f) {
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
  projected->clips = NULL;
  if (f->splats->n_clips && n) /* only the marked footprints' records are ever touched */
    projected->clips = conic_keep_room(context, &renderer->clips, n, sizeof *projected->clips);
  return f->splats->n_clips && n && !projected->clips ? CONIC_ERROR_MEMORY : CONIC_OK;
}

static conic_status plan_bins(frame *f) {
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

static conic_status plan_tiles(frame *f, int tile) {
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

static void project_task(void *data, size_t i_chunk, int i_thread) {
  frame *f = data;
  conic_sorter sorter;
  size_t n = f->splats->count, begin = i_chunk * f->projected.chunk_size, end = begin + f->projected.chunk_size;
  uint64_t start = conic_ticks();
  end = end < n ? end : n;
  conic_sorter_place(&f->bins, f->projected.chunk_size, f->splats->n_clips > 0, f->projected.rays,
                     f->sorters + (size_t)i_thread * f->sorter_bytes, &sorter);
  sorter.chunk.first_ray = begin;
  f->kernels.project.project(&f->view, f->splats, begin, end, &sorter.projected, &sorter.chunk);
  if (sorter.projected.clips)
    conic_clip_chunk(&f->view, f->splats, begin, &sorter.projected, &sorter.chunk);
  if (f->part.is_counted)
    conic_chunk_count_others(&f->view, f->splats, begin, end, f->part.is_counted, &sorter.projected, &sorter.chunk,
                             &f->others[i_thread]);
  if (f->is_part)
    conic_chunk_keep_window(&f->part.window, &sorter.projected, &sorter.chunk);
  uint64_t projected = conic_ticks();
  conic_bins_sort(&f->bins, &f->kernels.bins, &sorter, i_chunk, &f->projected);
  f->times[i_thread].setup += projected - start;
  f->times[i_thread].sort += conic_ticks() - projected;
}

static void begin_tile(const frame *f, size_t i_tile, int i_thread, conic_tile *tile) {
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
static void report_progress(frame *f) {
  size_t done = atomic_load(&f->n_tiles_done);
  if (conic_progress(f->renderer->context, "render", (double)done / (double)f->bins.n_tiles) != CONIC_OK)
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

static void tile_task(void *data, size_t i_task, int i_thread) {
  frame *f = data;
  size_t i_tile = f->tile_order ? f->tile_order[i_task] : i_task;
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
  conic_tile_draw(&tile, &f->kernels, &f->finish, f->image, &report);
  add_ticks(&tile.ticks, &f->times[i_thread]);
  f->n_fragments[i_tile] = report.n_fragments;
  f->n_covered[i_tile] = report.n_covered;
  atomic_fetch_add(&f->n_triangle_fragments, report.n_triangle_fragments);
  atomic_fetch_add(&f->n_tiles_done, 1);
}

/* Where threads have few tiles each, those with the most entries are drawn first, so that none is left with a long one
 * at the end. Else neighbours stay together, whose records are in the caches. */
static conic_status order_tiles(frame *f, size_t most_entries) {
  enum { FEW = 32, N_CLASSES = 256 };
  const conic_bins *bins = &f->bins;
  size_t n_threads = (size_t)conic_context_threads(f->renderer->context), next[N_CLASSES] = {0}, begin = 0;
  f->tile_order = NULL;
  if (n_threads == 1 || bins->n_tiles >= FEW * n_threads || !most_entries)
    return CONIC_OK;
  f->tile_order = conic_keep_room(f->renderer->context, &f->renderer->tile_order, bins->n_tiles, sizeof *f->tile_order);
  if (!f->tile_order)
    return CONIC_ERROR_MEMORY;
  double scale = (N_CLASSES - 1) / (double)most_entries;
  for (size_t i = 0; i < bins->n_tiles; i++)
    next[(size_t)(scale * (double)bins->length[i])]++;
  for (size_t class = N_CLASSES; class -- > 0;) {
    size_t n = next[class];
    next[class] = begin;
    begin += n;
  }
  for (size_t i = 0; i < bins->n_tiles; i++)
    f->tile_order[next[(size_t)(scale * (double)bins->length[i])]++] = (uint32_t)i;
  return CONIC_OK;
}

/* Sets the splats up and sorts them. How many entries that makes is known afterwards: where they had no room, again. */
static conic_status project_and_sort(frame *f) {
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
  return f->scratch ? order_tiles(f, most_entries) : CONIC_ERROR_MEMORY;
}

/* The wall-clock of set-up and sorting, and that of the tiles, shared out by what their stages took on all threads. */
static void share_out(const frame *f, double chunks_ms, double tiles_ms, conic_render_milliseconds *ms) {
  conic_stage_ticks sum = {.setup = 0};
  for (int i = 0; i < conic_context_threads(f->renderer->context); i++)
    add_ticks(&f->times[i], &sum);
  double of_chunks = (double)(sum.setup + sum.sort);
  double of_tiles = (double)(sum.lists + sum.visibility + sum.accumulate + sum.resolve);
  double chunks_scale = of_chunks > 0.0 ? chunks_ms / of_chunks : 0.0;
  double tiles_scale = of_tiles > 0.0 ? tiles_ms / of_tiles : 0.0;
  ms->setup = (double)sum.setup * chunks_scale;
  ms->bin = (double)sum.sort * chunks_scale + (double)sum.lists * tiles_scale;
  ms->visibility = (double)sum.visibility * tiles_scale;
  ms->accumulate = (double)sum.accumulate * tiles_scale;
  ms->resolve = (double)sum.resolve * tiles_scale;
}

/* Takes out what another part counts. */
static void take_out_others(const frame *f, conic_method method, conic_render_statistics *statistics) {
  conic_render_statistics others = {.splats_in = 0};
  conic_chunks_count(f->others, (size_t)conic_context_threads(f->renderer->context), method, &others);
  statistics->splats_culled -= others.splats_culled;
  statistics->splats_drawn -= others.splats_drawn;
  statistics->splats_skipped -= others.splats_skipped;
  statistics->splats_fallback -= others.splats_fallback;
  statistics->splats_by_laplace -= others.splats_by_laplace;
  for (int i = 0; i < CONIC_N_METHODS; i++)
    statistics->splats_by_method[i] -= others.splats_by_method[i];
}

static void count_up(const frame *f, const conic_render_options *options, conic_render_statistics *statistics) {
  conic_chunks_count(f->projected.chunks, f->projected.n_chunks, options->method, statistics);
  if (f->part.is_counted)
    take_out_others(f, options->method, statistics);
  for (size_t i = 0; i < f->bins.n_tiles; i++) {
    statistics->fragments += f->n_fragments[i];
    statistics->pixels_covered += f->n_covered[i];
  }
  if (f->triangles)
    conic_triangle_frame_count(f->triangles, statistics);
  statistics->triangle_fragments = atomic_load(&f->n_triangle_fragments);
  statistics->threads = conic_context_threads(f->renderer->context);
  statistics->tile = f->bins.tile;
  statistics->isa = conic_isa_name(f->isa);
}

static void note_settings(const frame *f, const conic_render_options *options, conic_render_statistics *statistics) {
  statistics->splats_in = f->splats->count;
  statistics->near_z = f->view.near_z;
  statistics->epsilon_is_fixed = options->epsilon >= 0.0;
  statistics->epsilon = statistics->epsilon_is_fixed ? options->epsilon : (double)CONIC_EPSILON_C;
}

void conic_renderer_slip(conic_renderer *renderer, unsigned slips) {
  renderer->slips = slips;
}

double conic_default_near(const conic_splats *splats) {
  double low[3], high[3];
  conic_splats_bounds(splats, low, high);
  return conic_near_of_box(low, high);
}

static conic_status draw_frame(frame *f, conic_render_milliseconds *ms) {
  conic_context *context = f->renderer->context;
  double start = conic_seconds_now();
  conic_status status = project_and_sort(f);
  double sorted = conic_seconds_now();
  if (status == CONIC_OK && f->triangles)
    status = conic_triangle_frame_prepare(f->triangles, &f->kernels.triangles);
  if (status != CONIC_OK)
    return status;
  double prepared = conic_seconds_now();
  conic_parallel_for(context, f->bins.n_tiles, tile_task, f);
  double done = conic_seconds_now();
  share_out(f, 1e3 * (sorted - start), 1e3 * (done - prepared), ms);
  ms->setup += 1e3 * (prepared - sorted);
  return atomic_load(&f->is_cancelled) ? CONIC_ERROR_CANCELLED : conic_progress(context, "render", 1.0);
}

/* The drawing's triangles, if there are any. */
static conic_status begin_triangles(frame *f, const conic_whole_drawing *drawing, const conic_camera *camera,
                                    const conic_render_options *options) {
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

/* By the loops of this machine's processor. */
static conic_status draw_here(frame *f, const conic_render_options *options, conic_render_statistics *statistics) {
  int blends = options->passes != 1 || f->hiding;
  f->view.needs_nearness = blends;
  f->view.needs_slope = blends || f->image->planes[CONIC_PLANE_Z];
  conic_status status = plan_tiles(f, options->tile);
  if (status == CONIC_OK)
    status = plan_records(f);
  if (status == CONIC_OK)
    status = plan_bins(f);
  if (status == CONIC_OK)
    status = draw_frame(f, &statistics->ms);
  if (status == CONIC_OK)
    count_up(f, options, statistics);
  return status;
}

/* Triangles alone hide by what they are. */
static conic_status take_passes(const frame *f, conic_render_options *options) {
  if (options->passes != CONIC_PASS_OF_HIDING || !f->image)
    return CONIC_OK;
  if (conic_image_planes(f->image) != 1u << CONIC_PLANE_Z)
    return conic_fail(f->renderer->context, CONIC_ERROR_ARGUMENT, "render: the pass of hiding has the plane Z alone");
  options->passes = f->splats->count ? CONIC_PASS_OF_HIDING : 1;
  return CONIC_OK;
}

/* All of conic_render, for the window and the plane that `f` names already. */
static conic_status render(frame *f, const conic_whole_drawing *drawing, const conic_camera *camera,
                           const conic_render_options *given, conic_render_statistics *statistics) {
  double start = conic_seconds_now();
  conic_render_statistics counted;
  conic_renderer *renderer = f->renderer;
  conic_context *context = renderer->context;
  memset(&counted, 0, sizeof counted);
  conic_render_options own = *given, scaled = *given;
  const conic_render_options *options = &own;
  conic_status status = take_passes(f, &own);
  if (status == CONIC_OK)
    status = conic_isa_choose(context, options->isa, &f->isa);
  if (status != CONIC_OK)
    return status;
  conic_raster_kernels_init(&f->kernels, f->isa);
  status = conic_whole_drawing_scale(context, drawing, &scaled);
  if (status == CONIC_OK)
    status = conic_view_init(context, f->splats, camera, options, scaled.near_z, scaled.splat_length, &f->view);
  f->view.slips = renderer->slips;
  if (f->view.slips)
    f->kernels.project.project = conic_project_range;
  if (status == CONIC_OK)
    status = conic_finish_init(renderer->context, camera, options, &f->lights, &f->finish);
  if (status == CONIC_OK)
    status = begin_triangles(f, drawing, camera, options);
  if (status == CONIC_OK && renderer->backend)
    status =
        renderer->backend->draw(renderer->backend, &f->view, f->splats, f->triangles, &f->finish, f->image, &counted);
  else if (status == CONIC_OK)
    status = draw_here(f, options, &counted);
  if (status != CONIC_OK)
    return status;
  note_settings(f, options, &counted);
  if (options->skip_hidden)
    counted.fragments = 0;
  counted.ms.frame = 1e3 * (conic_seconds_now() - start);
  if (statistics)
    *statistics = counted;
  return CONIC_OK;
}

static conic_part whole_of(const conic_camera *camera) {
  return (conic_part){.window = {0, camera->width, 0, camera->height}};
}

conic_status conic_render_whole(conic_renderer *renderer, const conic_whole_drawing *drawing,
                                const conic_camera *camera, const conic_render_options *options, conic_image *image,
                                conic_render_statistics *statistics) {
  frame f = {.renderer = renderer, .splats = drawing->splats, .image = image, .part = whole_of(camera)};
  return render(&f, drawing, camera, options, statistics);
}

conic_status conic_render(conic_renderer *renderer, const conic_splats *splats, const conic_camera *camera,
                          const conic_render_options *options, conic_image *image,
                          conic_render_statistics *statistics) {
  return conic_render_samples(renderer->context, renderer, splats, camera, options, 1, image, statistics);
}

int conic_renderer_has_parts(const conic_renderer *renderer) {
  return !renderer->backend;
}

conic_status conic_renderer_check_parts(const conic_renderer *renderer) {
  if (!conic_renderer_has_parts(renderer))
    return conic_fail(renderer->context, CONIC_ERROR_UNSUPPORTED,
                      "render: only the processor draws a picture in parts; more memory makes it one");
  return CONIC_OK;
}

conic_status conic_render_part(conic_renderer *renderer, const conic_splats *splats, const conic_camera *camera,
                               const conic_render_options *options, const conic_part *part, conic_image *image,
                               conic_render_statistics *statistics) {
  const conic_whole_drawing alone = {.splats = splats};
  conic_status status = conic_renderer_check_parts(renderer);
  if (status != CONIC_OK)
    return status;
  frame f = {.renderer = renderer, .splats = splats, .image = image, .part = *part, .is_part = 1};
  return render(&f, &alone, camera, options, statistics);
}

conic_status conic_render_hiding(conic_renderer *renderer, const conic_splats *splats, const conic_camera *camera,
                                 const conic_render_options *options, float *hiding) {
  const conic_whole_drawing alone = {.splats = splats};
  conic_status status = conic_renderer_check_parts(renderer);
  if (status != CONIC_OK)
    return status;
  frame f = {.renderer = renderer, .splats = splats, .part = whole_of(camera)};
  f.hiding = hiding;
  return render(&f, &alone, camera, options, NULL);
}
