/* The mean of many samples, each drawn by the stages below. */
#include "accumulation/sequence.h"
#include "core/base/color.h"
#include "shots/backdrop.h"
#include "shots/focus.h"
#include "shots/samples_shared.h"
#include "shots/way.h"

typedef struct accumulating {
  const conic_shot_stage *stage;
  conic_shot_work *work;
  const conic_look *look; /* of the middle */
  conic_image *image;
  conic_render_statistics *statistics;
} accumulating;

static int has_soft_sun(const conic_shot *shot) {
  int n = 0;
  for (int i = 0; i < shot->render.lighting.n_lights; i++)
    n += shot->light.sun_radius_deg[i] > 0.0f;
  return n > 0;
}

static conic_status camera_at(void *cookie, double time, conic_camera *camera) {
  const conic_shot_work *work = ((const accumulating *)cookie)->work;
  return conic_shot_camera(work->context, work->shot, time, camera);
}

void conic_sample_see(uint64_t index, int has_one_depth, conic_source_view *view) {
  view->chance = conic_sequence_at(index, CONIC_SEQUENCE_SURFACE);
  if (view->transparency != CONIC_TRANSPARENCY_NONE && has_one_depth)
    view->transparency = CONIC_TRANSPARENCY_CHANCE;
}

static conic_status draw_sample(void *cookie, const conic_sample *sample, conic_image *image) {
  accumulating *a = cookie;
  const conic_shot *shot = a->work->shot;
  conic_render_options render = *a->look->render;
  conic_render_statistics statistics = {.ms = {0}};
  conic_source_view view = *a->look->view;
  conic_status status = CONIC_OK;
  conic_sample_see(sample->index, a->work->plan.lit != CONIC_LIT_NOT || a->work->plan.is_composited, &view);
  if (has_soft_sun(shot))
    status = conic_lighting_sample(a->work->context, &shot->render.lighting, shot->light.sun_radius_deg, sample->index,
                                   &render.lighting);
  if (status == CONIC_OK)
    status = conic_shot_move(shot, a->work->source, sample->time);
  const conic_look look = {&sample->camera, &render, &view, sample};
  if (status == CONIC_OK)
    status = a->stage->next->draw(a->stage->next, &look, image, &statistics);
  a->statistics->ms.frame += statistics.ms.frame;
  return status;
}

conic_status conic_sums_show(const conic_shot *shot, const conic_accumulation *sums, conic_image *image) {
  conic_status status = conic_accumulation_resolve(sums, image);
  if (status == CONIC_OK && shot->has_backdrop)
    conic_backdrop_put(shot->backdrop_top, shot->backdrop_bottom, conic_exposure_factor(shot->render.exposure), image);
  return status;
}

static conic_status watch(void *cookie, const conic_accumulation *sums) {
  const accumulating *a = cookie;
  const conic_sums_keeper *keeper = a->work->keeper;
  return keeper->watch(keeper->cookie, sums, a->image, a->statistics);
}

/* The sums that are gone on with, or none yet. */
static conic_status begin_sums(const accumulating *a, conic_accumulation **sums) {
  const conic_camera *camera = &a->work->shot->camera;
  const conic_sums_keeper *keeper = a->work->keeper;
  unsigned planes = (a->work->planes | 1u << CONIC_PLANE_RGBA) & CONIC_ACCUMULATED_PLANES;
  conic_status status = CONIC_OK;
  if (keeper && keeper->find && a->work->executor->index == 0)
    status = keeper->find(keeper->cookie, camera, planes, sums);
  if (status == CONIC_OK && !*sums)
    status = conic_accumulation_create(a->work->context, camera->width, camera->height, planes, 0, sums);
  return status;
}

static conic_status run_samples(accumulating *a, conic_accumulation *sums) {
  const conic_shot *shot = a->work->shot;
  conic_accumulate_options options;
  conic_accumulate_options_init(&options);
  options.camera = shot->camera;
  options.aperture = shot->aperture;
  options.aperture.focus = a->work->focus_depth;
  options.end_sample = shot->n_samples;
  options.seconds = a->work->seconds;
  options.noise = shot->noise;
  options.cookie = a;
  options.camera_at = shot->is_shutter_open ? camera_at : NULL;
  options.draw = draw_sample;
  options.watch = a->work->keeper && a->work->keeper->watch ? watch : NULL;
  if (a->work->plan.lit == CONIC_LIT_BY_SAMPLE)
    options.sample_planes = 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_ALBEDO;
  if (shot->catchers | shot->holdouts)
    options.sample_planes |= 1u << CONIC_PLANE_ID;
  if (shot->light.dome_stops > 0.0)
    options.sample_planes |= 1u << CONIC_PLANE_Z;
  return a->work->units == CONIC_UNITS_SAMPLES ? conic_accumulate_together(a->work, &options, sums)
                                               : conic_accumulate(a->work->context, &options, sums);
}

/* What the middle of lens and shutter shows: the planes that have no means, and where it is sharp. */
static conic_status draw_middle(const accumulating *a) {
  conic_shot_work *work = a->work;
  int is_seen = conic_work_has_picture(work) || conic_focus_is_seen(work->shot);
  conic_status status = conic_shot_move(work->shot, work->source, 0.5);
  if (status == CONIC_OK && is_seen)
    status = a->stage->next->draw(a->stage->next, a->look, a->image, a->statistics);
  if (status == CONIC_OK)
    status = conic_focus_find(work->context, work->shot, a->image, &work->focus_depth);
  conic_shot_rest(work->shot, work->source);
  return status == CONIC_OK ? conic_image_locate(work->context, a->look->camera, 1, a->image) : status;
}

/* What became of the sums. */
static conic_status end_sums(const accumulating *a, const conic_accumulation *sums, conic_status status) {
  conic_shot_work *work = a->work;
  const conic_sums_keeper *keeper = work->keeper;
  int is_shared = work->units == CONIC_UNITS_SAMPLES;
  if (status == CONIC_ERROR_CANCELLED && sums && keeper && keeper->stopped && !is_shared)
    keeper->stopped(keeper->cookie, sums);
  if (status != CONIC_OK || !conic_work_has_picture(work))
    return status;
  status = conic_accumulation_resolve(sums, a->image);
  conic_accumulation_inspect(sums, &work->samples);
  work->noise = conic_accumulation_noise(sums);
  return status == CONIC_OK && keeper && keeper->keeps_end ? keeper->keep(keeper->cookie, sums) : status;
}

conic_status conic_stage_accumulated(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                                     conic_render_statistics *statistics) {
  accumulating a = {stage, stage->work, look, image, statistics};
  conic_accumulation *sums = NULL;
  conic_status status = draw_middle(&a);
  if (status == CONIC_OK)
    status = begin_sums(&a, &sums);
  if (status == CONIC_OK)
    status = run_samples(&a, sums);
  status = end_sums(&a, sums, status);
  conic_shot_rest(stage->work->shot, stage->work->source);
  conic_accumulation_destroy(sums);
  return status;
}
