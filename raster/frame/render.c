#include <limits.h>

#include "core/base/base.h"
#include "core/splats/near.h"
#include "raster/frame/raster_frame.h"
#include "raster/view/slips.h"

conic_status conic_renderer_create(conic_context *context, conic_renderer **renderer) {
  *renderer = conic_memory_allocate_zeroed(context, 1, sizeof **renderer);
  if (!*renderer)
    return CONIC_ERROR_MEMORY;
  (*renderer)->context = context;
  return CONIC_OK;
}

void conic_renderer_give_back(conic_renderer *renderer) {
  conic_kept_memory *all[] = {
      &renderer->footprints, &renderer->surfaces,    &renderer->rays,       &renderer->clips,
      &renderer->chunks,     &renderer->chunk_begin, &renderer->tile_begin, &renderer->tile_counts,
      &renderer->entries,    &renderer->sorters,     &renderer->scratch,    &renderer->times,
      &renderer->lengths,    &renderer->others,      &renderer->tile_order, &renderer->bands};
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

/* Takes out what another part counts. */
static void take_out_others(const conic_raster_frame *f, conic_method method, conic_render_statistics *statistics) {
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

static void note_settings(const conic_raster_frame *f, conic_render_statistics *statistics) {
  const conic_render_options *options = f->finish.options;
  statistics->splats_in = f->splats->count;
  statistics->near_z = f->view.near_z;
  statistics->epsilon_is_fixed = options->epsilon >= 0.0;
  statistics->epsilon = statistics->epsilon_is_fixed ? options->epsilon : (double)CONIC_EPSILON_C;
}

void conic_raster_frame_count(const conic_raster_frame *f, conic_render_statistics *statistics) {
  const conic_render_options *options = f->finish.options;
  conic_chunks_count(f->projected.chunks, f->projected.n_chunks, options->method, statistics);
  if (f->part.is_counted)
    take_out_others(f, options->method, statistics);
  if (f->triangles)
    conic_triangle_frame_count(f->triangles, statistics);
  statistics->threads = conic_parallel_threads(f->renderer->context);
  statistics->tile = f->bins.tile;
  statistics->isa = conic_isa_name(f->isa);
  note_settings(f, statistics);
}

void conic_renderer_slip(conic_renderer *renderer, unsigned slips) {
  renderer->slips = slips;
}

double conic_default_near(const conic_splats *splats) {
  double low[3], high[3];
  conic_splats_bounds(splats, low, high);
  return conic_near_of_box(low, high);
}

void conic_renderer_bound_records(conic_renderer *renderer, size_t most) {
  renderer->most_records = most;
}

/* The window, which is the whole picture or a part that is drawn at once. */
static conic_status draw_window(conic_raster_frame *f, conic_image *image, conic_render_statistics *statistics) {
  unsigned planes = image ? conic_image_planes(image) : 0;
  conic_status status = conic_raster_frame_set_up(f, planes, &statistics->ms);
  if (status == CONIC_OK)
    status = conic_raster_frame_draw(f, &f->part.window, image, statistics);
  if (status == CONIC_OK && !f->projected.band) /* the first band has met all splats */
    conic_raster_frame_count(f, statistics);
  return status;
}

/* How high bands are, of which each has about as many records as a renderer's first picture has room for. */
static int choose_band_bits(const conic_raster_frame *f) {
  const conic_renderer *renderer = f->renderer;
  size_t most = renderer->most_records ? renderer->most_records : (size_t)3 << 19;
  size_t n_bands = f->splats->count / most + 1;
  int height = f->part.window.y_end, bits = __builtin_ctz((unsigned)f->finish.options->tile);
  if (n_bands == 1 || f->is_part || f->hiding || f->triangles || renderer->footprints.pointer)
    return CHAR_BIT * (int)sizeof height - 2;
  while ((size_t)2 << bits <= (size_t)height / n_bands || (CHAR_BIT << bits) < height)
    bits++;
  return bits;
}

/* By the loops of this machine's processor: in bands, of which each writes its records over those before, as touching
 * memory takes longer than setting up again what bands share. What has been touched serves all later pictures. */
static conic_status draw_here(conic_raster_frame *f, conic_image *image, conic_render_statistics *statistics) {
  conic_context *context = f->renderer->context;
  int bits = choose_band_bits(f), height = f->part.window.y_end;
  size_t tile = (size_t)f->finish.options->tile, n = f->splats->count;
  if (height <= 1 << bits)
    return draw_window(f, image, statistics);
  f->projected.bands = conic_keep_room(context, &f->renderer->bands, n, sizeof *f->projected.bands);
  if (!f->projected.bands)
    return CONIC_ERROR_MEMORY;
  memset(f->projected.bands, 0, n);
  f->is_part = 1;
  f->band_bits = bits;
  f->n_tiles_of_all = (((size_t)f->part.window.x_end + tile - 1) / tile) * (((size_t)height + tile - 1) / tile);
  conic_status status = CONIC_OK;
  /* NOLINTNEXTLINE(clang-analyzer-core.*): a band ends the picture before that */
  for (int band = 0; band << bits < height && status == CONIC_OK; band++) {
    f->projected.band = band ? 1u << band : 0;
    f->part.window.y_begin = band << bits;
    f->part.window.y_end = height - f->part.window.y_begin > 1 << bits ? f->part.window.y_begin + (1 << bits) : height;
    status = draw_window(f, image, statistics);
  }
  return status;
}

/* By another device, which draws all at once. */
static conic_status draw_there(conic_raster_frame *f, conic_image *image, conic_render_statistics *statistics) {
  conic_backend *backend = f->renderer->backend;
  conic_status status = backend->draw(backend, &f->view, f->splats, f->triangles, &f->finish, image, statistics);
  note_settings(f, statistics);
  if (f->finish.options->skip_hidden)
    statistics->fragments = 0;
  return status;
}

conic_status conic_raster_frame_take_passes(const conic_raster_frame *f, unsigned planes,
                                            conic_render_options *options) {
  if (options->passes != CONIC_PASS_OF_HIDING)
    return CONIC_OK;
  if (planes != 1u << CONIC_PLANE_Z)
    return conic_fail(f->renderer->context, CONIC_ERROR_ARGUMENT, "render: the pass of hiding has the plane Z alone");
  if (!f->splats->count && f->renderer->backend) /* a device hides by splats alone */
    options->passes = 1;
  return CONIC_OK;
}

/* All of conic_render, for the window and the plane that `f` names already. */
static conic_status render(conic_raster_frame *f, const conic_whole_drawing *drawing, const conic_camera *camera,
                           const conic_render_options *options, conic_image *image,
                           conic_render_statistics *statistics) {
  double start = conic_seconds_now();
  conic_render_statistics counted;
  memset(&counted, 0, sizeof counted);
  conic_render_options own = *options;
  conic_status status = image ? conic_raster_frame_take_passes(f, conic_image_planes(image), &own) : CONIC_OK;
  if (status == CONIC_OK)
    status = conic_raster_frame_begin(f, drawing, camera, &own);
  if (status == CONIC_OK)
    status = (f->renderer->backend ? draw_there : draw_here)(f, image, &counted);
  if (status != CONIC_OK)
    return status;
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
  conic_raster_frame f = {.renderer = renderer, .splats = drawing->splats, .part = whole_of(camera)};
  return render(&f, drawing, camera, options, image, statistics);
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
  conic_raster_frame f = {.renderer = renderer, .splats = splats, .part = *part, .is_part = 1};
  return render(&f, &alone, camera, options, image, statistics);
}

conic_status conic_render_hiding(conic_renderer *renderer, const conic_splats *splats, const conic_camera *camera,
                                 const conic_render_options *options, float *hiding) {
  const conic_whole_drawing alone = {.splats = splats};
  conic_status status = conic_renderer_check_parts(renderer);
  if (status != CONIC_OK)
    return status;
  conic_raster_frame f = {.renderer = renderer, .splats = splats, .part = whole_of(camera)};
  f.hiding = hiding;
  return render(&f, &alone, camera, options, NULL, NULL);
}
