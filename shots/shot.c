#include "conic/gaussian_judge.h"
#include "core/base/color.h"
#include "shots/backdrop.h"
#include "shots/bound_plane.h"
#include "shots/motion_plane.h"
#include "shots/stage.h"
#include "shots/way.h"
#include "source/source_kind.h"
#include "source/surfaces_among.h"

void conic_shot_init_sized(conic_shot *shot, size_t size) {
  conic_shot own;
  memset(&own, 0, sizeof own);
  own.size = sizeof own;
  own.planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z;
  conic_render_options_init(&own.render);
  conic_source_view_init(&own.view);
  conic_gaussian_options_init(&own.gaussians);
  conic_options_give(shot, size, &own);
}

/* --- the chain --- */

static const conic_shot_stage *stages_chain(conic_shot_work *work, conic_shot_stage stages[CONIC_MOST_STAGES]) {
  const conic_shot_plan *plan = &work->plan;
  conic_shot_stage *leaf = &stages[CONIC_MOST_STAGES - 1], *first = leaf;
  *leaf = (conic_shot_stage){.draw = conic_stage_leaf, .leaf = leaf, .work = work};
  int is_lit_below = plan->lit == CONIC_LIT_BY_VIEW || (plan->lit != CONIC_LIT_NOT && plan->is_composited);
  const int has_roles = (work->shot->catchers | work->shot->holdouts) != 0;
  const struct {
    int is_there;
    conic_status (*draw)(const conic_shot_stage *, const conic_look *, conic_image *, conic_render_statistics *);
  } above[] = {{is_lit_below, conic_stage_lit},
               {has_roles && (is_lit_below || plan->lit == CONIC_LIT_NOT), conic_stage_roles},
               {plan->is_apart, conic_stage_composited},
               {plan->is_gathered, conic_stage_gathered},
               {plan->lit != CONIC_LIT_NOT && !is_lit_below, conic_stage_lit},
               {has_roles && plan->lit != CONIC_LIT_NOT && !is_lit_below, conic_stage_roles},
               {work->shot->light.dome_stops > 0.0, conic_stage_domed},
               {plan->is_accumulated, conic_stage_accumulated}};
  for (size_t i = 0; i < sizeof above / sizeof *above; i++) {
    if (!above[i].is_there)
      continue;
    const conic_shot_stage *next = first--;
    *first = (conic_shot_stage){above[i].draw, next, leaf, work};
  }
  return first;
}

int conic_work_has_picture(const conic_shot_work *work) {
  return work->units <= CONIC_UNITS_FRAMES || work->executor->index == 0;
}

void conic_work_trace(const conic_shot_work *work, const char *kind, const char *name, uint64_t number,
                      conic_moment since, uint64_t bytes) {
  work->executor->trace(work->executor->data, kind, name, number, since, bytes);
}

/* --- drawing --- */

conic_status conic_shot_work_begin(conic_source *source, conic_renderer *renderer, const conic_shot *shot,
                                   conic_shot_work *work) {
  memset(work, 0, sizeof *work);
  work->context = source->context;
  work->source = source;
  work->renderer = renderer;
  work->shot = shot;
  work->noise = work->bound = -1.0;
  conic_executor_alone(&work->alone);
  work->executor = &work->alone.executor;
  conic_status status = conic_shot_plan_make(source, renderer, shot, &work->plan);
  work->planes = work->plan.planes;
  work->surfaces = work->plan.is_apart ? conic_source_surfaces(source) : source;
  return status == CONIC_OK ? conic_source_composite_by(source, &shot->gaussians) : status;
}

/* The plane doubt is not the renderer's, but the oracle's about what it may have drawn. */
static conic_status find_doubts(const conic_shot_work *work, const conic_camera *camera, conic_image *image) {
  const conic_shot *shot = work->shot;
  conic_gaussian_judging judging;
  conic_image drawn = {0};
  const conic_gaussian_surfaces surfaces = {.image = &drawn};
  if (!image->planes[CONIC_PLANE_DOUBT])
    return CONIC_OK;
  conic_gaussian_judging_init(&judging);
  judging.samples = shot->view.samples;
  conic_status status = conic_shot_move(shot, work->source, 0.5);
  if (status == CONIC_OK && work->plan.is_composited) {
    judging.surfaces = &surfaces;
    status = conic_source_draw_surfaces(work->source, work->renderer, camera, &shot->render, &shot->view,
                                        conic_image_planes(image), &drawn);
  }
  if (status == CONIC_OK)
    status = conic_gaussian_find_doubts(work->context, conic_source_gaussians(work->source), camera, &shot->gaussians,
                                        &judging, image);
  conic_shot_rest(shot, work->source);
  conic_image_release(work->context, &drawn);
  return status;
}

static void tell_outcome(const conic_shot_work *work, const conic_render_statistics *statistics,
                         conic_shot_outcome *outcome) {
  *outcome = (conic_shot_outcome){.statistics = *statistics,
                                  .light_ms = work->light_ms,
                                  .samples = work->samples,
                                  .noise = work->noise,
                                  .focus_depth = work->focus_depth,
                                  .bound = work->bound};
}

conic_status conic_shot_work_draw(conic_shot_work *work, conic_image *image, conic_shot_outcome *outcome) {
  const conic_shot *shot = work->shot;
  conic_shot_stage stages[CONIC_MOST_STAGES];
  conic_render_statistics statistics;
  conic_camera camera;
  conic_image whole = {0};
  memset(&statistics, 0, sizeof statistics);
  conic_status status = conic_shot_camera(work->context, shot, 0.5, &camera);
  const conic_shot_stage *first = stages_chain(work, stages);
  const conic_look look = {&camera, &shot->render, &shot->view, NULL};
  if (status == CONIC_OK)
    status = conic_bound_plane_begin(first, &look, image, &whole);
  if (status == CONIC_OK)
    status = first->draw(first, &look, image, &statistics);
  if (status == CONIC_OK && conic_work_has_picture(work) && conic_image_planes(&whole))
    work->bound = conic_bound_plane_find(&whole, image);
  conic_image_release(work->context, &whole);
  if (status == CONIC_OK && conic_work_has_picture(work) && shot->has_backdrop)
    conic_backdrop_put(shot->backdrop_top, shot->backdrop_bottom, conic_exposure_factor(shot->render.exposure), image);
  if (status == CONIC_OK && conic_work_has_picture(work))
    status = conic_image_locate(work->context, &camera, shot->view.samples, image);
  if (status == CONIC_OK && conic_work_has_picture(work))
    status = conic_motion_plane_find(work, &camera, shot->view.samples, image);
  if (status == CONIC_OK && conic_work_has_picture(work))
    status = find_doubts(work, &camera, image);
  if (outcome)
    tell_outcome(work, &statistics, outcome);
  return status;
}

/* The image with planes of its own for what has to be drawn and is not wanted; these go with `own`. */
static conic_status add_planes(const conic_shot_work *work, unsigned planes, conic_image *all, conic_image *own) {
  conic_status status = conic_image_allocate(work->context, all->width, all->height, planes, own);
  for (int i = 0; i < CONIC_N_PLANES && status == CONIC_OK; i++)
    if (planes >> i & 1)
      all->planes[i] = own->planes[i];
  return status;
}

conic_status conic_shot_draw(conic_source *source, conic_renderer *renderer, const conic_shot *given,
                             conic_image *image, conic_shot_outcome *outcome) {
  conic_shot shot;
  conic_shot_work work;
  conic_shot_init(&shot);
  if (!conic_options_take(&shot, given) || image->width != shot.camera.width || image->height != shot.camera.height)
    return conic_fail(source->context, CONIC_ERROR_ARGUMENT,
                      "%s: the shot was not initialised, or the image is not of its camera's size", source->name);
  shot.planes = conic_image_planes(image);
  conic_source_settle(source, &shot.render);
  conic_status status = conic_shot_work_begin(source, renderer, &shot, &work);
  if (status != CONIC_OK)
    return status;
  conic_image all = *image, own;
  memset(&own, 0, sizeof own);
  unsigned missing = work.planes & ~shot.planes;
  if (missing)
    status = add_planes(&work, missing, &all, &own);
  if (status == CONIC_OK)
    status = conic_shot_work_draw(&work, &all, outcome);
  image->is_display = all.is_display;
  conic_image_release(work.context, &own);
  return status;
}

/* What the exposure is found by: no background, one sample a pixel. */
static conic_status make_plain(conic_context *context, const conic_shot *shot, conic_shot *made) {
  conic_shot plain = *shot;
  plain.render.has_background = plain.has_backdrop = 0;
  plain.render.exposure = 0.0;
  plain.view.samples = 1;
  plain.view.most_levels = 0;
  plain.n_samples = 0;
  plain.aperture.diameter = 0.0;
  plain.is_shutter_open = 0;
  plain.motion = NULL;
  plain.planes = 1u << CONIC_PLANE_RGBA;
  if (!plain.light.n_lamps) /* without which it may be dark */
    memset(&plain.light, 0, sizeof plain.light);
  conic_status status = conic_shot_camera(context, shot, 0.5, &plain.camera);
  *made = plain;
  return status;
}

conic_status conic_shot_expose_together(conic_source *source, conic_renderer *renderer, const conic_executor *executor,
                                        conic_shared_units units, conic_shot *shot) {
  conic_context *context = source->context;
  conic_shot plain;
  conic_shot_work work;
  conic_image image;
  memset(&image, 0, sizeof image);
  conic_status status = make_plain(context, shot, &plain);
  if (status == CONIC_OK)
    status = conic_shot_work_begin(source, renderer, &plain, &work);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, plain.camera.width, plain.camera.height, work.planes, &image);
  if (status == CONIC_OK && units == CONIC_UNITS_WINDOWS) {
    work.executor = executor;
    work.units = units;
  }
  if (status == CONIC_OK)
    status = conic_shot_work_draw(&work, &image, NULL);
  if (status == CONIC_OK) {
    shot->render.exposure = conic_image_exposure(&image);
    conic_log(context, CONIC_LOG_INFO, "exposure: %g stops", shot->render.exposure);
  }
  conic_image_release(context, &image);
  return status;
}

conic_status conic_shot_expose(conic_source *source, conic_renderer *renderer, conic_shot *shot) {
  return conic_shot_expose_together(source, renderer, NULL, CONIC_UNITS_NONE, shot);
}
