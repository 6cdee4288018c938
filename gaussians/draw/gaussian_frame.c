/* A picture of Gaussians: set up, put in order, binned, composited. */
#include <stddef.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/base/radix.h"
#include "core/base/real.h"
#include "core/base/threads.h"
#include "core/image/view_arguments.h"
#include "gaussians/draw/gaussian_bins.h"

enum { SET_UP_RUN = 2048 };

typedef struct frame {
  conic_context *context;
  const conic_gaussians *set;
  const conic_gaussian_options *options;
  conic_gaussian_planes *planes;
  conic_gaussian_view view;
  conic_gaussian_kernels kernels;
  conic_gaussian_statistics statistics;
  int has_rays;
  /* By footprint: as they were set up, those of each run of the scene from its place on. */
  conic_gaussian_footprint *footprints;
  conic_gaussian_ray *rays;
  float (*normals)[3];
  uint32_t *keys;
  size_t *n_of_run, *n_skipped_of_run, n_runs, n;
  conic_radix_item *order;
  conic_gaussian_bins bins;
  void **rooms; /* by thread */
} frame;

/* Keys are depths over 0, or of a mean behind the eye below: ordered as their bits are, once those below are turned. */
static uint32_t key_of(float key) {
  uint32_t bits = conic_bits_of_float(key);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

static void set_up_run(void *data, size_t i_run, int i_thread) {
  frame *f = data;
  size_t begin = i_run * SET_UP_RUN, to = begin;
  size_t end = begin + SET_UP_RUN < f->set->count ? begin + SET_UP_RUN : f->set->count;
  conic_gaussian_ray unused;
  (void)i_thread;
  for (size_t i = begin; i < end; i++) {
    float key = 0.0f;
    conic_gaussian_fate fate =
        conic_gaussian_set_up(&f->view, f->set, i, &f->footprints[to], &key, f->has_rays ? &f->rays[to] : &unused,
                              f->normals ? f->normals[to] : NULL);
    f->keys[to] = key_of(key);
    f->n_skipped_of_run[i_run] += fate == CONIC_GAUSSIAN_SKIPPED;
    to += fate == CONIC_GAUSSIAN_DRAWN;
  }
  f->n_of_run[i_run] = to - begin;
}

static conic_status set_up_all(frame *f) {
  const size_t count = f->set->count;
  int is_done = 1;
  f->n_runs = (count + SET_UP_RUN - 1) / SET_UP_RUN;
  is_done &= (f->footprints = conic_memory_allocate(f->context, count, sizeof *f->footprints)) != NULL;
  is_done &= (f->keys = conic_memory_allocate(f->context, count, sizeof *f->keys)) != NULL;
  is_done &= (f->n_of_run = conic_memory_allocate_zeroed(f->context, f->n_runs, sizeof *f->n_of_run)) != NULL;
  is_done &=
      (f->n_skipped_of_run = conic_memory_allocate_zeroed(f->context, f->n_runs, sizeof *f->n_skipped_of_run)) != NULL;
  if (f->has_rays)
    is_done &= (f->rays = conic_memory_allocate(f->context, count, sizeof *f->rays)) != NULL;
  if (f->planes->normal)
    is_done &= (f->normals = conic_memory_allocate(f->context, count, sizeof *f->normals)) != NULL;
  if (!is_done)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_parallel_runs(f->context, "setup", 0.0, 0.3, f->n_runs, 64, set_up_run, f);
  for (size_t run = 0; run < f->n_runs; run++) {
    f->n += f->n_of_run[run];
    f->statistics.gaussians_skipped += f->n_skipped_of_run[run];
  }
  f->statistics.gaussians_drawn = f->n;
  f->statistics.gaussians_culled = count - f->n - f->statistics.gaussians_skipped;
  return status;
}

static conic_status order_footprints(frame *f) {
  f->order = conic_memory_allocate(f->context, f->n, sizeof *f->order);
  if (!f->order)
    return CONIC_ERROR_MEMORY;
  const int is_by_ray = f->view.rules->shape == CONIC_SHAPE_RAY;
  size_t n = 0;
  for (size_t run = 0; run < f->n_runs; run++)
    for (size_t i = run * SET_UP_RUN; i < run * SET_UP_RUN + f->n_of_run[run]; i++)
      f->order[n++] = (conic_radix_item){is_by_ray ? key_of(f->footprints[i].z) : f->keys[i], (uint32_t)i};
  return conic_radix_sort(f->context, f->order, n, 32);
}

static int wants_all(const conic_gaussian_planes *to) {
  return to->z || to->median_z || to->inverse_z || to->normal || to->count || to->id || to->last;
}

static void begin_compositing(const frame *f, size_t i_tile, conic_gaussian_tile *tile) {
  memset(tile, 0, wants_all(f->planes) ? sizeof *tile : offsetof(conic_gaussian_tile, sum));
  for (size_t i = 0; i < CONIC_GAUSSIAN_TILE_PIXELS; i++)
    tile->T[i] = 1.0f;
  for (size_t i = 0; i < CONIC_GAUSSIAN_TILE_PIXELS && wants_all(f->planes); i++)
    tile->id[i] = tile->last[i] = CONIC_NO_ID;
  tile->x = (int)(i_tile % f->bins.n_tiles_x) * CONIC_GAUSSIAN_TILE;
  tile->y = (int)(i_tile / f->bins.n_tiles_x) * CONIC_GAUSSIAN_TILE;
}

/* Writes one of `n_channels` numbers of four bytes, at each pixel of the tile that is in the picture. */
static void put_channel(const frame *f, const conic_gaussian_tile *tile, void *plane, size_t n_channels, size_t channel,
                        const void *numbers) {
  const int width = f->planes->width, height = f->planes->height;
  const int columns = width - tile->x < CONIC_GAUSSIAN_TILE ? width - tile->x : CONIC_GAUSSIAN_TILE;
  const uint32_t *from = numbers;
  for (int row = 0; plane && row < CONIC_GAUSSIAN_TILE && tile->y + row < height; row++) {
    uint32_t *to = (uint32_t *)plane + ((size_t)(tile->y + row) * (size_t)width + (size_t)tile->x) * n_channels;
    for (int column = 0; column < columns; column++)
      to[(size_t)column * n_channels + channel] = from[conic_gaussian_pixel(column, row)];
  }
}

static void end_compositing(const frame *f, const conic_gaussian_tile *tile) {
  const conic_gaussian_planes *to = f->planes;
  float numbers[CONIC_GAUSSIAN_TILE_PIXELS];
  put_channel(f, tile, to->transparency, 1, 0, tile->T);
  for (size_t c = 0; c < 3; c++) {
    for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++)
      numbers[at] = tile->rgb[c][at] + tile->T[at] * f->options->background[c];
    put_channel(f, tile, to->rgb, 3, c, numbers);
  }
  if (!wants_all(to))
    return;
  for (size_t c = 0; c < 3; c++)
    put_channel(f, tile, to->normal, 3, c, tile->normal[c]);
  for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++)
    numbers[at] = tile->sum[at] > 0.0f ? tile->sum_of_z[at] / tile->sum[at] : 0.0f;
  put_channel(f, tile, to->z, 1, 0, numbers);
  put_channel(f, tile, to->median_z, 1, 0, tile->median_z);
  put_channel(f, tile, to->inverse_z, 1, 0, tile->inverse_z);
  put_channel(f, tile, to->count, 1, 0, tile->count);
  put_channel(f, tile, to->id, 1, 0, tile->id);
  put_channel(f, tile, to->last, 1, 0, tile->last);
}

static void composite_tile(void *data, size_t i_tile, int i_thread) {
  frame *f = data;
  conic_gaussian_tile tile;
  begin_compositing(f, i_tile, &tile);
  conic_gaussian_list list = {.rules = f->view.rules,
                              .footprints = f->footprints,
                              .rays = f->rays,
                              .normals = (const float(*)[3])f->normals,
                              .keys = f->keys,
                              .wants_all = wants_all(f->planes),
                              .entries = f->bins.entries + f->bins.tile_begin[i_tile],
                              .n = f->bins.tile_begin[i_tile + 1] - f->bins.tile_begin[i_tile],
                              .room = f->rooms ? f->rooms[i_thread] : NULL};
  f->kernels.composite[f->view.rules->shape](&list, &tile);
  end_compositing(f, &tile);
}

/* Room for the longest list. */
static conic_status make_rooms(frame *f) {
  const size_t threads = (size_t)conic_context_threads(f->context);
  size_t longest = 0;
  if (f->view.rules->shape != CONIC_SHAPE_RAY)
    return CONIC_OK;
  for (size_t tile = 0; tile < f->bins.n_tiles; tile++) {
    size_t n = f->bins.tile_begin[tile + 1] - f->bins.tile_begin[tile];
    longest = n > longest ? n : longest;
  }
  f->rooms = conic_memory_allocate_zeroed(f->context, threads, sizeof *f->rooms);
  if (!f->rooms)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < threads; i++)
    if (!(f->rooms[i] = conic_memory_allocate(f->context, longest + 16, CONIC_GAUSSIAN_ROOM)))
      return CONIC_ERROR_MEMORY;
  return CONIC_OK;
}

static void release_frame(frame *f) {
  void *const all[] = {f->footprints, f->keys, f->rays, f->normals, f->n_of_run, f->n_skipped_of_run, f->order};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    conic_memory_release(f->context, all[i]);
  for (int i = 0; f->rooms && i < conic_context_threads(f->context); i++)
    conic_memory_release(f->context, f->rooms[i]);
  conic_memory_release(f->context, f->rooms);
  conic_gaussian_bins_release(f->context, &f->bins);
}

static conic_status draw_scene(frame *f) {
  double begin = conic_seconds_now(), now;
  conic_status status = set_up_all(f);
  f->statistics.seconds_setup = (now = conic_seconds_now()) - begin;
  if (status == CONIC_OK)
    status = order_footprints(f);
  f->statistics.seconds_sort = conic_seconds_now() - now;
  now = conic_seconds_now();
  if (status == CONIC_OK)
    status = conic_gaussian_bins_make(f->context, f->footprints, f->order, f->n, f->planes->width, f->planes->height,
                                      &f->bins);
  f->statistics.seconds_bin = conic_seconds_now() - now;
  now = conic_seconds_now();
  if (status == CONIC_OK)
    status = make_rooms(f);
  if (status == CONIC_OK) {
    f->statistics.entries = f->bins.tile_begin[f->bins.n_tiles];
    status = conic_parallel_told(f->context, "composite", 0.5, 1.0, f->bins.n_tiles, composite_tile, f);
  }
  f->statistics.seconds_composite = conic_seconds_now() - now;
  return status;
}

static void look_through(const conic_camera *camera, conic_gaussian_view *view) {
  view->camera = camera;
  for (int axis = 0; axis < 3; axis++) {
    const double(*rows)[4] = camera->cam_from_world;
    double eye = -(rows[0][axis] * rows[0][3] + rows[1][axis] * rows[1][3] + rows[2][axis] * rows[2][3]);
    view->eye[axis] = view->rules->has_float_eye ? (double)(float)eye : eye;
  }
  view->center_px[0] = view->rules->takes_middle ? 0.5 * camera->width : camera->cx;
  view->center_px[1] = view->rules->takes_middle ? 0.5 * camera->height : camera->cy;
}

conic_status conic_gaussians_render(conic_context *context, const conic_gaussians *gaussians,
                                    const conic_camera *camera, const conic_gaussian_options *options,
                                    conic_gaussian_planes *planes, conic_gaussian_statistics *statistics) {
  conic_gaussian_options own;
  conic_isa isa;
  conic_gaussian_options_init(&own);
  if (!gaussians || !camera || !planes || (options && !conic_options_take(&own, options)) ||
      !conic_gaussian_rules_of(own.profile) || planes->width != camera->width || planes->height != camera->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "gaussians: an argument is null, or there is no such profile, or the planes are not of the "
                      "camera's size");
  conic_status status = conic_view_pinhole_check(context, "gaussians", camera);
  if (status != CONIC_OK || (status = conic_isa_choose(context, own.isa, &isa)) != CONIC_OK)
    return status;
  frame f = {.context = context, .set = gaussians, .options = &own, .planes = planes};
  f.view.rules = conic_gaussian_rules_of(own.profile);
  f.has_rays = f.view.rules->shape != CONIC_SHAPE_ELLIPSE;
  f.statistics.gaussians_in = gaussians->count;
  f.statistics.isa = isa;
  f.statistics.tile = CONIC_GAUSSIAN_TILE;
  conic_gaussian_kernels_init(&f.kernels, isa);
  look_through(camera, &f.view);
  status = draw_scene(&f);
  release_frame(&f);
  if (statistics)
    *statistics = f.statistics;
  return status;
}
