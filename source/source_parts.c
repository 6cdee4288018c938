#include "source/source_parts.h"

#include "core/base/message.h"
#include "raster/frame/samples.h"
#include "source/source_kind.h"

int conic_source_has_windows(const conic_source *source, const conic_renderer *renderer) {
  if (source->kind->windowing)
    return conic_renderer_has_parts(renderer);
  return !source->kind->draw && !(source->scale.abilities & (CONIC_SOURCE_COMPOSITES | CONIC_SOURCE_CLUSTERS)) &&
         source->scale.n_triangles == 0 && source->scale.n_splats > 0 && conic_renderer_has_parts(renderer);
}

conic_status conic_source_windows_begin(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                        const conic_render_options *render, const conic_source_view *view,
                                        conic_source_windows *windows) {
  if (!conic_source_has_windows(source, renderer))
    return conic_fail(source->context, CONIC_ERROR_UNSUPPORTED, "%s: it is not drawn in windows", source->name);
  *windows = (conic_source_windows){
      .source = source, .renderer = renderer, .camera = *camera, .step = CONIC_WINDOW_STEP, .samples = 1};
  if (source->kind->windowing) {
    conic_status begun = conic_source_begin_picture(source, render, view, &windows->render);
    windows->samples = source->view.samples;
    return begun == CONIC_OK ? source->kind->windowing->begin(windows) : begun;
  }
  conic_status status = conic_source_choose(source, camera, render, view);
  if (status != CONIC_OK)
    return status;
  windows->render = *render;
  conic_source_settle(source, &windows->render);
  windows->samples = source->view.samples;
  windows->band_rows = conic_samples_band_rows(camera, windows->samples);
  return CONIC_OK;
}

void conic_source_windows_end(conic_source_windows *windows) {
  if (windows->own)
    windows->source->kind->windowing->end(windows);
  windows->own = NULL;
}

static conic_status draw_fine(const conic_source_windows *w, const conic_window *window, conic_image *image,
                              conic_render_statistics *statistics) {
  conic_context *context = w->source->context;
  int n = w->samples, band = window->y_begin / w->band_rows * w->band_rows,
      rows = w->camera.height - band < w->band_rows ? w->camera.height - band : w->band_rows;
  conic_part part = {
      .window = {n * window->x_begin, n * window->x_end, n * (window->y_begin - band), n * (window->y_end - band)}};
  part.first_column = part.window.x_begin;
  part.first_row = part.window.y_begin;
  conic_camera camera = conic_samples_camera(&w->camera, n, band, rows);
  conic_image fine;
  conic_status status = conic_samples_allocate(context, n * image->width, n * image->height,
                                               conic_image_planes(image) & CONIC_DRAWN_PLANES, &fine);
  if (status != CONIC_OK)
    return status;
  status =
      conic_render_part(w->renderer, w->source->choice.drawing.splats, &camera, &w->render, &part, &fine, statistics);
  if (status == CONIC_OK)
    conic_samples_reduce(context, &fine, n, 0, 0, image);
  conic_image_release(context, &fine);
  return status;
}

conic_status conic_source_windows_draw(conic_source_windows *w, const conic_window *window, conic_image *image,
                                       conic_render_statistics *statistics) {
  if (w->source->kind->windowing)
    return w->source->kind->windowing->draw(w, window, image, statistics);
  const conic_part part = {.window = *window, .first_column = window->x_begin, .first_row = window->y_begin};
  conic_status status = w->samples > 1 ? draw_fine(w, window, image, statistics)
                                       : conic_render_part(w->renderer, w->source->choice.drawing.splats, &w->camera,
                                                           &w->render, &part, image, statistics);
  if (status == CONIC_OK)
    conic_source_name_image(w->source, image);
  return status;
}

conic_status conic_source_windows_count(const conic_source_windows *w, conic_render_statistics *statistics) {
  const conic_source_windowing *windowing = w->source->kind->windowing;
  if (windowing)
    return windowing->count ? windowing->count(w, statistics) : CONIC_OK;
  if (w->samples == 1 || w->band_rows >= w->camera.height)
    return CONIC_OK; /* each window sees all splats */
  conic_camera whole = conic_samples_camera(&w->camera, w->samples, 0, w->camera.height);
  return conic_samples_count(w->source->context, w->source->choice.drawing.splats, NULL, &whole, &w->render,
                             statistics);
}

/* Where a splat's centre lies, as a pinhole would see it; 0 where it is not in front. */
static int find_splat_pixel(const conic_source_windows *w, const conic_splats *splats, size_t i, double pixel[2]) {
  double at[3];
  for (int row = 0; row < 3; row++) {
    const double *matrix = w->camera.cam_from_world[row];
    at[row] = matrix[3];
    for (int axis = 0; axis < 3; axis++)
      at[row] += matrix[axis] * (splats->origin[axis] + (double)splats->position[axis][i]);
  }
  if (!(at[2] > w->render.near_z))
    return 0;
  pixel[0] = w->camera.fx * at[0] / at[2] + w->camera.cx;
  pixel[1] = w->camera.fy * at[1] / at[2] + w->camera.cy;
  return 1;
}

void conic_source_windows_weigh(const conic_source_windows *w, const conic_window *list, size_t n, double *weights) {
  enum { MOST_LOOKED_AT = 1 << 16 };
  static const double splats_a_pixel = 0.25; /* so much work is a pixel that nothing covers */
  for (size_t k = 0; k < n; k++)
    weights[k] = splats_a_pixel * (double)(list[k].x_end - list[k].x_begin) * (double)(list[k].y_end - list[k].y_begin);
  if (w->source->kind->windowing) {
    w->source->kind->windowing->weigh(w, list, n, weights);
    return;
  }
  const conic_splats *splats = w->source->choice.drawing.splats;
  size_t step = splats->count / MOST_LOOKED_AT + 1;
  for (size_t i = 0; i < splats->count; i += step) {
    double pixel[2];
    if (!find_splat_pixel(w, splats, i, pixel))
      continue;
    for (size_t k = 0; k < n; k++)
      if (pixel[0] >= (double)list[k].x_begin && pixel[0] < (double)list[k].x_end &&
          pixel[1] >= (double)list[k].y_begin && pixel[1] < (double)list[k].y_end)
        weights[k] += (double)step;
  }
}
