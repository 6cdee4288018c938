/* Pictures of cameras that are no pinholes, from views by pinholes. */

#include "accumulation/sequence.h"
#include "conic/gather.h"
#include "core/base/color.h"
#include "raster/frame/statistics.h"
#include "raster/tiles/lights.h"
#include "shots/shot_reach.h"

typedef struct view_gathering {
  const conic_shot_stage *stage;
  const conic_look *look;
  conic_lighting lighting; /* whose lights stay where they are for all views */
  conic_render_statistics *sum;
} view_gathering;

static conic_status draw_view(void *cookie, const conic_gather_view *gathered, conic_image *image) {
  const view_gathering *g = cookie;
  conic_render_options render = *g->look->render;
  conic_source_view view = *g->look->view;
  conic_render_statistics one;
  render.near_z = gathered->near_z;
  render.lighting = g->lighting;
  view.samples = gathered->samples;
  const conic_look look = {&gathered->camera, &render, &view, g->look->sample};
  conic_status status = g->stage->next->draw(g->stage->next, &look, image, &one);
  if (status == CONIC_OK)
    conic_statistics_add(&one, g->sum);
  return status;
}

/* A sample has its own place in the views' pixels and on the lens. */
static void place_in_views(const conic_shot_work *work, const conic_sample *sample, conic_gather_options *gather) {
  gather->edge = 512; /* where the views lie changes, and with it by what their rays are off: the mean is not */
  for (int axis = 0; axis < 2; axis++)
    gather->shift[axis] = conic_sequence_at(sample->index, CONIC_SEQUENCE_VIEW + axis);
  if (!(work->shot->aperture.diameter > 0.0))
    return;
  memcpy(gather->lens, sample->lens, sizeof sample->lens);
  gather->lens[2] = sample->lens_forward;
  gather->focus = work->focus_depth;
}

/* What is behind the scene, where the camera sees no direction. */
static void fill_empty(const conic_shot_work *work, const conic_render_options *render, float empty[4]) {
  int is_composited = (conic_source_measure(work->source)->abilities & CONIC_SOURCE_COMPOSITES) != 0;
  float factor = is_composited ? 1.0f : conic_exposure_factor(render->exposure);
  if (!render->has_background)
    return;
  for (int c = 0; c < 3; c++)
    empty[c] = render->background[c] * factor;
  empty[3] = 1.0f;
}

conic_status conic_stage_gathered(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                                  conic_render_statistics *statistics) {
  const conic_shot_work *work = stage->work;
  view_gathering g = {stage, look, look->render->lighting, statistics};
  conic_gather_options gather;
  memset(statistics, 0, sizeof *statistics);
  conic_lighting_place(look->camera, &g.lighting);
  conic_gather_options_init(&gather);
  gather.camera = *look->camera;
  gather.near_z = look->render->near_z;
  gather.samples = look->view->samples;
  gather.cookie = &g;
  gather.draw = draw_view;
  conic_find_reach(work, gather.minimum, gather.maximum);
  fill_empty(work, look->render, gather.empty);
  if (look->sample)
    place_in_views(work, look->sample, &gather);
  if (stage->next != stage->leaf) /* views are lit by what is drawn of these */
    gather.view_planes = 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_ALBEDO;
  return conic_gather(work->context, &gather, image);
}
