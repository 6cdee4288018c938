/* A camera that sees all of a source. */

#include "core/image/framing.h"
#include "conic/shot.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "source/source_kind.h"

void conic_shot_framing_init_sized(conic_shot_framing *framing, size_t size) {
  conic_shot_framing own;
  memset(&own, 0, sizeof own);
  own.size = sizeof own;
  own.finds_up = own.finds_elevation = own.finds_azimuth = own.finds_near = own.n_turns = 1;
  conic_framing_init(&own.framing);
  conic_options_give(framing, size, &own);
}

/* What lies flat shows more of itself from higher up; so does a survey of points, unless it is rather a tower. */
static double elevation_for(const conic_source_scale *scale, const double up[3]) {
  static const double flat_part = 0.33, flat_elevation_deg = 35.0, elevation_deg = 15.0;
  const int is_survey = scale->up_basis == CONIC_UP_KIND && scale->up[2] > 0.0 && !scale->n_triangles;
  double height = 0.0, ground = HUGE_VAL, longest = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double extent = scale->maximum[axis] - scale->minimum[axis];
    if (up[axis] != 0.0)
      height = extent;
    else {
      ground = extent < ground ? extent : ground;
      longest = extent > longest ? extent : longest;
    }
  }
  return height > 0.0 && height < (is_survey ? longest : flat_part * ground) ? flat_elevation_deg : elevation_deg;
}

/* A pinhole so far off that what it frames is what parallel rays do. */
static const double parallel_fov_deg = 0.5;

/* Turns the camera before a slope or a facade that it would see from beside or from behind, to where the studio's light
 * falls on it from the left. */
static conic_status turn_to_front(conic_source *source, conic_framing *framing) {
  static const double least_cosine = 0.5, step_deg = 15.0, good[2] = {-0.5, 0.8660254037844386};
  enum { N_STEPS = 24 };
  conic_framing level = *framing;
  double front[3], rows[3][3], best = -HUGE_VAL, least_slope;
  conic_status status = conic_source_front(source, front, &least_slope);
  level.elevation_deg = 0.0;
  for (int i = 0; i < N_STEPS && status == CONIC_OK; i++, level.azimuth_deg += step_deg) {
    conic_framing_rotation(&level, rows);
    double beside = conic_dot(front, rows[0]), towards = -conic_dot(front, rows[2]);
    double slope = sqrt(beside * beside + towards * towards), value = good[0] * beside + good[1] * towards;
    if (i == 0 && (slope < least_slope || towards >= least_cosine * slope))
      return CONIC_OK;
    framing->azimuth_deg = value > best ? level.azimuth_deg : framing->azimuth_deg;
    best = value > best ? value : best;
  }
  return status;
}

/* What of the framing is found, and the turn. */
static conic_status settle(conic_source *source, const conic_shot_framing *given, conic_framing *framing) {
  const int stands_within = given->has_eye || given->kind >= CONIC_CAMERA_EQUIRECTANGULAR;
  conic_status status = CONIC_OK;
  *framing = given->framing;
  if (given->finds_up)
    memcpy(framing->up, source->scale.up, sizeof framing->up);
  if (given->finds_elevation && stands_within)
    framing->elevation_deg = 0.0;
  else if (given->finds_elevation && !given->is_plain)
    framing->elevation_deg = elevation_for(&source->scale, framing->up);
  if (given->finds_azimuth && !stands_within && !given->is_plain)
    status = turn_to_front(source, framing);
  framing->azimuth_deg += 360.0 * (double)given->i_turn / (double)given->n_turns;
  return status;
}

static void stand_at(const double eye[3], conic_camera *camera) {
  for (int row = 0; row < 3; row++)
    camera->cam_from_world[row][3] = -conic_dot(camera->cam_from_world[row], eye);
}

/* Makes of the pinhole that frames the scene a camera of its kind. */
static void project(const conic_source_scale *scale, const conic_shot_framing *given, const conic_framing *framing,
                    conic_camera *camera) {
  const double shorter = camera->width < camera->height ? camera->width : camera->height;
  double center[3], distance = camera->cam_from_world[2][3];
  for (int axis = 0; axis < 3; axis++) {
    center[axis] = 0.5 * scale->minimum[axis] + 0.5 * scale->maximum[axis];
    distance += camera->cam_from_world[2][axis] * center[axis];
  }
  camera->kind = (uint32_t)given->kind;
  if (given->kind == CONIC_CAMERA_ORTHOGRAPHIC) { /* as large as the pinhole draws what is at the centre */
    camera->fx = camera->fy = camera->fx / distance;
    camera->cam_from_world[2][3] +=
        0.5 * framing->zoom * shorter / (camera->fx * conic_tan(conic_radians(0.5 * framing->fov_deg))) - distance;
  } else if (given->kind == CONIC_CAMERA_FISHEYE)
    camera->fx = camera->fy = framing->zoom * shorter / conic_radians(framing->fov_deg);
  else if (given->kind == CONIC_CAMERA_EQUIRECTANGULAR) { /* all around, from amid the scene */
    camera->fx = camera->fy = framing->zoom * camera->width / (2.0 * CONIC_PI);
    stand_at(center, camera);
  } else if (given->kind == CONIC_CAMERA_CUBE) { /* likewise; the picture is as wide as one of its sides */
    camera->fx = camera->fy = camera->cx = camera->cy = 0.5 * camera->width;
    stand_at(center, camera);
  }
  if (given->has_eye)
    stand_at(given->eye, camera);
}

conic_status conic_shot_frame(conic_source *source, const conic_shot_framing *given, conic_shot *shot) {
  conic_shot_framing own;
  conic_shot_framing_init(&own);
  if (given && !conic_options_take(&own, given))
    return conic_fail(source->context, CONIC_ERROR_ARGUMENT, "%s: the framing was not initialised", source->name);
  const conic_source_scale *scale = conic_source_measure(source);
  conic_framing framing;
  conic_status status = settle(source, &own, &framing);
  if (status != CONIC_OK)
    return status;
  conic_framing pinhole = framing;
  if (own.kind == CONIC_CAMERA_ORTHOGRAPHIC)
    pinhole.fov_deg = parallel_fov_deg;
  double near_z = HUGE_VAL;
  status = own.is_plain
               ? conic_source_frame(source, &pinhole, &shot->camera)
               : conic_source_fit(source, &pinhole, shot->render.kernel.cutoff, own.n_turns, &shot->camera, &near_z);
  if (status != CONIC_OK)
    return status;
  project(scale, &own, &framing, &shot->camera);
  if (shot->render.near_z == 0.0)
    shot->render.near_z = scale->near_z;
  if (own.finds_near && near_z < shot->render.near_z) /* strays, which are not framed, cut nothing off that is */
    shot->render.near_z = near_z;
  return CONIC_OK;
}
