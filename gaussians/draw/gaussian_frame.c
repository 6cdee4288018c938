/* A picture of Gaussians: set up, put in order, binned, composited. */

#include <math.h>
#include <stdatomic.h>

#include "core/base/base.h"
#include "core/image/view_arguments.h"
#include "gaussians/draw/gaussian_device.h"
#include "gaussians/draw/view_rays.h"

enum { SET_UP_RUN = 2048 };

struct conic_gaussian_picture {
  conic_context *context;
  const conic_gaussians *set;
  conic_gaussian_options options;
  conic_camera camera;
  conic_gaussian_view view;
  conic_gaussian_rules rules; /* of pixels */
  conic_gaussian_loops loops;
  conic_gaussian_statistics statistics;
  conic_gaussian_shape shape;
  conic_view_rays view_rays; /* of CONIC_SHAPE_SIGHT */
  /* By footprint: as they were set up, those of each run of the scene from its place on. */
  conic_gaussian_footprint *footprints;
  conic_gaussian_ray *rays;
  conic_gaussian_filter *filters;
  conic_gaussian_sight *sights;
  float (*normals)[3], *keys;
  size_t *n_of_run, *n_skipped_of_run, *n_entries_of_run, n_runs, n;
  int has_normals;
  conic_gaussian_steps *steps; /* null: nobody takes them */
  /* Of the window that is drawn. */
  const conic_gaussian_window *window;
  conic_gaussian_planes *planes;
  conic_gaussian_bins bins;
  void **rooms; /* by thread */
  atomic_uint_fast64_t n_pairs;
};

typedef conic_gaussian_picture frame;

static size_t count_met_tiles(const conic_gaussian_footprint *f) {
  size_t across = f->box[1][0] / CONIC_GAUSSIAN_TILE - f->box[0][0] / CONIC_GAUSSIAN_TILE + 1u,
         down = f->box[1][1] / CONIC_GAUSSIAN_TILE - f->box[0][1] / CONIC_GAUSSIAN_TILE + 1u;
  return across * down;
}

/* Gaussian i as footprint `to`. */
static conic_gaussian_fate set_up_one(const frame *f, size_t i, size_t to) {
  conic_gaussian_ray unused;
  conic_gaussian_filter unused_filter;
  conic_gaussian_sight unused_sight;
  return conic_gaussian_set_up(&f->view, f->set, i, &f->footprints[to], &f->keys[to], f->rays ? &f->rays[to] : &unused,
                               f->filters ? &f->filters[to] : &unused_filter,
                               f->sights ? &f->sights[to] : &unused_sight, f->normals ? f->normals[to] : NULL);
}

static void set_up_run(void *data, size_t i_run) {
  frame *f = data;
  size_t begin = i_run * SET_UP_RUN, to = begin;
  size_t end = begin + SET_UP_RUN < f->set->count ? begin + SET_UP_RUN : f->set->count;
  const int has_lanes = f->loops.set_up && !f->normals && conic_gaussian_has_ellipses(&f->view);
  conic_gaussian_ellipses e;
  for (size_t i = begin; i < end; i++) {
    const size_t at = (i - begin) % CONIC_ELLIPSES;
    if (at == 0) {
      e.is_good = 0;
      if (has_lanes && end - i >= CONIC_ELLIPSES)
        f->loops.set_up(&f->view, f->set, i, &e);
    }
    conic_gaussian_fate fate = e.is_good >> at & 1 ? conic_gaussian_take_ellipse(&f->view, f->set, &e, i - at, at,
                                                                                 &f->footprints[to], &f->keys[to])
                                                   : set_up_one(f, i, to);
    f->n_skipped_of_run[i_run] += fate == CONIC_GAUSSIAN_SKIPPED;
    f->n_entries_of_run[i_run] += fate == CONIC_GAUSSIAN_DRAWN ? count_met_tiles(&f->footprints[to]) : 0;
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
  is_done &=
      (f->n_entries_of_run = conic_memory_allocate_zeroed(f->context, f->n_runs, sizeof *f->n_entries_of_run)) != NULL;
  if (f->shape == CONIC_SHAPE_SIGHT)
    is_done &= (f->sights = conic_memory_allocate(f->context, count, sizeof *f->sights)) != NULL;
  else if (f->shape != CONIC_SHAPE_ELLIPSE)
    is_done &= (f->rays = conic_memory_allocate(f->context, count, sizeof *f->rays)) != NULL;
  if (f->shape == CONIC_SHAPE_FILTERED)
    is_done &= (f->filters = conic_memory_allocate(f->context, count, sizeof *f->filters)) != NULL;
  if (f->has_normals)
    is_done &= (f->normals = conic_memory_allocate(f->context, count, sizeof *f->normals)) != NULL;
  if (!is_done)
    return CONIC_ERROR_MEMORY;
  conic_memory_prefer_large_pages(f->context, f->footprints, count * sizeof *f->footprints);
  if (f->rays)
    conic_memory_prefer_large_pages(f->context, f->rays, count * sizeof *f->rays);
  conic_status status = conic_parallel_runs(f->context, "setup", 0.0, 0.3, f->n_runs, 64, set_up_run, f);
  for (size_t run = 0; run < f->n_runs; run++) {
    f->n += f->n_of_run[run];
    f->statistics.gaussians_skipped += f->n_skipped_of_run[run];
    f->statistics.entries += f->n_entries_of_run[run];
  }
  f->statistics.gaussians_drawn = f->n;
  f->statistics.gaussians_culled = count - f->n - f->statistics.gaussians_skipped;
  return status;
}

static conic_gaussian_target target_of(const frame *f) {
  const conic_gaussian_planes *p = f->planes;
  const float *background = f->options.background;
  return (conic_gaussian_target){p->width,    p->height,       {background[0], background[1], background[2]},
                                 p->rgb,      p->transparency, p->z,
                                 p->median_z, p->inverse_z,    p->normal,
                                 p->count,    p->id,           p->last};
}

static int wanted_of(const conic_gaussian_planes *p) {
  if (p->median_z || p->inverse_z || p->normal || p->id || p->last)
    return CONIC_GAUSSIAN_ALL;
  return p->z || p->surface_z ? CONIC_GAUSSIAN_DEPTHS : CONIC_GAUSSIAN_COLORS;
}

static uint64_t sum_of(const uint32_t *counts, size_t n) {
  uint64_t sum = 0;
  for (size_t i = 0; i < n; i++)
    sum += counts[i];
  return sum;
}

/* The surface's z at the tile's pixels, in their order; infinity where there is none. */
static void take_surface(const frame *f, const conic_gaussian_tile *tile, float surface_z[CONIC_GAUSSIAN_TILE_PIXELS]) {
  const conic_gaussian_planes *p = f->planes;
  for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++) {
    int x = tile->x + conic_gaussian_column(at) - f->window->begin[0],
        y = tile->y + conic_gaussian_row(at) - f->window->begin[1];
    float z = x < p->width && y < p->height ? p->surface_z[(size_t)y * (size_t)p->width + (size_t)x] : 0.0f;
    surface_z[at] = z > 0.0f ? z : INFINITY;
  }
}

static void composite_tile(void *data, size_t i_tile, int i_thread) {
  frame *f = data;
  const conic_gaussian_target target = target_of(f);
  conic_gaussian_tile tile;
  float surface_z[CONIC_GAUSSIAN_TILE_PIXELS];
  const size_t x = f->bins.first_x + i_tile % f->bins.n_tiles_x, y = f->bins.first_y + i_tile / f->bins.n_tiles_x;
  const conic_view_rays *rays = f->view.rays;
  conic_gaussian_tile_begin(&tile, (int)x * CONIC_GAUSSIAN_TILE, (int)y * CONIC_GAUSSIAN_TILE);
  conic_gaussian_list list = {.rules = &f->rules,
                              .footprints = f->footprints,
                              .rays = f->rays,
                              .filters = f->filters,
                              .sights = f->sights,
                              .tile_rays = rays ? &rays->tiles[y * (size_t)rays->n_tiles[0] + x] : NULL,
                              .is_parallel = f->view.is_parallel,
                              .normals = (const float(*)[3])f->normals,
                              .wants = wanted_of(f->planes),
                              .entries = f->bins.entries + f->bins.tile_begin[i_tile],
                              .n = f->bins.tile_begin[i_tile + 1] - f->bins.tile_begin[i_tile],
                              .surface_z = f->planes->surface_z ? surface_z : NULL,
                              .steps = f->steps,
                              .room = f->rooms ? f->rooms[i_thread] : NULL};
  if (list.surface_z)
    take_surface(f, &tile, surface_z);
  f->loops.composite[f->shape](&list, &tile);
  tile.x -= f->window->begin[0]; /* where the planes begin */
  tile.y -= f->window->begin[1];
  conic_gaussian_tile_end(&target, &tile);
  atomic_fetch_add_explicit(&f->n_pairs, sum_of(tile.count, CONIC_GAUSSIAN_TILE_PIXELS), memory_order_relaxed);
}

/* Room for the longest list. */
static conic_status make_rooms(frame *f) {
  const size_t threads = (size_t)conic_context_threads(f->context);
  if (f->view.rules->shape != CONIC_SHAPE_RAY && f->shape != CONIC_SHAPE_SIGHT)
    return CONIC_OK;
  const size_t longest = conic_gaussian_bins_longest(&f->bins);
  f->rooms = conic_memory_allocate_zeroed(f->context, threads, sizeof *f->rooms);
  if (!f->rooms)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < threads; i++)
    if (!(f->rooms[i] = conic_memory_allocate(f->context, longest + 16, CONIC_GAUSSIAN_ROOM)))
      return CONIC_ERROR_MEMORY;
  return CONIC_OK;
}

static conic_status composite_here(frame *f) {
  conic_status status = make_rooms(f);
  return status == CONIC_OK ? conic_parallel_told(f->context, "composite", 0.5, 1.0, f->bins.n_tiles, composite_tile, f)
                            : status;
}

static conic_status composite_on_device(frame *f) {
  const size_t n = (size_t)f->planes->width * (size_t)f->planes->height;
  uint32_t *counts = f->planes->count ? NULL : conic_memory_allocate(f->context, n, sizeof *counts);
  conic_gaussian_composition composition = {.rules = &f->rules,
                                            .n_drawn = f->n,
                                            .n = f->set->count,
                                            .footprints = f->footprints,
                                            .rays = f->rays,
                                            .normals = (const float(*)[3])f->normals,
                                            .wants = wanted_of(f->planes),
                                            .bins = &f->bins,
                                            .target = target_of(f)};
  if (!composition.target.count)
    composition.target.count = counts;
  if (!composition.target.count)
    return CONIC_ERROR_MEMORY;
  conic_status status = f->options.device->composite(f->options.device, &composition);
  if (status == CONIC_OK)
    f->n_pairs += sum_of(composition.target.count, n);
  conic_memory_release(f->context, counts);
  return status;
}

static void release_window(frame *f) {
  for (int i = 0; f->rooms && i < conic_context_threads(f->context); i++)
    conic_memory_release(f->context, f->rooms[i]);
  conic_memory_release(f->context, f->rooms);
  f->rooms = NULL;
  conic_gaussian_bins_release(f->context, &f->bins);
}

void conic_gaussian_picture_release(conic_gaussian_picture *f) {
  if (!f)
    return;
  conic_memory_keep(f->context, f->footprints);
  conic_memory_keep(f->context, f->keys);
  conic_memory_keep(f->context, f->rays);
  conic_memory_release_these(f->context, f->filters, f->sights, f->normals, f->n_of_run, f->n_skipped_of_run,
                             f->n_entries_of_run);
  conic_view_rays_release(f->context, &f->view_rays);
  conic_memory_release(f->context, f);
}

const conic_gaussian_statistics *conic_gaussian_picture_statistics(const conic_gaussian_picture *f) {
  return &f->statistics;
}

static conic_status composite_window(frame *f) {
  const conic_gaussian_runs runs = {f->footprints, f->keys, f->n_of_run, f->n_runs, SET_UP_RUN};
  double begin = conic_seconds_now(), now;
  conic_status status = conic_gaussian_bins_make(f->context, &runs, f->window, &f->bins);
  f->statistics.seconds_bin += (now = conic_seconds_now()) - begin;
  if (status == CONIC_OK)
    status = conic_gaussian_bins_sort(f->context, &runs, &f->bins);
  f->statistics.seconds_sort += conic_seconds_now() - now;
  now = conic_seconds_now();
  if (status == CONIC_OK)
    status = f->options.device ? composite_on_device(f) : composite_here(f);
  f->statistics.seconds_composite += conic_seconds_now() - now;
  f->statistics.pairs = f->n_pairs;
  return status;
}

void conic_gaussian_picture_note(conic_gaussian_picture *f, conic_gaussian_steps *steps) {
  f->steps = steps;
  f->options.device = NULL;
  conic_gaussian_loops_init(&f->loops, CONIC_ISA_SCALAR);
}

conic_status conic_gaussian_picture_draw(conic_gaussian_picture *f, const conic_gaussian_window *window,
                                         conic_gaussian_planes *planes) {
  for (int axis = 0; axis < 2 && f->steps; axis++)
    f->steps->first[axis] = window->begin[axis];
  f->window = window;
  f->planes = planes;
  conic_status status = planes->surface_z && f->options.device
                            ? conic_fail(f->context, CONIC_ERROR_ARGUMENT, "gaussians: a device knows no surfaces")
                            : composite_window(f);
  release_window(f);
  return status;
}

/* What knows of no centre but the picture's would draw another one's picture somewhere else. */
static conic_status check_center(conic_context *context, const conic_gaussian_options *options,
                                 const conic_camera *camera) {
  static const double slack_px = 1e-6; /* of a scaled camera */
  double across = camera->cx - 0.5 * camera->width, down = camera->cy - 0.5 * camera->height;
  if (!conic_profile_row_of(options->profile)->takes_middle || options->ignores_center ||
      (fabs(across) <= slack_px && fabs(down) <= slack_px))
    return CONIC_OK;
  return conic_fail(context, CONIC_ERROR_ARGUMENT,
                    "gaussians: %s ignores the camera's centre, which is %g, %g pixels off the picture's; "
                    "--profile %s:ignore-center draws it all the same",
                    conic_gaussian_profile_name(options->profile), across, down,
                    conic_gaussian_profile_name(options->profile));
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

static void take_eye_of_shutter(const conic_camera *camera, conic_gaussian_view *view) {
  conic_camera_shutter_eye(camera, view->eye);
  for (int axis = 0; axis < 3; axis++)
    view->eye[axis] = (double)(float)view->eye[axis];
}

/* Whether rays are affine on the screen. */
static int is_affine(const conic_camera *camera) {
  return camera->kind == CONIC_CAMERA_ORTHOGRAPHIC ||
         (camera->kind == CONIC_CAMERA_PERSPECTIVE && !camera->lens && !camera->shutter);
}

static conic_status check_sight(conic_context *context, const conic_camera *camera,
                                const conic_gaussian_options *options) {
  int takes_all = options->profile == CONIC_PROFILE_EXACT;
  double h = options->prefilter;
  conic_status status = conic_view_profile_check(context, "gaussians", conic_profile_row_of(options->profile), camera);
  if (status == CONIC_OK && (!(h >= 0.0 && h <= 1e4) || (h > 0.0 && !takes_all)))
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "gaussians: the prefilter is out of range (0 to 10000), or of another profile than exact, which "
                      "has its own");
  if (status == CONIC_OK && h > 0.0 && !is_affine(camera))
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "gaussians: the prefilter is of pinholes and orthographic cameras");
  if (status == CONIC_OK && options->device && (h > 0.0 || !is_affine(camera)))
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "gaussians: a device draws neither a prefilter nor other cameras than pinholes and orthographic "
                      "ones");
  return status;
}

static conic_status set_up_scene(frame *f) {
  double begin = conic_seconds_now();
  conic_status status =
      f->view.rays ? conic_view_rays_make(f->context, f->view.camera, f->view.rules, &f->view_rays) : CONIC_OK;
  if (status == CONIC_OK)
    status = set_up_all(f);
  f->statistics.seconds_setup = conic_seconds_now() - begin;
  return status;
}

static void look_at_scene(frame *f, conic_isa isa) {
  const conic_gaussian_options *own = &f->options;
  const conic_camera *camera = &f->camera;
  f->view.rules = conic_profile_row_of(own->profile);
  f->rules = conic_gaussian_rules_of(f->view.rules);
  f->view.prefilter = own->prefilter;
  f->view.is_parallel = camera->kind == CONIC_CAMERA_ORTHOGRAPHIC;
  f->view.rays = is_affine(camera) ? NULL : &f->view_rays;
  f->shape = f->view.rays ? CONIC_SHAPE_SIGHT : own->prefilter > 0.0 ? CONIC_SHAPE_FILTERED : f->view.rules->shape;
  f->statistics.gaussians_in = f->set->count;
  f->statistics.isa = isa;
  f->statistics.device_units = own->device ? (uint64_t)own->device->n_units : 0;
  f->statistics.tile = CONIC_GAUSSIAN_TILE;
  conic_gaussian_loops_init(&f->loops, isa);
  look_through(camera, &f->view);
}

conic_status conic_gaussian_picture_begin(conic_context *context, const conic_gaussians *gaussians,
                                          const conic_camera *camera, const conic_gaussian_options *options,
                                          int has_normals, conic_gaussian_picture **picture) {
  conic_gaussian_options own;
  conic_isa isa;
  *picture = NULL;
  conic_gaussian_options_init(&own);
  if (!gaussians || !camera || (options && !conic_options_take(&own, options)) || !conic_profile_row_of(own.profile))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "gaussians: an argument is null, or there is no such profile");
  conic_status status = check_sight(context, camera, &own);
  if (status == CONIC_OK)
    status = check_center(context, &own, camera);
  if (status != CONIC_OK || (status = conic_isa_choose(context, own.isa, &isa)) != CONIC_OK)
    return status;
  frame *f = conic_memory_allocate_zeroed(context, 1, sizeof *f);
  if (!f)
    return CONIC_ERROR_MEMORY;
  f->context = context;
  f->set = gaussians;
  f->options = own;
  conic_camera_shutter_middle(camera, &f->camera);
  f->has_normals = has_normals;
  look_at_scene(f, isa);
  if (camera->shutter)
    take_eye_of_shutter(camera, &f->view);
  status = set_up_scene(f);
  if (status == CONIC_OK)
    *picture = f;
  else
    conic_gaussian_picture_release(f);
  return status;
}

conic_status conic_gaussians_render(conic_context *context, const conic_gaussians *gaussians,
                                    const conic_camera *camera, const conic_gaussian_options *options,
                                    conic_gaussian_planes *planes, conic_gaussian_statistics *statistics) {
  conic_gaussian_picture *picture;
  if (!camera || !planes || planes->width != camera->width || planes->height != camera->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "gaussians: an argument is null, or the planes are not of the camera's size");
  const conic_gaussian_window whole = {{0, 0}, {camera->width, camera->height}};
  conic_status status =
      conic_gaussian_picture_begin(context, gaussians, camera, options, planes->normal != NULL, &picture);
  if (status == CONIC_OK)
    status = conic_gaussian_picture_draw(picture, &whole, planes);
  if (picture && statistics)
    *statistics = *conic_gaussian_picture_statistics(picture);
  conic_gaussian_picture_release(picture);
  return status;
}
