/* Surfaces among Gaussians: what the stages below draw, lit, comes behind the Gaussians before it. */
#include "shots/stage.h"
#include "source/surfaces_among.h"

typedef struct compositing {
  const conic_shot_stage *stage;
  const conic_sample *sample;
} compositing;

static conic_status draw_below(void *cookie, const conic_camera *camera, const conic_render_options *render,
                               const conic_source_view *view, conic_image *surfaces,
                               conic_render_statistics *statistics) {
  const compositing *c = cookie;
  const conic_shot_stage *next = c->stage->next;
  const conic_look look = {camera, render, view, c->sample};
  return next->draw(next, &look, surfaces, statistics);
}

conic_status conic_stage_composited(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                                    conic_render_statistics *statistics) {
  const conic_shot_work *work = stage->work;
  compositing c = {stage, look->sample};
  const unsigned of_light = 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_ALBEDO;
  const unsigned of_roles = work->shot->catchers | work->shot->holdouts ? 1u << CONIC_PLANE_ID : 0;
  const conic_surfaces_drawer drawer = {(work->plan.lit == CONIC_LIT_NOT ? 0 : of_light) | of_roles, draw_below, &c};
  return conic_source_draw_among(work->source, work->renderer, look->camera, look->render, look->view, &drawer, image,
                                 statistics);
}
