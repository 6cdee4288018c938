#include "raster/tiles/lights.h"

#include "core/base/base.h"
#include "core/base/color.h"

/* 0 where it has none. */
static int take_direction(const double from[3], float unit[3]) {
  double length_squared = (from[0] * from[0] + from[1] * from[1]) + from[2] * from[2];
  if (!(length_squared > 1e-200 && length_squared < 1e200))
    return 0;
  for (int i = 0; i < 3; i++)
    unit[i] = (float)(from[i] / sqrt(length_squared));
  return 1;
}

/* Camera space has y down and z forward, and a light of the camera y up and z towards the viewer. */
static void turn_with_camera(const conic_camera *camera, const double of_light[3], double world[3]) {
  const double(*m)[4] = camera->cam_from_world;
  for (int i = 0; i < 3; i++)
    world[i] = (m[0][i] * of_light[0] - m[1][i] * of_light[1]) - m[2][i] * of_light[2];
}

void conic_lighting_place(const conic_camera *camera, conic_lighting *lighting) {
  for (int i = 0; i < lighting->n_lights && i < CONIC_MAX_LIGHTS; i++) {
    conic_light *light = &lighting->lights[i];
    if (light->frame != CONIC_LIGHT_CAMERA)
      continue;
    const double of_light[3] = {light->direction[0], light->direction[1], light->direction[2]};
    turn_with_camera(camera, of_light, light->direction);
    light->frame = CONIC_LIGHT_WORLD;
  }
}

static int is_color(const float color[3]) {
  for (int i = 0; i < 3; i++)
    if (!(color[i] >= 0.0f && color[i] <= 1e6f))
      return 0;
  return 1;
}

/* Returns what is wrong with it, or null. */
static const char *take_light(const conic_camera *camera, const conic_light *from, conic_finish_light *light) {
  double direction[3] = {from->direction[0], from->direction[1], from->direction[2]};
  if (from->frame != CONIC_LIGHT_WORLD && from->frame != CONIC_LIGHT_CAMERA && from->frame != CONIC_LIGHT_HEAD)
    return "a light stands in an unknown frame";
  if (!is_color(from->color))
    return "a light's colour is not within 0 and 1e6";
  light->is_head = from->frame == CONIC_LIGHT_HEAD;
  if (from->frame == CONIC_LIGHT_CAMERA)
    turn_with_camera(camera, from->direction, direction);
  if (!light->is_head && !take_direction(direction, light->towards))
    return "the light has no direction";
  for (int i = 0; i < 3; i++) {
    light->diffuse[i] = CONIC_DIFFUSE * from->color[i];
    light->specular[i] = CONIC_SPECULAR * from->color[i];
  }
  return NULL;
}

static const char *take_sky(const conic_lighting *from, conic_finish_lights *lights) {
  if (!is_color(from->sky) || !is_color(from->ground))
    return "the sky's or the ground's colour is not within 0 and 1e6";
  for (int i = 0; i < 3; i++) {
    lights->ambient[i] = 0.5f * (from->sky[i] + from->ground[i]);
    lights->slope[i] = 0.5f * (from->sky[i] - from->ground[i]);
    lights->has_sky |= from->sky[i] != from->ground[i];
  }
  return lights->has_sky && !take_direction(from->up, lights->up) ? "the sky has no direction up" : NULL;
}

static const char *take_lighting(const conic_camera *camera, const conic_lighting *from, conic_finish_lights *lights) {
  const char *wrong = NULL;
  if (from->n_lights < 0 || from->n_lights > CONIC_MAX_LIGHTS)
    return "there are 0 to 8 lights";
  if (!conic_is_zero(from->reserved, sizeof from->reserved))
    return "the lighting's reserved words are not zero";
  lights->n_lights = from->n_lights;
  lights->is_grey = conic_is_grey(from->sky) && conic_is_grey(from->ground);
  for (int i = 0; i < from->n_lights && !wrong; i++) {
    wrong = take_light(camera, &from->lights[i], &lights->lights[i]);
    lights->is_grey &= conic_is_grey(from->lights[i].color);
  }
  return wrong ? wrong : take_sky(from, lights);
}

conic_status conic_finish_lights_init(conic_context *context, const conic_camera *camera,
                                      const conic_render_options *options, conic_finish_lights *lights) {
  conic_lighting alone = {.n_lights = 1,
                          .lights[0] = {.frame = options->has_light ? CONIC_LIGHT_WORLD : CONIC_LIGHT_HEAD}};
  for (int i = 0; i < 3; i++) {
    alone.lights[0].color[i] = 1.0f;
    alone.lights[0].direction[i] = options->light[i];
    alone.sky[i] = alone.ground[i] = CONIC_AMBIENT;
  }
  memset(lights, 0, sizeof *lights);
  const char *wrong = take_lighting(camera, options->lighting.is_given ? &options->lighting : &alone, lights);
  return wrong ? conic_fail(context, CONIC_ERROR_ARGUMENT, "%s", wrong) : CONIC_OK;
}

conic_status conic_finish_init(conic_context *context, const conic_camera *camera, const conic_render_options *options,
                               conic_finish_lights *lights, conic_finish *finish) {
  finish->options = options;
  finish->lights = lights;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      finish->world_from_cam[i][j] = (float)camera->cam_from_world[j][i];
  finish->exposure = conic_exposure_factor(options->exposure);
  for (int i = 0; i < 3; i++)
    finish->background[i] = options->has_background ? options->background[i] * finish->exposure : 0.0f;
  finish->background[3] = options->has_background ? 1.0f : 0.0f;
  return conic_finish_lights_init(context, camera, options, lights);
}
