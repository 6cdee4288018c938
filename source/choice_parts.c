/* Windows of sources that choose before they draw: splats and triangles. */

#include "raster/frame/samples.h"
#include "raster/transparency/transparent_windows.h"
#include "source/source_kind.h"

/* The band that is set up. */
typedef struct choice_band {
  int first_row; /* -1: none */
  conic_prepared *prepared;
  conic_transparent_windows *transparent; /* in place of `prepared` */
} choice_band;

static void leave_band(choice_band *band) {
  conic_prepared_release(band->prepared);
  conic_transparent_windows_end(band->transparent);
  *band = (choice_band){.first_row = -1};
}

static conic_status enter_band(const conic_source_windows *w, int first_row, choice_band *band) {
  const conic_source *source = w->source;
  const conic_drawing *drawing = &source->choice.drawing;
  int left = w->camera.height - first_row, rows = left < w->band_rows ? left : w->band_rows;
  unsigned planes = w->planes & CONIC_DRAWN_PLANES;
  conic_camera camera = w->samples == 1 ? w->camera : conic_samples_camera(&w->camera, w->samples, first_row, rows);
  leave_band(band);
  conic_status status =
      source->view.transparency
          ? conic_transparent_windows_begin(source->context, w->renderer, drawing, &camera, &w->render,
                                            source->view.transparency, source->view.chance, planes, &band->transparent)
          : conic_prepare(w->renderer, drawing, &camera, &w->render, planes, &band->prepared);
  if (status == CONIC_OK)
    band->first_row = first_row;
  return status;
}

static conic_status begin_choice_windows(conic_source_windows *w) {
  conic_source *source = w->source;
  conic_status status = conic_source_choose_settled(source, &w->camera, &w->render);
  if (status != CONIC_OK)
    return status;
  if (source->choice.is_all && !w->render.splats_version)
    w->render.splats_version = source->splats_version;
  w->step = w->render.tile;
  w->band_rows = conic_samples_band_rows(&w->camera, w->samples);
  choice_band *band = conic_memory_allocate(source->context, 1, sizeof *band);
  if (!band)
    return CONIC_ERROR_MEMORY;
  *band = (choice_band){.first_row = -1};
  w->own = band;
  /* With several bands, each is set up when it is drawn in. Without all splats here, nothing is set up before they
   * arrive. */
  int is_later = w->band_rows < w->camera.height || conic_source_windows_are_dealt(w);
  return is_later ? CONIC_OK : enter_band(w, 0, band);
}

static void end_choice_windows(conic_source_windows *w) {
  leave_band(w->own);
  conic_memory_release(w->source->context, w->own);
}

/* Draws a window of the band's picture. */
static conic_status draw_in_band(choice_band *band, const conic_window *window, conic_image *image,
                                 conic_render_statistics *statistics) {
  return band->transparent ? conic_transparent_windows_draw(band->transparent, window, image, statistics)
                           : conic_prepared_draw(band->prepared, window, image, statistics);
}

static conic_status draw_fine_window(const conic_source_windows *w, const conic_window *window, conic_image *image,
                                     conic_render_statistics *statistics) {
  conic_context *context = w->source->context;
  choice_band *band = w->own;
  int n = w->samples, top = band->first_row;
  const conic_window fine_window = {n * window->x_begin, n * window->x_end, n * (window->y_begin - top),
                                    n * (window->y_end - top)};
  conic_image fine;
  conic_status status = conic_samples_allocate(context, n * image->width, n * image->height,
                                               conic_image_planes(image) & CONIC_DRAWN_PLANES, &fine);
  if (status != CONIC_OK)
    return status;
  status = draw_in_band(band, &fine_window, &fine, statistics);
  if (status == CONIC_OK)
    conic_samples_reduce(context, &fine, n, 0, 0, image);
  conic_image_release(context, &fine);
  return status;
}

static conic_status draw_choice_window(conic_source_windows *w, const conic_window *window, conic_image *image,
                                       conic_render_statistics *statistics) {
  choice_band *band = w->own;
  int first_row = window->y_begin / w->band_rows * w->band_rows;
  conic_status status = band->first_row == first_row ? CONIC_OK : enter_band(w, first_row, band);
  if (status != CONIC_OK)
    return status;
  return w->samples > 1 ? draw_fine_window(w, window, image, statistics)
                        : draw_in_band(band, window, image, statistics);
}

static conic_status count_choice_windows(const conic_source_windows *w, conic_render_statistics *statistics) {
  if (w->band_rows >= w->camera.height)
    return CONIC_OK; /* each window counts everything */
  conic_camera whole = conic_samples_camera(&w->camera, w->samples, 0, w->camera.height);
  return conic_samples_count_drawing(w->source->context, &w->source->choice.drawing, &whole, &w->render, statistics);
}

static void weigh_choice_windows(const conic_source_windows *w, const conic_window *list, size_t n, double *weights) {
  const conic_drawing *drawing = &w->source->choice.drawing;
  const conic_splats *splats = drawing->splats;
  const conic_triangles *triangles = drawing->triangles;
  if (splats)
    conic_source_windows_weigh_places(w, splats->position, splats->count, splats->origin, list, n, weights);
  if (triangles)
    conic_source_windows_weigh_places(w, triangles->position, triangles->n_vertices, triangles->origin, list, n,
                                      weights);
}

const conic_source_windowing conic_source_windowing_choice = {.has_transparency = 1,
                                                              .begin = begin_choice_windows,
                                                              .end = end_choice_windows,
                                                              .draw = draw_choice_window,
                                                              .count = count_choice_windows,
                                                              .weigh = weigh_choice_windows};
