#include "shots/shot_faults.h"

#include <string.h>

#include "conic/shot_file.h"
#include "core/image/view_arguments.h"
#include "lighting/lamps.h"

static int has_direction(const double v[3]) {
  return v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0;
}

const char *conic_fault_of_camera(const void *value) {
  static _Thread_local char wrong[CONIC_CAMERA_FAULT_ROOM];
  return conic_camera_is_wrong(value, wrong) ? wrong : NULL;
}

const char *conic_fault_of_way(const void *value) {
  const conic_camera_way *way = value;
  if (way->kind == CONIC_WAY_ORBIT && (!has_direction(way->up) || !(way->frames_a_turn > 0.0)))
    return "an orbit has an axis, and frames a turn";
  return way->kind == CONIC_WAY_CAMERAS && way->n_cameras == 0 ? "the camera's way has no cameras" : NULL;
}

const char *conic_fault_of_light(const void *value) {
  const conic_light *light = value;
  return light->frame != CONIC_LIGHT_HEAD && !has_direction(light->direction) ? "the light has no direction" : NULL;
}

const char *conic_fault_of_lighting(const void *value) {
  const conic_lighting *lighting = value;
  int has_sky = memcmp(lighting->sky, lighting->ground, sizeof lighting->sky) != 0;
  return has_sky && !has_direction(lighting->up) ? "the sky has no direction up" : NULL;
}

const char *conic_fault_of_render(const void *value) {
  const conic_render_options *render = value;
  if (render->has_light && !has_direction(render->light))
    return "the light has no direction";
  return render->passes == 2 ? "passes is 1 or 3" : NULL;
}

const char *conic_fault_of_shot_light(const void *value) {
  const conic_shot_light *light = value;
  const conic_lighting_options lamps = {.lamps = light->lamps, .n_lamps = (size_t)light->n_lamps};
  return conic_lamps_fault(&lamps);
}

const char *conic_fault_of_aperture(const void *value) {
  const conic_aperture *aperture = value;
  return aperture->n_blades == 1 || aperture->n_blades == 2 ? "a lens has 3 blades at least, or is round" : NULL;
}

const char *conic_fault_of_map(const void *value) {
  const conic_shot_map *map = value;
  for (int axis = 0; axis < 3; axis++)
    if (!(map->minimum[axis] <= map->maximum[axis]))
      return "the map's box is empty";
  return NULL;
}

const char *conic_fault_of_shot(const void *value) {
  const conic_shot *shot = value;
  const unsigned of_means = 1u << CONIC_PLANE_SAMPLES | 1u << CONIC_PLANE_VARIANCE;
  if (shot->light.n_lamps < 0 || shot->light.n_lamps > CONIC_MAX_LAMPS)
    return "more lamps than there may be";
  if (shot->n_samples > CONIC_MAX_ACCUMULATED)
    return "more samples than there may be";
  if (shot->n_samples > 0 && shot->view.samples > 1)
    return "means of samples draw one sample a pixel at a time: view.samples is 1";
  if (shot->planes & 1u << CONIC_PLANE_BOUND &&
      (shot->n_samples > 0 || !(shot->view.error_px > 0.0 || shot->view.budget)))
    return "the plane bound is of pictures by an error or a budget that are no means: view.error_px or view.budget";
  if (!shot->n_samples && shot->planes & of_means)
    return "the planes samples and variance are of means: n_samples is above 0";
  if (!shot->n_samples && (shot->aperture.diameter > 0.0 || shot->is_shutter_open || shot->motion))
    return "a lens, a shutter and motion are of means: n_samples is above 0";
  return NULL;
}
