/* A drawing with its opacities: the picture as it is drawn without, a mask of the pixels whose front surface lets light
 * through, and these again, surface by surface. */
#include "conic/transparency.h"

#include <string.h>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/image/image_common.h"
#include "core/image/view_arguments.h"
#include "raster/frame/drawing.h"
#include "raster/frame/samples.h"
#include "raster/frame/statistics.h"
#include "raster/tiles/lights.h"
#include "raster/transparency/sheet_lines.h"
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
  t->splat_marks = conic_memory_allocate(t->context, splats->count, sizeof *t->splat_marks);
  t->materials = conic_memory_allocate_zeroed(t->context, triangles ? triangles->n_materials : 0, sizeof *t->materials);
  if (!t->splat_marks || !t->materials)
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

/* The same picture of the marks for colours: not black where a part of the front surface has one. */
static conic_status draw_transparent_mask(transparent *t, const conic_camera *camera, conic_image *mask) {
  conic_splats splats = *t->drawing->splats;
  conic_triangles triangles;
  conic_drawing marked = {.splats = &splats};
  conic_render_options options = *t->options;
  options.shading = CONIC_SHADE_NONE;
  options.splats_version = 0;
  for (int channel = 0; channel < 3; channel++)
    splats.color[channel] = t->splat_marks;
  if (t->drawing->triangles) {
    triangles = *t->drawing->triangles;
    marked.triangles = &triangles;
    memset(triangles.color, 0, sizeof triangles.color);
    if (!triangles.n_materials) {
      triangles.n_materials = 1;
      triangles.material = NULL;
    }
    triangles.materials = t->drawing->triangles->n_materials ? t->materials : &t->no_material;
  }
  return conic_render_drawing(t->context, t->renderer, &marked, camera, &options, 1, mask, NULL);
}

static int is_mask_empty(const conic_image *mask) {
  const float *mark = mask->planes[CONIC_PLANE_ALBEDO];
  size_t n = conic_image_pixels(mask), i = 0;
  while (i < n && !(mark[3 * i] > 0.0f))
    i++;
  return i == n;
}

/* --- a picture of one sample a pixel --- */

static conic_status draw_sheets(transparent *t, const conic_camera *camera, const float *mark, conic_image *image) {
  conic_splats splats = *t->drawing->splats; /* whose weights are without opacity */
  const conic_drawing bare = {.splats = &splats, .triangles = t->drawing->triangles};
  conic_contributions *contributions;
  conic_finish_lights lights;
  conic_finish finish;
  splats.opacity = NULL;
  conic_status status = conic_finish_init(t->context, camera, t->options, &lights, &finish);
  if (status == CONIC_OK)
    status = conic_contributions_create_drawing(t->context, &bare, camera, t->options, &contributions);
  if (status != CONIC_OK)
    return status;
  const conic_sheet_picture picture = {
      {contributions, &finish, t->drawing->splats->opacity}, mark, t->how, t->chance, image};
  status = conic_sheet_lines_draw(&picture);
  conic_contributions_destroy(contributions);
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
    status = draw_sheets(t, camera, mask.planes[CONIC_PLANE_ALBEDO], image);
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
  return status;
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
  conic_memory_release(context, t.splat_marks);
  conic_memory_release(context, t.materials);
  conic_drawing_leave(context, &whole.entered);
  return status;
}
