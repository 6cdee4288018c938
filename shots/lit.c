/* Light that does not arrive: takes it away from what was drawn, by maps that the leaf draws. */

#include "accumulation/sequence.h"
#include "core/image/image_common.h"
#include "lighting/light_sharing.h"
#include "shots/shot_reach.h"

/* What draws the maps. */
typedef struct map_drawer {
  const conic_shot_stage *stage;
  conic_render_options render;
  conic_light_sharing *sharing; /* null: this process lights alone */
  uint64_t i_map;               /* which sample of its chances is next where surfaces let light through */
} map_drawer;

/* Of a map that all draw, the first process gets the pixels; the others look into an empty one. */
static conic_status draw_map_together(const map_drawer *drawer, const conic_look *look, conic_image *depth) {
  conic_render_statistics unused;
  if (drawer->stage->work->executor->index > 0)
    memset(depth->planes[CONIC_PLANE_Z], 0, conic_image_pixels(depth) * sizeof(float));
  return drawer->stage->leaf->draw(drawer->stage->leaf, look, depth, &unused);
}

/* Light comes through Gaussians before the nearest surface, by their exact response along its rays. */
static conic_status let_through(const conic_shot_work *work, const conic_camera *camera, conic_image *depth) {
  conic_gaussian_options options;
  conic_gaussian_planes planes = {.width = depth->width,
                                  .height = depth->height,
                                  .transparency = depth->planes[CONIC_PLANE_TRANSPARENCY],
                                  .surface_z = depth->planes[CONIC_PLANE_Z]};
  conic_gaussian_options_init(&options);
  options.isa = work->shot->render.isa;
  return conic_gaussians_render(work->context, conic_source_gaussians(work->source), camera, &options, &planes, NULL);
}

/* The nearest splat is what hides. */
static conic_status draw_surfaces_map(void *cookie, const conic_camera *camera, double near_z, conic_image *depth) {
  map_drawer *drawer = cookie;
  const conic_shot_work *work = drawer->stage->work;
  conic_render_options render = drawer->render;
  conic_source_view view = work->shot->view;
  render.near_z = near_z;
  view.samples = 1;
  if (view.transparency != CONIC_TRANSPARENCY_NONE) {
    view.transparency = CONIC_TRANSPARENCY_CHANCE;
    view.chance = conic_sequence_at(drawer->sharing ? drawer->sharing->i_map : drawer->i_map, CONIC_SEQUENCE_SHADOW);
    drawer->i_map += !work->plan.is_accumulated; /* the maps of a sample share its chance */
    render.passes = 3;
  }
  const conic_look look = {camera, &render, &view, NULL};
  if (drawer->sharing && !drawer->sharing->is_apart)
    return draw_map_together(drawer, &look, depth);
  return conic_source_draw(work->surfaces, work->renderer, camera, &render, &view, depth, NULL);
}

static conic_status draw_map(void *cookie, const conic_camera *camera, double near_z, conic_image *depth) {
  const conic_shot_work *work = ((const map_drawer *)cookie)->stage->work;
  conic_image surfaces = *depth;
  surfaces.planes[CONIC_PLANE_TRANSPARENCY] = NULL;
  conic_status status = draw_surfaces_map(cookie, camera, near_z, &surfaces);
  return status == CONIC_OK && depth->planes[CONIC_PLANE_TRANSPARENCY] ? let_through(work, camera, depth) : status;
}

static map_drawer drawer_of(const conic_shot_stage *stage) {
  const conic_source_scale *scale = conic_source_measure(stage->work->surfaces);
  map_drawer drawer = {.stage = stage, .render = stage->work->shot->render};
  drawer.render.passes = CONIC_PASS_OF_HIDING;
  drawer.render.epsilon = scale->epsilon;
  drawer.render.splat_length = CONIC_MAP_LENGTHS * scale->splat_length;
  drawer.render.cull_back = 0;
  drawer.render.skip_hidden = 1;
  drawer.render.shading = CONIC_SHADE_NONE;
  return drawer;
}

static conic_casters casters_of(const conic_shot_work *work, map_drawer *drawer) {
  conic_casters casters = {.draw = draw_map,
                           .cookie = drawer,
                           .epsilon = conic_splat_reach(work),
                           .lets_through = (uint64_t)work->plan.is_composited,
                           .epsilon_is_drawn = work->shot->view.transparency == CONIC_TRANSPARENCY_NONE};
  conic_find_reach(work, casters.minimum, casters.maximum);
  return casters;
}

static void fill_options(const conic_shot_work *work, conic_lighting_options *options) {
  const conic_shot *shot = work->shot;
  conic_lighting_options_init(options);
  options->n_directions = shot->light.n_directions;
  options->has_shadows = shot->light.has_shadows;
  options->lamps = shot->light.lamps;
  options->n_lamps = (size_t)shot->light.n_lamps;
  options->samples = shot->view.samples;
  options->isa = shot->render.isa;
  options->sky = shot->light.sky;
  options->reflectance = shot->light.reflectance;
}

/* What was chosen last is a map's. */
static conic_status choose_again(const conic_shot_work *work, const conic_look *look, const conic_image *image) {
  conic_image depth = {.width = image->width, .height = image->height};
  if (!(conic_source_measure(work->surfaces)->abilities & CONIC_SOURCE_STREAMS))
    return conic_source_choose(work->surfaces, look->camera, look->render, look->view);
  depth.planes[CONIC_PLANE_Z] = image->planes[CONIC_PLANE_Z];
  return conic_source_draw(work->surfaces, work->renderer, look->camera, look->render, look->view, &depth, NULL);
}

/* What light falls on is the first process's to say. */
static void send_receivers(const conic_executor *executor, conic_image *image) {
  size_t n = conic_image_pixels(image) * sizeof(float);
  executor->broadcast(executor->data, image->planes[CONIC_PLANE_Z], n);
  executor->broadcast(executor->data, image->planes[CONIC_PLANE_NORMAL], 3 * n);
}

/* A picture by itself, which all processes light that have drawn it together; `status` is what drawing it came to. */
static conic_status light_whole(map_drawer *drawer, const conic_lighter *lighter, const conic_look *look,
                                conic_status status, conic_image *image) {
  const conic_shot_work *work = drawer->stage->work;
  conic_light_sharing sharing = {.team = work->executor->team};
  if (work->units == CONIC_UNITS_WINDOWS) {
    status = conic_work_agree(work, status);
    drawer->sharing = &sharing;
    if (status == CONIC_OK)
      send_receivers(work->executor, image);
  }
  if (status == CONIC_OK)
    status = conic_image_light_shared(lighter->context, lighter->casters, look->camera, lighter->render,
                                      lighter->options, drawer->sharing, image);
  drawer->sharing = NULL;
  return status;
}

static conic_status light(const conic_shot_stage *stage, const conic_look *look, conic_image *image) {
  conic_shot_work *work = stage->work;
  conic_lighting_options options;
  double start = conic_seconds_now();
  map_drawer drawer = drawer_of(stage);
  conic_casters casters = casters_of(work, &drawer);
  conic_render_options render = work->shot->render;
  const conic_lighter lighter = {work->context, &casters, &render, &options};
  conic_status status;
  fill_options(work, &options);
  render.lighting = look->render->lighting;
  if (look->sample) {
    drawer.i_map = look->sample->index;
    status = conic_lighter_shade((void *)&lighter, look->sample->index, look->camera, image);
  } else {
    status = light_whole(&drawer, &lighter, look, CONIC_OK, image);
    if (status == CONIC_OK && work->plan.lit == CONIC_LIT_WHOLE && !work->plan.is_gathered &&
        conic_work_has_picture(work))
      status = choose_again(work, look, image);
  }
  work->light_ms += 1e3 * (conic_seconds_now() - start);
  return status;
}

conic_status conic_stage_lit(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                             conic_render_statistics *statistics) {
  const conic_shot_work *work = stage->work;
  conic_status status = stage->next->draw(stage->next, look, image, statistics);
  if (work->plan.is_accumulated && !look->sample) /* the middle of the samples, whose colours are not shown */
    return status;
  return status == CONIC_OK ? light(stage, look, image) : status;
}

/* Of a picture that processes draw together, the first one has the pixels. */
conic_status conic_stage_domed(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                               conic_render_statistics *statistics) {
  const conic_shot_work *work = stage->work;
  conic_status status = stage->next->draw(stage->next, look, image, statistics);
  int has_picture = work->units != CONIC_UNITS_WINDOWS || work->executor->index == 0;
  return status == CONIC_OK && has_picture && image->planes[CONIC_PLANE_RGBA]
             ? conic_image_eye_dome(work->context, look->camera, work->shot->light.dome_stops, image)
             : status;
}
