#include "shots/bound_plane.h"

#include "core/image/image_common.h"
#include "source/source_kind.h"
#include "source/surfaces_among.h"

conic_status conic_bound_plane_begin(const conic_shot_stage *first, const conic_look *look, const conic_image *image,
                                     conic_image *whole) {
  const conic_shot_work *work = first->work;
  conic_source_view view = *look->view;
  const conic_look at_all = {look->camera, look->render, &view, look->sample};
  conic_render_statistics statistics;
  memset(whole, 0, sizeof *whole);
  memset(&statistics, 0, sizeof statistics);
  if (!(work->planes >> CONIC_PLANE_BOUND & 1))
    return CONIC_OK;
  view.error_px = 0.0;
  view.budget = 0;
  conic_status status = conic_image_allocate(work->context, image->width, image->height,
                                             work->planes & ~(1u << CONIC_PLANE_BOUND), whole);
  if (status == CONIC_OK)
    status = first->draw(first, &at_all, whole, &statistics);
  if (status == CONIC_OK && conic_source_gaussians(work->source) && conic_source_chosen(work->source)->error_px > 0.0)
    status = conic_fail(work->context, CONIC_ERROR_UNSUPPORTED,
                        "%s: not all of it fits into --memory, so it has no plane bound", work->source->name);
  return status;
}

double conic_bound_plane_find(const conic_image *whole, const conic_image *image) {
  const float *a = whole->planes[CONIC_PLANE_RGBA], *b = image->planes[CONIC_PLANE_RGBA];
  float *to = image->planes[CONIC_PLANE_BOUND], most = 0.0f;
  for (size_t i = 0; i < conic_image_pixels(image); i++) {
    to[i] = 0.0f;
    for (size_t c = 4 * i; c < 4 * i + 4; c++)
      to[i] = fmaxf(to[i], fabsf(a[c] - b[c]));
    most = fmaxf(most, to[i]);
  }
  return (double)most;
}
