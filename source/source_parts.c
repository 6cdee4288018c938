#include "source/source_parts.h"

#include "source/source_kind.h"
#include "source/surfaces_among.h"

int conic_source_has_windows(const conic_source *source, const conic_renderer *renderer, int is_transparent) {
  const conic_source_windowing *windowing = source->kind->windowing;
  const conic_source *surfaces = conic_source_surfaces(source);
  int is_carried = source->is_moved && !source->kind->move;
  return windowing && (!surfaces || conic_source_has_windows(surfaces, renderer, is_transparent)) &&
         (!is_transparent || windowing->has_transparency) && !is_carried && conic_renderer_has_parts(renderer);
}

conic_status conic_source_windows_begin(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                        const conic_render_options *render, const conic_source_view *view,
                                        unsigned planes, conic_source_windows *windows) {
  memset(windows, 0, sizeof *windows);
  conic_source_picture picture;
  if (!conic_source_has_windows(source, renderer, view && view->transparency))
    return conic_fail(source->context, CONIC_ERROR_UNSUPPORTED, "%s: it is not drawn in windows", source->name);
  windows->source = source;
  windows->renderer = renderer;
  windows->camera = *camera;
  windows->planes = planes;
  conic_status status = conic_source_begin_picture(source, camera, render, view, &picture);
  windows->render = picture.render;
  windows->samples = source->view.samples;
  return status == CONIC_OK ? source->kind->windowing->begin(windows) : status;
}

void conic_source_windows_end(conic_source_windows *windows) {
  if (windows->own)
    windows->source->kind->windowing->end(windows);
  windows->own = NULL;
}

int conic_source_windows_are_dealt(const conic_source_windows *w) {
  return w->source->kind->windowing->deal != NULL;
}

conic_status conic_source_windows_deal(conic_source_windows *w, const conic_window *list, size_t n, int is_in_order,
                                       int *owners) {
  return w->source->kind->windowing->deal(w, list, n, is_in_order, owners);
}

conic_status conic_source_windows_draw(conic_source_windows *w, const conic_window *window, conic_image *image,
                                       conic_render_statistics *statistics) {
  conic_status status = w->source->kind->windowing->draw(w, window, image, statistics);
  if (status == CONIC_OK)
    conic_source_name_image(w->source, image);
  return status;
}

conic_status conic_source_windows_count(const conic_source_windows *w, conic_render_statistics *statistics) {
  const conic_source_windowing *windowing = w->source->kind->windowing;
  return windowing->count ? windowing->count(w, statistics) : CONIC_OK;
}

/* --- weights --- */

/* The pixel of a place, as a pinhole sees it; returns 0 where the place is not in front. */
static int find_place_pixel(const conic_source_windows *w, const double place[3], double pixel[2]) {
  double at[3];
  for (int row = 0; row < 3; row++) {
    const double *matrix = w->camera.cam_from_world[row];
    at[row] = matrix[3];
    for (int axis = 0; axis < 3; axis++)
      at[row] += matrix[axis] * place[axis];
  }
  if (!(at[2] > w->render.near_z))
    return 0;
  pixel[0] = w->camera.fx * at[0] / at[2] + w->camera.cx;
  pixel[1] = w->camera.fy * at[1] / at[2] + w->camera.cy;
  return 1;
}

void conic_source_windows_weigh_places(const conic_source_windows *w, float *const columns[3], size_t count,
                                       const double origin[3], const conic_window *list, size_t n, double *weights) {
  enum { MOST_LOOKED_AT = 1 << 16 };
  size_t step = count / MOST_LOOKED_AT + 1;
  for (size_t i = 0; i < count; i += step) {
    double pixel[2], place[3];
    for (int axis = 0; axis < 3; axis++)
      place[axis] = origin[axis] + (double)columns[axis][i];
    if (!find_place_pixel(w, place, pixel))
      continue;
    for (size_t k = 0; k < n; k++)
      if (pixel[0] >= (double)list[k].x_begin && pixel[0] < (double)list[k].x_end &&
          pixel[1] >= (double)list[k].y_begin && pixel[1] < (double)list[k].y_end)
        weights[k] += (double)step;
  }
}

void conic_source_windows_weigh(const conic_source_windows *w, const conic_window *list, size_t n, double *weights) {
  static const double splats_a_pixel = 0.25; /* a pixel that nothing covers takes as much work as so many splats */
  for (size_t k = 0; k < n; k++)
    weights[k] = splats_a_pixel * (double)(list[k].x_end - list[k].x_begin) * (double)(list[k].y_end - list[k].y_begin);
  w->source->kind->windowing->weigh(w, list, n, weights);
}
