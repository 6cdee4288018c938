#include "shots/shot_faults.h"

#include <stdio.h>
#include <string.h>

#include "conic/shot_file.h"
#include "lighting/lamps.h"

static int say_fault(const char *fault, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  snprintf(wrong, CONIC_CAMERA_FAULT_ROOM, "%s", fault ? fault : "");
  return fault != NULL;
}

static int has_direction(const double v[3]) {
  return v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0;
}

int conic_camera_value_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  return conic_camera_is_wrong(value, wrong);
}

int conic_way_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  const conic_camera_way *way = value;
  const char *fault = NULL;
  if (way->kind == CONIC_WAY_ORBIT && (!has_direction(way->up) || !(way->frames_a_turn > 0.0)))
    fault = "an orbit has an axis, and frames a turn";
  else if (way->kind == CONIC_WAY_CAMERAS && way->n_cameras == 0)
    fault = "the camera's way has no cameras";
  return say_fault(fault, wrong);
}

int conic_light_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  const conic_light *light = value;
  int is_none = light->frame != CONIC_LIGHT_HEAD && !has_direction(light->direction);
  return say_fault(is_none ? "the light has no direction" : NULL, wrong);
}

int conic_lighting_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  const conic_lighting *lighting = value;
  int is_none = memcmp(lighting->sky, lighting->ground, sizeof lighting->sky) != 0 && !has_direction(lighting->up);
  return say_fault(is_none ? "the sky has no direction up" : NULL, wrong);
}

int conic_render_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  const conic_render_options *render = value;
  const char *fault = render->passes == 2                                  ? "passes is 1 or 3"
                      : render->has_light && !has_direction(render->light) ? "the light has no direction"
                                                                           : NULL;
  return say_fault(fault, wrong);
}

int conic_shot_light_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  const conic_shot_light *light = value;
  const conic_lighting_options lamps = {.lamps = light->lamps, .n_lamps = (size_t)light->n_lamps};
  return say_fault(conic_lamps_fault(&lamps), wrong);
}

int conic_aperture_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  const conic_aperture *aperture = value;
  int is_none = aperture->n_blades == 1 || aperture->n_blades == 2;
  return say_fault(is_none ? "a lens has 3 blades at least, or is round" : NULL, wrong);
}

int conic_map_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  const conic_shot_map *map = value;
  int is_empty = 0;
  for (int axis = 0; axis < 3; axis++)
    is_empty |= !(map->minimum[axis] <= map->maximum[axis]);
  return say_fault(is_empty ? "the map's box is empty" : NULL, wrong);
}

int conic_shot_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  return say_fault(conic_shot_fault(value), wrong);
}

const char *conic_shot_fault(const conic_shot *shot) {
  const unsigned of_means = 1u << CONIC_PLANE_SAMPLES | 1u << CONIC_PLANE_VARIANCE;
  if (shot->light.n_lamps < 0 || shot->light.n_lamps > CONIC_MAX_LAMPS)
    return "more lamps than there may be";
  if (shot->n_samples > CONIC_MAX_ACCUMULATED)
    return "more samples than there may be";
  if (shot->n_samples > 0 && shot->view.samples > 1)
    return "means of samples draw one sample a pixel at a time: view.samples is 1";
  if (!shot->n_samples && shot->planes & of_means)
    return "the planes samples and variance are of means: n_samples is above 0";
  if (!shot->n_samples && (shot->aperture.diameter > 0.0 || shot->is_shutter_open || shot->motion))
    return "a lens, a shutter and motion are of means: n_samples is above 0";
  return NULL;
}
