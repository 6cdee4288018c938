#include "shots/way.h"

#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "source/source_kind.h"

/* By Rodrigues' formula: against the clock as seen from where the axis, which is unit, points to. */
static void turn_about(const double axis[3], double cosine, double sine, double v[3]) {
  double across[3], along = conic_dot(axis, v) * (1.0 - cosine);
  conic_cross(axis, v, across);
  for (int i = 0; i < 3; i++)
    v[i] = v[i] * cosine + across[i] * sine + axis[i] * along;
}

void conic_camera_orbit(const double center[3], const double up[3], double turns, conic_camera *camera) {
  double angle = conic_radians(360.0 * turns), length = conic_length(up);
  const double axis[3] = {up[0] / length, up[1] / length, up[2] / length};
  if (turns == 0.0)
    return;
  for (int i = 0; i < 3; i++) {
    double *row = camera->cam_from_world[i], to_center = conic_dot(row, center);
    turn_about(axis, conic_cos(angle), conic_sin(angle), row);
    row[3] += to_center - conic_dot(row, center);
  }
}

static double depth_of(const conic_camera *camera, const double place[3]) {
  double depth = camera->cam_from_world[2][3];
  for (int axis = 0; axis < 3; axis++)
    depth += camera->cam_from_world[2][axis] * place[axis];
  return depth;
}

/* The depth at which both eyes' pictures agree; 0: nowhere. */
static double convergence_of(const conic_stereo_eye *eye, const conic_camera *camera) {
  if (!eye->finds_convergence)
    return eye->convergence;
  double depth = depth_of(camera, eye->center);
  return depth > 0.0 && !camera->kind && !camera->lens ? depth : 0.0;
}

conic_status conic_camera_move_eye(conic_context *context, const conic_stereo_eye *eye, conic_camera *camera) {
  if (eye->shift == 0.0)
    return CONIC_OK;
  double depth = convergence_of(eye, camera);
  if ((camera->kind != CONIC_CAMERA_PERSPECTIVE && camera->kind != CONIC_CAMERA_FISHEYE) ||
      (depth > 0.0 && (camera->kind || camera->lens)))
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "two eyes are of perspective and fisheye cameras; two that distort are parallel: convergence 0");
  camera->cam_from_world[0][3] -= eye->shift;
  if (depth > 0.0)
    camera->cx += camera->fx * (eye->shift / depth);
  return CONIC_OK;
}

static conic_status between_cameras(conic_context *context, const conic_shot *shot, double frames,
                                    conic_camera *camera) {
  const conic_camera_way *way = &shot->way;
  double place = way->place + frames, last = (double)way->n_cameras - 1.0;
  if (way->n_cameras == 0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the camera's way has no cameras");
  place = place < 0.0 ? 0.0 : place > last ? last : place;
  size_t from = (size_t)place, to = from + 1 < way->n_cameras ? from + 1 : from;
  conic_status status =
      conic_camera_between(context, &way->cameras[from], &way->cameras[to], place - (double)from, camera);
  return status == CONIC_OK ? conic_camera_move_eye(context, &shot->eye, camera) : status;
}

conic_status conic_shot_camera(conic_context *context, const conic_shot *shot, double time, conic_camera *camera) {
  const conic_camera_way *way = &shot->way;
  double frames = shot->shutter[0] + (shot->shutter[1] - shot->shutter[0]) * time;
  *camera = shot->camera;
  if (!shot->is_shutter_open)
    return CONIC_OK;
  if (way->kind == CONIC_WAY_ORBIT)
    conic_camera_orbit(way->center, way->up, frames / way->frames_a_turn, camera);
  return way->kind == CONIC_WAY_CAMERAS ? between_cameras(context, shot, frames, camera) : CONIC_OK;
}

conic_status conic_shot_move(const conic_shot *shot, conic_source *source, double time) {
  double frame = shot->frame + shot->shutter[0] + (shot->shutter[1] - shot->shutter[0]) * time;
  return shot->motion ? conic_motion_apply(shot->motion, source, frame) : CONIC_OK;
}

/* It cannot fail: nothing is asked for. */
void conic_shot_rest(const conic_shot *shot, conic_source *source) {
  if (shot->motion)
    conic_source_move(source, NULL, 0);
}

conic_status conic_shot_sample(conic_source *source, const conic_shot *shot, uint64_t index, conic_sample *sample) {
  conic_camera camera;
  double time = conic_sample_time(index);
  conic_status status = conic_shot_camera(source->context, shot, time, &camera);
  if (status == CONIC_OK)
    status = conic_shot_move(shot, source, time);
  return status == CONIC_OK ? conic_sample_place(source->context, &camera, &shot->aperture, index, sample) : status;
}
