/* Gaussian scenes: they draw themselves, composited by alpha. */

#include "source/together/gaussians_source.h"

#include <stdatomic.h>

#include "conic/opencl.h"
#include "core/base/vectors.h"
#include "core/image/image_common.h"
#include "core/splats/gaussian_profile.h"
#include "gaussians/draw/gaussian_parts.h"
#include "gaussians/draw/surfaces_join.h"
#include "gaussians/scene/gaussian_set.h"
#include "raster/frame/samples.h"
#include "raster/frame/statistics.h"
#include "source/surfaces_among.h"

typedef conic_gaussians_source gaussians_source;

/* Fainter Gaussians say little about where the scene is. */
static const float least_opacity = 0.1f;

int conic_gaussians_source_takes(const char *path, const conic_source_options *options) {
  conic_context *context; /* a context of its own, without messages: it is only a question whether a file is a scene */
  conic_context_options quiet;
  conic_context_options_init(&quiet);
  quiet.threads = 1;
  if (!options->gaussians || conic_context_create(&quiet, &context) != CONIC_OK)
    return 0;
  int is_one = conic_gaussians_is_file(context, path) || conic_levels_is_file(path);
  conic_context_destroy(context);
  return is_one;
}

/* A dot for every Gaussian that is not faint, for framing by the camera. */
static conic_status outline_means(gaussians_source *g) {
  const conic_gaussians *set = &g->gaussians;
  conic_splats *outline = &g->base.outline;
  conic_status status = conic_splats_allocate(g->base.context, set->count, CONIC_SPLATS_TANGENTS, outline);
  if (status != CONIC_OK)
    return status;
  memcpy(outline->origin, set->origin, sizeof outline->origin);
  outline->count = 0;
  for (size_t i = 0; i < set->count; i++) {
    size_t at = outline->count;
    float place = set->position[0][i] + set->position[1][i] + set->position[2][i];
    if (!(set->opacity[i] >= least_opacity) || place - place != 0.0f)
      continue;
    for (int axis = 0; axis < 3; axis++) {
      outline->position[axis][at] = set->position[axis][i];
      outline->tangent_u[axis][at] = axis == 0 ? set->scale[0][i] : 0.0f;
      outline->tangent_v[axis][at] = axis == 1 ? set->scale[0][i] : 0.0f;
    }
    outline->count++;
  }
  if (outline->count == 0) /* all Gaussians are faint: the picture will show it */
    conic_splats_release(g->base.context, outline);
  return CONIC_OK;
}

conic_status conic_gaussians_source_measure(conic_gaussians_source *g) {
  conic_source_scale *scale = &g->base.scale;
  if (conic_gaussians_bounds(&g->gaussians, scale->minimum, scale->maximum) == 0)
    return conic_fail(g->base.context, CONIC_ERROR_INPUT, "%s: there is no Gaussian that could be drawn", g->base.name);
  scale->n_splats = g->gaussians.count;
  scale->has_colors = 1;
  conic_gaussians_find_up(&g->gaussians, scale->up);
  scale->up_basis = CONIC_UP_KIND;
  return outline_means(g);
}

static int is_composited(const conic_source *source) {
  return (source->kind->abilities & CONIC_SOURCE_COMPOSITES) != 0;
}

const conic_gaussians *conic_source_gaussians(const conic_source *source) {
  return is_composited(source) ? &((const gaussians_source *)source)->gaussians : NULL;
}

conic_source *conic_source_surfaces(const conic_source *source) {
  return is_composited(source) ? ((const gaussians_source *)source)->surfaces : NULL;
}

conic_status conic_source_composite_by(conic_source *source, const conic_gaussian_options *options) {
  gaussians_source *g = (gaussians_source *)source;
  if (is_composited(source) && !conic_options_take(&g->options, options))
    return conic_fail(source->context, CONIC_ERROR_ARGUMENT, "%s: the options of Gaussian scenes are none",
                      source->name);
  return CONIC_OK;
}

void conic_gaussians_source_close(conic_source *source) {
  gaussians_source *g = (gaussians_source *)source;
  if (!g->is_lent)
    conic_gaussians_release(source->context, &g->gaussians);
  conic_gaussians_release(source->context, &g->rest);
  conic_source_close(g->surfaces);
  for (size_t i = 0; i < g->n_inputs; i++) {
    if (!g->inputs[i].is_lent)
      conic_gaussians_release(source->context, &g->inputs[i].set);
    conic_levels_close(g->inputs[i].levels);
  }
  conic_memory_release(source->context, g->inputs);
}

/* A window of the picture with several samples a pixel. */
typedef struct fine_picture {
  conic_gaussian_planes planes;
  conic_image *surfaces;  /* null: there are none */
  int samples, is_opaque; /* is_opaque: there is a background */
} fine_picture;

static int wants(const conic_image *image, conic_plane plane) {
  return image->planes[plane] != NULL;
}

static conic_status allocate_planes(conic_context *context, const conic_image *image, fine_picture *fine) {
  conic_gaussian_planes *p = &fine->planes;
  const size_t n = (size_t)p->width * (size_t)p->height;
  const struct {
    void *plane;
    int is_wanted;
    size_t channels;
  } all[] = {{&p->rgb, 1, 3},
             {&p->transparency, 1, 1},
             {&p->z, wants(image, CONIC_PLANE_Z), 1},
             {&p->median_z, wants(image, CONIC_PLANE_MEDIAN_Z), 1},
             {&p->inverse_z, wants(image, CONIC_PLANE_INVERSE_Z), 1},
             {&p->normal, wants(image, CONIC_PLANE_NORMAL), 3},
             {&p->count, wants(image, CONIC_PLANE_COUNT), 1},
             {&p->id, wants(image, CONIC_PLANE_ID), 1},
             {&p->last, wants(image, CONIC_PLANE_LAST), 1}};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    void *plane = all[i].is_wanted ? conic_memory_allocate(context, n * all[i].channels, sizeof(float)) : NULL;
    if (all[i].is_wanted && !plane)
      return CONIC_ERROR_MEMORY;
    memcpy(all[i].plane, &plane, sizeof plane);
  }
  return CONIC_OK;
}

static void release_planes(conic_context *context, fine_picture *fine) {
  conic_gaussian_planes *p = &fine->planes;
  conic_memory_keep(context, p->rgb);
  conic_memory_keep(context, p->transparency);
  conic_memory_keep(context, p->z);
  conic_memory_release_these(context, p->median_z, p->inverse_z, p->normal, p->count, p->id, p->last);
}

static double mean_of(const fine_picture *fine, const float *plane, size_t channels, size_t channel, size_t x,
                      size_t y) {
  const size_t n = (size_t)fine->samples, width = (size_t)fine->planes.width;
  double sum = 0.0;
  for (size_t row = y * n; row < (y + 1) * n; row++)
    for (size_t column = x * n; column < (x + 1) * n; column++)
      sum += (double)plane[(row * width + column) * channels + channel];
  return sum / (double)(n * n);
}

static void mean_normal(const fine_picture *fine, size_t x, size_t y, float normal[3]) {
  double n[3];
  for (size_t c = 0; c < 3; c++)
    n[c] = mean_of(fine, fine->planes.normal, 3, c, x, y);
  conic_normalize(n);
  for (int c = 0; c < 3; c++)
    normal[c] = (float)n[c];
}

/* Makes colour, alpha and normal of one pixel of n × n samples. Returns whether it shows anything. */
static int reduce_pixel(const fine_picture *fine, size_t x, size_t y, size_t pixel, const conic_image *image) {
  const conic_gaussian_planes *p = &fine->planes;
  float T = (float)mean_of(fine, p->transparency, 1, 0, x, y), *rgba = image->planes[CONIC_PLANE_RGBA];
  for (size_t c = 0; c < 3 && rgba; c++)
    rgba[4 * pixel + c] = (float)mean_of(fine, p->rgb, 3, c, x, y);
  if (rgba)
    rgba[4 * pixel + 3] = fine->is_opaque ? 1.0f : 1.0f - T;
  if (p->normal)
    mean_normal(fine, x, y, (float *)image->planes[CONIC_PLANE_NORMAL] + 3 * pixel);
  return T < 1.0f;
}

/* All other planes, as docs/reference/picture.md defines them; those that nobody fills are 0. */
static void reduce_others(conic_context *context, const fine_picture *picture, const conic_image *image) {
  const conic_gaussian_planes *p = &picture->planes;
  conic_image fine = {.width = p->width, .height = p->height}, others = *image;
  for (int i = 0; i < CONIC_N_PLANES && picture->surfaces; i++)
    fine.planes[i] = CONIC_SURFACES_PLANES >> i & 1 ? picture->surfaces->planes[i] : NULL;
  fine.planes[CONIC_PLANE_TRANSPARENCY] = p->transparency;
  fine.planes[CONIC_PLANE_Z] = p->z;
  fine.planes[CONIC_PLANE_MEDIAN_Z] = p->median_z;
  fine.planes[CONIC_PLANE_INVERSE_Z] = p->inverse_z;
  fine.planes[CONIC_PLANE_COUNT] = p->count;
  fine.planes[CONIC_PLANE_ID] = p->id;
  fine.planes[CONIC_PLANE_LAST] = p->last;
  others.planes[CONIC_PLANE_RGBA] = others.planes[CONIC_PLANE_NORMAL] = NULL;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (others.planes[i] && !fine.planes[i]) {
      memset(others.planes[i], 0,
             conic_image_pixels(image) * (size_t)conic_plane_describe((conic_plane)i)->n_channels * 4);
      others.planes[i] = NULL;
    }
  conic_samples_reduce(context, &fine, picture->samples, 0, 0, &others);
}

typedef struct sample_reduction {
  const fine_picture *fine;
  const conic_image *image;
  atomic_uint_fast64_t n_covered;
} sample_reduction;

static void reduce_samples_of_row(void *data, size_t y) {
  sample_reduction *r = data;
  const size_t width = (size_t)r->image->width;
  uint64_t n_covered = 0;
  for (size_t x = 0; x < width; x++)
    n_covered += (uint64_t)reduce_pixel(r->fine, x, y, y * width + x, r->image);
  atomic_fetch_add_explicit(&r->n_covered, n_covered, memory_order_relaxed);
}

static uint64_t reduce_samples(conic_context *context, const fine_picture *fine, const conic_image *image) {
  sample_reduction r = {.fine = fine, .image = image};
  conic_parallel_for(context, (size_t)image->height, reduce_samples_of_row, &r);
  return r.n_covered;
}

static void tell_drawing(const gaussians_source *g, uint64_t n_pairs, uint64_t n_covered,
                         conic_render_statistics *statistics) {
  const conic_gaussian_statistics *s = &g->drawn;
  memset(statistics, 0, sizeof *statistics);
  statistics->splats_in = s->gaussians_in;
  statistics->splats_drawn = s->gaussians_drawn;
  statistics->splats_culled = s->gaussians_culled;
  statistics->splats_skipped = s->gaussians_skipped;
  statistics->fragments = n_pairs;
  statistics->pixels_covered = n_covered;
  statistics->threads = s->device_units ? (int)s->device_units : conic_parallel_threads(g->base.context);
  statistics->tile = s->tile;
  statistics->isa = s->device_units ? "opencl" : conic_isa_name(s->isa);
  statistics->ms.setup = 1e3 * s->seconds_setup;
  statistics->ms.bin = 1e3 * (s->seconds_sort + s->seconds_bin);
  statistics->ms.accumulate = 1e3 * s->seconds_composite;
  statistics->ms.frame = statistics->ms.setup + statistics->ms.bin + statistics->ms.accumulate;
}

/* --- surfaces among them --- */

conic_surfaces_look conic_surfaces_look_of(const conic_source *source, const conic_camera *camera,
                                           const conic_render_options *render, const conic_source_view *view,
                                           unsigned planes) {
  const unsigned ids = 1u << CONIC_PLANE_ID | 1u << CONIC_PLANE_LAST;
  conic_surfaces_look look = {conic_samples_camera(camera, view->samples, 0, camera->height), *render, *view,
                              1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z |
                                  (planes & (CONIC_SURFACES_PLANES | 1u << CONIC_PLANE_NORMAL)) |
                                  (planes & ids ? 1u << CONIC_PLANE_ID : 0)};
  look.render.has_background = 0;
  look.view.samples = 1;
  if (((const gaussians_source *)source)->choose) {
    look.view.error_px = source->choice.error_px;
    look.view.budget = 0;
  }
  return look;
}

/* The statistics of a picture, or of a window, of both; of further windows, what all have is known. */
static void add_surfaces(const conic_render_statistics *of_surfaces, int is_further,
                         conic_render_statistics *statistics) {
  const uint64_t n_covered = statistics->pixels_covered;
  if (is_further)
    statistics->splats_in = statistics->splats_drawn = statistics->splats_culled = statistics->splats_skipped = 0;
  conic_statistics_add(of_surfaces, statistics);
  statistics->pixels_covered = n_covered;
}

/* --- windows --- */

typedef struct own_windows {
  conic_gaussian_picture *picture;
  conic_source_windows surfaces; /* of the fine picture; zero where there are none, or somebody else draws them */
} own_windows;

/* A window of the fine picture. */
static conic_window fine_window_of(const conic_source_windows *w, const conic_window *window) {
  const int n = w->samples;
  return (conic_window){n * window->x_begin, n * window->x_end, n * window->y_begin, n * window->y_end};
}

static conic_status begin_gaussian_windows(conic_source_windows *w) {
  gaussians_source *g = (gaussians_source *)w->source;
  conic_context *context = w->source->context;
  const conic_camera fine = conic_samples_camera(&w->camera, w->samples, 0, w->camera.height);
  own_windows *own = w->own = conic_memory_allocate_zeroed(context, 1, sizeof *own);
  if (!own)
    return CONIC_ERROR_MEMORY;
  if ((long)w->camera.width * w->samples > 65535 || (long)w->camera.height * w->samples > 65535)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: so many samples make more than 65535 a side",
                      w->source->name);
  conic_status status = g->choose && !g->surfaces ? g->choose(w->source, &w->camera) : CONIC_OK;
  w->step = CONIC_GAUSSIAN_TILE;
  w->band_rows = w->camera.height;
  g->options.isa = w->render.isa;
  g->options.device = w->renderer ? conic_opencl_gaussian_device(w->renderer) : NULL;
  for (int c = 0; c < 3; c++)
    g->options.background[c] = w->render.has_background && !g->surfaces ? w->render.background[c] : 0.0f;
  if (status == CONIC_OK)
    status = conic_gaussian_picture_begin(context, &g->gaussians, &fine, &g->options,
                                          w->planes >> CONIC_PLANE_NORMAL & 1, &own->picture);
  return status;
}

static conic_status begin_windows_of_both(conic_source_windows *w) {
  const gaussians_source *g = (const gaussians_source *)w->source;
  conic_source *surfaces = g->surfaces;
  conic_status status = surfaces && g->choose ? g->choose(w->source, &w->camera) : CONIC_OK;
  if (status == CONIC_OK)
    status = begin_gaussian_windows(w);
  if (!surfaces || status != CONIC_OK)
    return status;
  const conic_surfaces_look look =
      conic_surfaces_look_of(w->source, &w->camera, &w->render, &w->source->view, w->planes);
  conic_source_windows *own = &((own_windows *)w->own)->surfaces;
  status = conic_source_windows_begin(surfaces, w->renderer, &look.camera, &look.render, &look.view, look.planes, own);
  w->step = own->step > w->step ? own->step : w->step; /* both are powers of two */
  w->is_summed = own->is_summed;
  return status;
}

static void end_gaussian_windows(conic_source_windows *w) {
  own_windows *own = w->own;
  if (!own)
    return;
  conic_gaussian_picture_release(own->picture);
  conic_source_windows_end(&own->surfaces);
  conic_memory_release(w->source->context, own);
}

/* Surfaces of the fine picture's size are null where there are none. */
static conic_status composite_window(conic_source_windows *w, const conic_window *window, conic_image *surfaces,
                                     conic_image *image, conic_render_statistics *statistics) {
  gaussians_source *g = (gaussians_source *)w->source;
  conic_context *context = w->source->context;
  conic_gaussian_picture *picture = ((const own_windows *)w->own)->picture;
  const int n = w->samples;
  const conic_window there = fine_window_of(w, window);
  const conic_gaussian_window fine_window = {{there.x_begin, there.y_begin}, {there.x_end, there.y_end}};
  fine_picture fine = {.samples = n, .is_opaque = w->render.has_background, .surfaces = surfaces};
  const uint64_t n_before = conic_gaussian_picture_statistics(picture)->pairs;
  fine.planes.width = n * image->width;
  fine.planes.height = n * image->height;
  fine.planes.surface_z = surfaces ? surfaces->planes[CONIC_PLANE_Z] : NULL;
  conic_status status = allocate_planes(context, image, &fine);
  if (status == CONIC_OK)
    status = conic_gaussian_picture_draw(picture, &fine_window, &fine.planes);
  if (status == CONIC_OK && surfaces)
    conic_surfaces_join(context, surfaces, fine.is_opaque ? w->render.background : NULL, g->gaussians.is_linear,
                        (uint32_t)g->gaussians.count, &fine.planes);
  if (status == CONIC_OK) {
    reduce_others(context, &fine, image);
    uint64_t n_covered = reduce_samples(context, &fine, image);
    image->is_display = !g->gaussians.is_linear;
    g->drawn = *conic_gaussian_picture_statistics(picture);
    tell_drawing(g, g->drawn.pairs - n_before, n_covered, statistics);
  }
  release_planes(context, &fine);
  return status;
}

static conic_status draw_gaussian_window(conic_source_windows *w, const conic_window *window, conic_image *image,
                                         conic_render_statistics *statistics) {
  own_windows *own = w->own;
  conic_render_statistics of_surfaces;
  conic_image surfaces;
  if (!own->surfaces.source)
    return composite_window(w, window, NULL, image, statistics);
  const conic_window there = fine_window_of(w, window);
  own->surfaces.other_bytes = w->other_bytes;
  conic_status status = conic_image_allocate(w->source->context, there.x_end - there.x_begin,
                                             there.y_end - there.y_begin, own->surfaces.planes, &surfaces);
  if (status == CONIC_OK)
    status = conic_source_windows_draw(&own->surfaces, &there, &surfaces, &of_surfaces);
  if (status == CONIC_OK)
    status = composite_window(w, window, &surfaces, image, statistics);
  if (status == CONIC_OK)
    add_surfaces(&of_surfaces, w->is_summed && (window->x_begin || window->y_begin), statistics);
  memcpy(w->tallies, own->surfaces.tallies, sizeof w->tallies);
  conic_image_release(w->source->context, &surfaces);
  return status;
}

static conic_status count_gaussian_windows(const conic_source_windows *w, conic_render_statistics *statistics) {
  own_windows *own = w->own;
  const uint64_t n_covered = statistics->pixels_covered;
  if (!own->surfaces.source)
    return CONIC_OK;
  memcpy(own->surfaces.tallies, w->tallies, sizeof w->tallies);
  conic_status status = conic_source_windows_count(&own->surfaces, statistics);
  statistics->pixels_covered = n_covered;
  return status;
}

static void weigh_gaussian_windows(const conic_source_windows *w, const conic_window *list, size_t n, double *weights) {
  const conic_gaussians *set = &((const gaussians_source *)w->source)->gaussians;
  const conic_source_windows *surfaces = &((const own_windows *)w->own)->surfaces;
  conic_source_windows_weigh_places(w, set->position, set->count, set->origin, list, n, weights);
  if (surfaces->source && w->samples == 1) /* else windows are others there */
    surfaces->source->kind->windowing->weigh(surfaces, list, n, weights);
}

const conic_source_windowing conic_gaussians_windowing = {.begin = begin_windows_of_both,
                                                          .end = end_gaussian_windows,
                                                          .draw = draw_gaussian_window,
                                                          .count = count_gaussian_windows,
                                                          .weigh = weigh_gaussian_windows};

/* --- whole pictures --- */

static conic_status composite_whole(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                    const conic_render_options *render, int samples, conic_image *surfaces,
                                    conic_image *image, conic_render_statistics *statistics) {
  conic_source_windows w = {.source = source,
                            .renderer = renderer,
                            .camera = *camera,
                            .render = *render,
                            .planes = conic_image_planes(image),
                            .samples = samples};
  const conic_window whole = {0, camera->width, 0, camera->height};
  conic_status status = begin_gaussian_windows(&w);
  if (status == CONIC_OK)
    status = composite_window(&w, &whole, surfaces, image, statistics);
  end_gaussian_windows(&w);
  return status;
}

conic_status conic_source_draw_among(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                     const conic_render_options *render, const conic_source_view *view,
                                     const conic_surfaces_drawer *drawer, conic_image *image,
                                     conic_render_statistics *statistics) {
  gaussians_source *g = (gaussians_source *)source;
  conic_render_statistics of_surfaces;
  conic_image surfaces;
  memset(&of_surfaces, 0, sizeof of_surfaces);
  memset(&surfaces, 0, sizeof surfaces);
  source->view = *view;
  conic_status status = g->choose ? g->choose(source, camera) : CONIC_OK;
  const conic_surfaces_look look = conic_surfaces_look_of(source, camera, render, view, conic_image_planes(image));
  if (status == CONIC_OK)
    status = conic_image_allocate(source->context, look.camera.width, look.camera.height, look.planes | drawer->planes,
                                  &surfaces);
  if (status == CONIC_OK)
    status = drawer->draw(drawer->cookie, &look.camera, &look.render, &look.view, &surfaces, &of_surfaces);
  if (status == CONIC_OK)
    status = composite_whole(source, renderer, camera, render, view->samples, &surfaces, image, statistics);
  if (status == CONIC_OK)
    add_surfaces(&of_surfaces, 0, statistics);
  conic_image_release(source->context, &surfaces);
  return status;
}

conic_status conic_source_draw_surfaces(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                        const conic_render_options *render, const conic_source_view *view,
                                        unsigned planes, conic_image *surfaces) {
  const conic_surfaces_look look = conic_surfaces_look_of(source, camera, render, view, planes);
  conic_status status =
      conic_image_allocate(source->context, look.camera.width, look.camera.height, look.planes, surfaces);
  return status == CONIC_OK ? conic_source_draw(conic_source_surfaces(source), renderer, &look.camera, &look.render,
                                                &look.view, surfaces, NULL)
                            : status;
}

typedef struct plain_drawing {
  conic_source *surfaces;
  conic_renderer *renderer;
} plain_drawing;

static conic_status draw_plain(void *cookie, const conic_camera *camera, const conic_render_options *render,
                               const conic_source_view *view, conic_image *surfaces,
                               conic_render_statistics *statistics) {
  const plain_drawing *p = cookie;
  return conic_source_draw(p->surfaces, p->renderer, camera, render, view, surfaces, statistics);
}

conic_status conic_gaussians_source_draw(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                         const conic_render_options *render, const conic_source_view *view,
                                         conic_image *image, conic_render_statistics *statistics) {
  conic_render_statistics unused;
  plain_drawing plain = {((const gaussians_source *)source)->surfaces, renderer};
  const conic_surfaces_drawer drawer = {.draw = draw_plain, .cookie = &plain};
  statistics = statistics ? statistics : &unused;
  return plain.surfaces ? conic_source_draw_among(source, renderer, camera, render, view, &drawer, image, statistics)
                        : composite_whole(source, renderer, camera, render, view->samples, NULL, image, statistics);
}

conic_levels_wish conic_gaussians_source_wish(const conic_gaussians_source *source) {
  const conic_source_view *view = &source->base.view;
  const conic_profile_row *row = conic_profile_row_of(source->options.profile);
  const double samples = (double)view->samples;
  return (conic_levels_wish){.error = view->error_px,
                             .budget = view->budget,
                             .dilation = row->compensation_least < 0.0 ? row->dilation / (samples * samples) : 0.0};
}

void conic_levels_tell(const conic_among_input *inputs, size_t n, conic_facts *facts) {
  uint64_t n_clouds = 0, n_read = 0, n_received = 0, n_drawn = 0, n_merged = 0;
  for (size_t i = 0; i < n; i++) {
    const conic_levels *levels = inputs[i].levels;
    if (!levels)
      continue;
    n_drawn += inputs[i].cut.n;
    n_merged += inputs[i].cut.n_merged;
    n_clouds += levels->shape.n_clouds;
    n_read += levels->n_read;
    n_received += conic_ranges_received(levels->ranges);
  }
  if (n_clouds)
    CONIC_ADD_FACTS(facts, CONIC_OBJECT("gaussian_levels"), CONIC_COUNT("gaussians", n_drawn),
                    CONIC_COUNT("gaussians_merged", n_merged), CONIC_COUNT("clouds", n_clouds),
                    CONIC_COUNT("clouds_read", n_read), CONIC_COUNT("bytes_received", n_received), CONIC_END);
}

void conic_gaussians_source_tell(const conic_source *source, conic_facts *facts) {
  const gaussians_source *g = (const gaussians_source *)source;
  CONIC_ADD_FACTS(facts,
                  conic_fact_text(CONIC_FACT_TEXT, "profile", "%s", conic_gaussian_profile_name(g->options.profile)),
                  CONIC_COUNT("entries", g->drawn.entries));
  conic_levels_tell(g->inputs, g->n_inputs, facts);
}
