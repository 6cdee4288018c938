/* Catchers and holdouts: inputs whose surfaces are in the picture by what they hide alone. */
#include "core/image/image_common.h"
#include "shots/stage.h"
#include "source/surfaces_among.h"

static int has_role(const conic_shot_work *work, uint64_t inputs, uint32_t id) {
  const conic_gaussians *before = work->surfaces == work->source ? NULL : conic_source_gaussians(work->source);
  const size_t input = conic_source_input_of(work->source, id + (before ? (uint32_t)before->count : 0));
  return input < 64 && inputs >> input & 1;
}

/* What is left of a light's luminance. */
static float share_left(const float lit[4], const float unlit[4]) {
  const float after = 0.2126f * lit[0] + 0.7152f * lit[1] + 0.0722f * lit[2],
              before = 0.2126f * unlit[0] + 0.7152f * unlit[1] + 0.0722f * unlit[2];
  return before > 0.0f ? after / before : 1.0f;
}

/* A surface that only darkens what is behind it. Behind a holdout, which is not there, nothing is seen. */
static void take_role(const conic_shot_work *work, const float *unlit, size_t i, uint32_t id, float rgba[4]) {
  const conic_render_options *render = &work->shot->render;
  const int has_background = render->has_background && !work->plan.is_composited;
  const int is_catcher = has_role(work, work->shot->catchers, id), is_held = has_role(work, work->shot->holdouts, id);
  if (!is_catcher && !is_held)
    return;
  const float dark = is_held ? 0.0f : 1.0f - share_left(rgba, unlit + 4 * i);
  for (int c = 0; c < 3; c++)
    rgba[c] = has_background ? render->background[c] * (1.0f - dark) : 0.0f;
  rgba[3] = has_background ? 1.0f : rgba[3] * dark;
}

conic_status conic_stage_roles(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                               conic_render_statistics *statistics) {
  const conic_shot_work *work = stage->work;
  conic_image unlit = {0};
  conic_status status = stage->next->draw(stage->next, look, image, statistics);
  float *rgba = image->planes[CONIC_PLANE_RGBA];
  const uint32_t *ids = image->planes[CONIC_PLANE_ID];
  if (status != CONIC_OK || !rgba)
    return status;
  if (work->shot->catchers) { /* the stage below the lit one draws with all light */
    const conic_shot_stage *below = stage->next->next;
    conic_render_statistics unused;
    status = conic_image_allocate(work->context, image->width, image->height, 1u << CONIC_PLANE_RGBA, &unlit);
    if (status == CONIC_OK)
      status = below->draw(below, look, &unlit, &unused);
  }
  for (size_t i = 0; i < conic_image_pixels(image) && status == CONIC_OK; i++)
    if (ids[i] != CONIC_NO_ID)
      take_role(work, unlit.planes[CONIC_PLANE_RGBA], i, ids[i], rgba + 4 * i);
  conic_image_release(work->context, &unlit);
  return status;
}
