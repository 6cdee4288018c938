/* A drawing with its opacities: the picture as it is drawn without, a mask of the pixels whose front surface lets light
 * through, and these again, surface by surface. */

#include "core/image/image_common.h"
#include "core/image/view_arguments.h"
#include "raster/frame/samples.h"
#include "raster/frame/statistics.h"
#include "raster/tiles/lights.h"
#include "raster/transparency/pixel_sheets.h"
#include "raster/transparency/transparent_windows.h"
#include "raster/transparency/triangle_alpha.h"

typedef struct transparent {
  conic_context *context;
  conic_renderer *renderer;
  const conic_whole_drawing *drawing;
  const conic_render_options *options;
  conic_transparency how;
  double chance;
  float *splat_marks;         /* of each splat, whether it lets light through; null: none does */
  conic_material *materials;  /* those of the mask */
  conic_material no_material; /* where there are none */
} transparent;

static int splats_are_transparent(const conic_splats *splats) {
  size_t stride = splats->strides.opacity ? splats->strides.opacity / sizeof *splats->opacity : 1;
  for (size_t i = 0; splats->opacity && i < splats->count; i++)
    if (splats->opacity[i * stride] != 1.0f)
      return 1;
  return 0;
}

static int triangles_are_transparent(const conic_triangles *triangles) {
  for (size_t i = 0; triangles->materials && i < triangles->n_materials; i++)
    if (conic_material_is_transparent(triangles, &triangles->materials[i]))
      return 1;
  return !triangles->n_materials && conic_material_is_transparent(triangles, NULL);
}

int conic_drawing_is_transparent(const conic_drawing *drawing) {
  return (drawing->splats && splats_are_transparent(drawing->splats)) ||
         (drawing->triangles && triangles_are_transparent(drawing->triangles));
}

/* --- the mask --- */

static conic_status make_transparent_marks(transparent *t) {
  const conic_splats *splats = t->drawing->splats;
  const conic_triangles *triangles = t->drawing->triangles;
  if (conic_memory_allocate_these(t->context, CONIC_ROOM(t->splat_marks, splats->count),
                                  CONIC_ZEROED(t->materials, triangles ? triangles->n_materials : 0)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < splats->count; i++)
    t->splat_marks[i] = splats->opacity && splats->opacity[i] != 1.0f ? 1.0f : 0.0f;
  for (size_t i = 0; triangles && i < triangles->n_materials; i++)
    for (int channel = 0; channel < 3; channel++)
      t->materials[i].color[channel] = conic_material_is_transparent(triangles, &triangles->materials[i]) ? 1.0f : 0.0f;
  for (int channel = 0; triangles && channel < 3; channel++)
    t->no_material.color[channel] = conic_material_is_transparent(triangles, NULL) ? 1.0f : 0.0f;
  return CONIC_OK;
}

/* The drawing with its marks for colours. */
typedef struct marked_drawing {
  conic_splats splats;
  conic_triangles triangles;
  conic_drawing drawing;
  conic_render_options options;
} marked_drawing;

static void mark_drawing(transparent *t, marked_drawing *marked) {
  conic_triangles *triangles = &marked->triangles;
  marked->splats = *t->drawing->splats;
  marked->drawing = (conic_drawing){.splats = &marked->splats};
  marked->options = *t->options;
  marked->options.shading = CONIC_SHADE_NONE;
  marked->options.splats_version = 0;
  for (int channel = 0; channel < 3; channel++)
    marked->splats.color[channel] = t->splat_marks;
  if (!t->drawing->triangles)
    return;
  *triangles = *t->drawing->triangles;
  marked->drawing.triangles = triangles;
  memset(triangles->color, 0, sizeof triangles->color);
  if (!triangles->n_materials) {
    triangles->n_materials = 1;
    triangles->material = NULL;
  }
  triangles->materials = t->drawing->triangles->n_materials ? t->materials : &t->no_material;
}

/* The same picture of the marks: not black where a part of the front surface has one. */
static conic_status draw_transparent_mask(transparent *t, const conic_camera *camera, conic_image *mask) {
  marked_drawing marked;
  mark_drawing(t, &marked);
  return conic_render_drawing(t->context, t->renderer, &marked.drawing, camera, &marked.options, 1, mask, NULL);
}

static int is_mask_empty(const conic_image *mask) {
  const float *mark = mask->planes[CONIC_PLANE_ALBEDO];
  size_t n = conic_image_pixels(mask), i = 0;
  while (i < n && !(mark[3 * i] > 0.0f))
    i++;
  return i == n;
}

/* --- a picture of one sample a pixel --- */

/* What draws the pixels that let light through. */
typedef struct sheet_drawer {
  conic_splats splats; /* whose weights are without opacity */
  conic_contributions *contributions;
  conic_finish_lights lights;
  conic_finish finish;
} sheet_drawer;

static conic_status begin_sheets(transparent *t, const conic_camera *camera, sheet_drawer *drawer) {
  const conic_drawing bare = {.splats = &drawer->splats, .triangles = t->drawing->triangles};
  drawer->splats = *t->drawing->splats;
  drawer->splats.opacity = NULL;
  conic_status status = conic_finish_init(t->context, camera, t->options, &drawer->lights, &drawer->finish);
  return status == CONIC_OK
             ? conic_contributions_create_drawing(t->context, &bare, camera, t->options, &drawer->contributions)
             : status;
}

/* `first` is the picture's pixel where mask and image begin. */
static conic_status draw_sheets(const transparent *t, const sheet_drawer *drawer, const int first[2],
                                const conic_image *mask, conic_image *image) {
  const conic_sheet_picture picture = {{drawer->contributions, &drawer->finish, t->drawing->splats->opacity},
                                       mask->planes[CONIC_PLANE_ALBEDO],
                                       t->how,
                                       t->chance,
                                       image,
                                       first[0],
                                       first[1]};
  return conic_sheet_lines_draw(&picture);
}

static conic_status draw_all_sheets(transparent *t, const conic_camera *camera, const conic_image *mask,
                                    conic_image *image) {
  static const int first[2];
  sheet_drawer drawer;
  conic_status status = begin_sheets(t, camera, &drawer);
  if (status != CONIC_OK)
    return status;
  status = draw_sheets(t, &drawer, first, mask, image);
  conic_contributions_destroy(drawer.contributions);
  return status;
}

static conic_status draw_transparent(transparent *t, const conic_camera *camera, conic_image *image,
                                     conic_render_statistics *statistics) {
  conic_image mask;
  conic_status status = conic_render_whole(t->renderer, t->drawing, camera, t->options, image, statistics);
  if (status == CONIC_OK)
    status = conic_samples_allocate(t->context, camera->width, camera->height, 1u << CONIC_PLANE_ALBEDO, &mask);
  if (status != CONIC_OK)
    return status;
  status = draw_transparent_mask(t, camera, &mask);
  if (status == CONIC_OK && !is_mask_empty(&mask))
    status = draw_all_sheets(t, camera, &mask, image);
  conic_image_release(t->context, &mask);
  return status;
}

/* --- several samples a pixel --- */

static conic_status draw_transparent_bands(transparent *t, const conic_camera *camera, int samples, conic_image *image,
                                           conic_render_statistics *sum) {
  conic_image fine;
  int rows = conic_samples_band_rows(camera, samples);
  conic_status status = conic_samples_allocate(t->context, samples * camera->width, samples * rows,
                                               conic_image_planes(image) & CONIC_DRAWN_PLANES, &fine);
  if (status != CONIC_OK)
    return status;
  for (int y = 0; y < camera->height && status == CONIC_OK; y += rows) {
    conic_render_statistics band;
    int n_rows = camera->height - y < rows ? camera->height - y : rows;
    conic_camera own = conic_samples_camera(camera, samples, y, n_rows);
    fine.height = own.height;
    status = draw_transparent(t, &own, &fine, &band);
    if (status == CONIC_OK)
      conic_samples_reduce(t->context, &fine, samples, 0, y, image);
    if (status == CONIC_OK && y == 0)
      *sum = band;
    else if (status == CONIC_OK)
      conic_statistics_add_pixels(&band, sum);
  }
  conic_image_release(t->context, &fine);
  if (status != CONIC_OK || rows >= camera->height)
    return status;
  const conic_drawing all = {t->drawing->splats, t->drawing->triangles};
  conic_camera whole = conic_samples_camera(camera, samples, 0, camera->height);
  return conic_samples_count_drawing(t->context, &all, &whole, t->options, sum); /* no band sees all */
}

static conic_status check_transparent(conic_context *context, const conic_render_options *options,
                                      conic_transparency how, double chance) {
  if ((unsigned)how >= CONIC_N_TRANSPARENCIES || !(chance >= 0.0 && chance < 1.0))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "render: an unknown transparency, or a chance not within 0 and 1");
  if (how != CONIC_TRANSPARENCY_NONE && options->passes != 3)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "render: transparency is of surfaces that blend: of 3 passes");
  return CONIC_OK;
}

conic_status conic_render_transparent(conic_context *context, conic_renderer *renderer, const conic_drawing *drawing,
                                      const conic_camera *camera, const conic_render_options *given,
                                      conic_transparency transparency, double chance, int samples, conic_image *image,
                                      conic_render_statistics *statistics) {
  conic_render_options options;
  conic_render_statistics own;
  conic_whole_drawing whole;
  struct transparent t = {.context = context,
                          .renderer = renderer,
                          .drawing = &whole,
                          .options = &options,
                          .how = transparency,
                          .chance = chance};
  double start = conic_seconds_now();
  conic_status status = conic_view_arguments_take(context, "render", camera, given, &options);
  if (status == CONIC_OK)
    status = check_transparent(context, &options, transparency, chance);
  if (status != CONIC_OK)
    return status;
  /* All else that can be wrong is found there. */
  if (!drawing || !image || transparency == CONIC_TRANSPARENCY_NONE || !conic_drawing_is_transparent(drawing) ||
      samples < 1 || samples > CONIC_MAX_SAMPLES || image->width != camera->width || image->height != camera->height)
    return conic_render_drawing(context, renderer, drawing, camera, given, samples, image, statistics);
  status = conic_whole_drawing_enter(context, "render", drawing, &whole);
  if (status == CONIC_OK)
    status = conic_whole_drawing_scale(context, &whole, &options);
  if (status == CONIC_OK)
    status = make_transparent_marks(&t);
  if (status == CONIC_OK)
    status = samples == 1 ? draw_transparent(&t, camera, image, &own)
                          : draw_transparent_bands(&t, camera, samples, image, &own);
  own.ms.frame = 1e3 * (conic_seconds_now() - start);
  if (status == CONIC_OK && statistics)
    *statistics = own;
  conic_memory_release_these(context, t.splat_marks, t.materials);
  conic_drawing_leave(context, &whole.entered);
  return status;
}

/* --- window by window --- */

struct conic_transparent_windows {
  transparent t;
  conic_render_options options;
  conic_whole_drawing whole;
  conic_camera camera;
  marked_drawing marked;
  conic_renderer *mask_renderer;
  conic_prepared *picture, *mask;
  sheet_drawer sheets; /* begun where a window needs them */
};

static conic_status begin_transparent_windows(conic_transparent_windows *w, const conic_drawing *drawing,
                                              unsigned planes) {
  transparent *t = &w->t;
  conic_status status = conic_whole_drawing_enter(t->context, "render", drawing, &w->whole);
  if (status == CONIC_OK)
    status = conic_whole_drawing_scale(t->context, &w->whole, &w->options);
  if (status == CONIC_OK)
    status = conic_prepare(t->renderer, drawing, &w->camera, &w->options, planes, &w->picture);
  if (status != CONIC_OK || !conic_drawing_is_transparent(drawing))
    return status;
  status = make_transparent_marks(t);
  if (status == CONIC_OK)
    status = conic_renderer_create(t->context, &w->mask_renderer);
  if (status != CONIC_OK)
    return status;
  mark_drawing(t, &w->marked);
  return conic_prepare(w->mask_renderer, &w->marked.drawing, &w->camera, &w->marked.options, 1u << CONIC_PLANE_ALBEDO,
                       &w->mask);
}

conic_status conic_transparent_windows_begin(conic_context *context, conic_renderer *renderer,
                                             const conic_drawing *drawing, const conic_camera *camera,
                                             const conic_render_options *given, conic_transparency how, double chance,
                                             unsigned planes, conic_transparent_windows **windows) {
  *windows = NULL;
  conic_status status = check_transparent(context, given, how, chance);
  if (status != CONIC_OK)
    return status;
  conic_transparent_windows *w = conic_memory_allocate_zeroed(context, 1, sizeof *w);
  if (!w)
    return CONIC_ERROR_MEMORY;
  w->options = *given;
  w->camera = *camera;
  w->t = (transparent){.context = context,
                       .renderer = renderer,
                       .drawing = &w->whole,
                       .options = &w->options,
                       .how = how,
                       .chance = chance};
  status = begin_transparent_windows(w, drawing, planes);
  if (status == CONIC_OK)
    *windows = w;
  else
    conic_transparent_windows_end(w);
  return status;
}

static conic_status draw_window_sheets(conic_transparent_windows *w, const conic_window *window,
                                       const conic_image *mask, conic_image *image) {
  const int first[2] = {window->x_begin, window->y_begin};
  conic_status status = CONIC_OK;
  if (is_mask_empty(mask))
    return CONIC_OK;
  if (!w->sheets.contributions)
    status = begin_sheets(&w->t, &w->camera, &w->sheets);
  return status == CONIC_OK ? draw_sheets(&w->t, &w->sheets, first, mask, image) : status;
}

conic_status conic_transparent_windows_draw(conic_transparent_windows *w, const conic_window *window,
                                            conic_image *image, conic_render_statistics *statistics) {
  conic_image mask;
  conic_render_statistics unused;
  conic_status status = conic_prepared_draw(w->picture, window, image, statistics);
  if (status != CONIC_OK || !w->mask)
    return status;
  status = conic_samples_allocate(w->t.context, image->width, image->height, 1u << CONIC_PLANE_ALBEDO, &mask);
  if (status != CONIC_OK)
    return status;
  status = conic_prepared_draw(w->mask, window, &mask, &unused);
  if (status == CONIC_OK)
    status = draw_window_sheets(w, window, &mask, image);
  conic_image_release(w->t.context, &mask);
  return status;
}

void conic_transparent_windows_end(conic_transparent_windows *w) {
  if (!w)
    return;
  conic_context *context = w->t.context;
  conic_contributions_destroy(w->sheets.contributions);
  conic_prepared_release(w->mask);
  conic_prepared_release(w->picture);
  conic_renderer_destroy(w->mask_renderer);
  conic_memory_release_these(context, w->t.splat_marks, w->t.materials);
  conic_drawing_leave(context, &w->whole.entered);
  conic_memory_release(context, w);
}
