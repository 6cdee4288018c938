#include "shots/focus.h"

#include "core/base/rank.h"
#include "shots/way.h"
#include "source/source_kind.h"

int conic_focus_is_seen(const conic_shot *shot) {
  return shot->aperture.diameter > 0.0 && shot->focus_kind != CONIC_FOCUS_DEPTH;
}

/* The depth at a pixel of the picture; where nothing is there, the median of all there is. */
static conic_status depth_at(conic_context *context, const conic_image *image, const double pixel[2], double *depth) {
  size_t n = (size_t)image->width * (size_t)image->height, n_covered = 0;
  const float *z = image->planes[CONIC_PLANE_Z];
  *depth = (double)z[(size_t)pixel[1] * (size_t)image->width + (size_t)pixel[0]];
  if (*depth > 0.0)
    return CONIC_OK;
  float *covered = conic_memory_allocate(context, n, sizeof *covered);
  if (!covered)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    if (z[i] > 0.0f)
      covered[n_covered++] = z[i];
  *depth = n_covered ? (double)conic_float_of_rank(covered, n_covered, n_covered / 2) : 1.0;
  conic_memory_release(context, covered);
  conic_log(context, CONIC_LOG_WARNING, "focus: nothing is at pixel %g,%g: it is on the median depth, %g", pixel[0],
            pixel[1], *depth);
  return CONIC_OK;
}

conic_status conic_focus_find(conic_context *context, const conic_shot *shot, const conic_image *middle,
                              double *depth) {
  const double center[2] = {0.5 * middle->width, 0.5 * middle->height};
  const double *pixel = shot->focus_kind == CONIC_FOCUS_PIXEL ? shot->focus_pixel : center;
  *depth = shot->aperture.focus;
  if (!conic_focus_is_seen(shot))
    return CONIC_OK;
  if (!(pixel[0] >= 0.0 && pixel[0] < (double)middle->width && pixel[1] >= 0.0 && pixel[1] < (double)middle->height))
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "--focus: pixel %g,%g lies outside of the picture, which has %d x %d", pixel[0], pixel[1],
                      middle->width, middle->height);
  return depth_at(context, middle, pixel, depth);
}

conic_status conic_shot_focus(conic_source *source, conic_renderer *renderer, conic_shot *shot) {
  conic_context *context = source->context;
  conic_camera middle;
  conic_image image;
  memset(&image, 0, sizeof image);
  if (!conic_focus_is_seen(shot))
    return CONIC_OK;
  conic_status status = conic_shot_camera(context, shot, 0.5, &middle);
  if (status == CONIC_OK)
    status = conic_shot_move(shot, source, 0.5);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, middle.width, middle.height, 1u << CONIC_PLANE_Z, &image);
  if (status == CONIC_OK)
    status = conic_source_draw(source, renderer, &middle, &shot->render, &shot->view, &image, NULL);
  if (status == CONIC_OK)
    status = conic_focus_find(context, shot, &image, &shot->aperture.focus);
  if (status == CONIC_OK)
    shot->focus_kind = CONIC_FOCUS_DEPTH;
  conic_shot_rest(shot, source);
  conic_image_release(context, &image);
  return status;
}
