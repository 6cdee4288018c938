/* Where a sample looks from: its place in the pixel and on the lens; and cameras between two others. */
#include <string.h>

#include "accumulation/disc_point.h"
#include "accumulation/sequence.h"
#include "conic/accumulate.h"
#include "core/base/message.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/image/view_arguments.h"

double conic_sample_time(uint64_t index) {
  return conic_sequence_at(index, CONIC_SEQUENCE_SHUTTER);
}

/* A point of the polygon with corners on the unit circle, the first at the top. It has a triangle about its centre for
 * each side; the map keeps areas within each. */
static void point_on_polygon(int n_corners, double u, double v, double point[2]) {
  int corner = (int)(u * n_corners);
  double part = u * n_corners - corner, radius = sqrt(v), step = 2.0 * CONIC_PI / n_corners;
  double first = step * corner, second = step * (corner + 1);
  point[0] = radius * ((1.0 - part) * conic_sin(first) + part * conic_sin(second));
  point[1] = -radius * ((1.0 - part) * conic_cos(first) + part * conic_cos(second));
}

static int sees_all_around(const conic_camera *camera) {
  return camera->kind == CONIC_CAMERA_EQUIRECTANGULAR || camera->kind == CONIC_CAMERA_CUBE;
}

static conic_status check_aperture(conic_context *context, const conic_camera *camera, const conic_aperture *aperture) {
  if (!(aperture->diameter >= 0.0 && aperture->diameter < 1e30) || aperture->n_blades < 0 ||
      aperture->n_blades > CONIC_MAX_BLADES || aperture->n_blades == 1 || aperture->n_blades == 2)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "lens: a diameter below 0, or a number of blades that is none");
  if (aperture->diameter == 0.0)
    return CONIC_OK;
  if (!(aperture->focus > 0.0 && aperture->focus < 1e30))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "lens: the focus is to be in front of the camera");
  if (aperture->n_blades > 0 && sees_all_around(camera))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "lens: of a picture of all directions, it is round");
  return conic_view_camera_check(context, "lens", camera);
}

/* Turns a disc's point into a point of the ball that looks like that disc from all sides: a point of the sphere in four
 * dimensions, without its fourth coordinate. */
static double point_in_ball(const double point[2], double w) {
  double left = 1.0 - (point[0] * point[0] + point[1] * point[1]);
  return left > 0.0 ? sqrt(left) * conic_cos(2.0 * CONIC_PI * w) : 0.0;
}

conic_status conic_sample_place(conic_context *context, const conic_camera *camera, const conic_aperture *aperture,
                                uint64_t index, conic_sample *sample) {
  static const conic_aperture pinhole = {0};
  const conic_aperture *lens = aperture ? aperture : &pinhole;
  if (!sample || !camera || index >= CONIC_MAX_ACCUMULATED)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "sample: no camera, or there is no such sample");
  conic_status status = check_aperture(context, camera, lens);
  if (status != CONIC_OK)
    return status;
  memset(sample, 0, sizeof *sample);
  sample->index = index;
  sample->time = conic_sample_time(index);
  sample->camera = *camera;
  sample->camera.cx += 0.5 - conic_sequence_at(index, CONIC_SEQUENCE_PIXEL);
  sample->camera.cy += 0.5 - conic_sequence_at(index, CONIC_SEQUENCE_PIXEL + 1);
  if (lens->diameter == 0.0)
    return CONIC_OK;
  double point[2], u = conic_sequence_at(index, CONIC_SEQUENCE_LENS),
                   v = conic_sequence_at(index, CONIC_SEQUENCE_LENS + 1);
  if (lens->n_blades)
    point_on_polygon(lens->n_blades, u, v, point);
  else
    conic_disc_point(u, v, point);
  for (int axis = 0; axis < 2; axis++) {
    sample->lens[axis] = 0.5 * lens->diameter * point[axis];
  }
  if (sees_all_around(camera))
    sample->lens_forward =
        0.5 * lens->diameter * point_in_ball(point, conic_sequence_at(index, CONIC_SEQUENCE_LENS_DEPTH));
  if (camera->kind || camera->lens) /* no camera can hold it: gathering moves the eye */
    return CONIC_OK;
  for (int axis = 0; axis < 2; axis++)
    sample->camera.cam_from_world[axis][3] -= sample->lens[axis];
  sample->camera.cx += camera->fx * (sample->lens[0] / lens->focus);
  sample->camera.cy += camera->fy * (sample->lens[1] / lens->focus);
  return CONIC_OK;
}

/* --- on the way --- */

static void eye_of_camera(const conic_camera *camera, double eye[3]) {
  for (int axis = 0; axis < 3; axis++) {
    eye[axis] = 0.0;
    for (int row = 0; row < 3; row++)
      eye[axis] -= camera->cam_from_world[row][axis] * camera->cam_from_world[row][3];
  }
}

static double on_the_way(double from, double to, double part) {
  return from + (to - from) * part;
}

conic_status conic_camera_between(conic_context *context, const conic_camera *from, const conic_camera *to, double part,
                                  conic_camera *camera) {
  double first[4], second[4], q[4], eyes[2][3], eye[3], rows[3][3], cosine = 0.0, square = 0.0;
  if (!from || !to || !camera || from->width != to->width || from->height != to->height || from->kind != to->kind ||
      from->lens != to->lens || !(fabs(part) < 1e6))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "camera: there is no way between cameras of different kinds");
  conic_quaternion_of(from->cam_from_world, first);
  conic_quaternion_of(to->cam_from_world, second);
  for (int i = 0; i < 4; i++)
    cosine += first[i] * second[i];
  for (int i = 0; i < 4; i++) {
    q[i] = on_the_way(first[i], cosine < 0.0 ? -second[i] : second[i], part);
    square += q[i] * q[i];
  }
  if (!(square > 0.0))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "camera: there is no single way between opposite directions");
  for (int i = 0; i < 4; i++)
    q[i] /= sqrt(square);
  eye_of_camera(from, eyes[0]);
  eye_of_camera(to, eyes[1]);
  conic_camera between = *from;
  if (part == 0.0 || part == 1.0) { /* stays, to the bit */
    *camera = part == 0.0 ? *from : *to;
    return CONIC_OK;
  }
  conic_rotation_of(q, rows);
  for (int axis = 0; axis < 3; axis++)
    eye[axis] = on_the_way(eyes[0][axis], eyes[1][axis], part);
  for (int row = 0; row < 3; row++) {
    memcpy(between.cam_from_world[row], rows[row], sizeof rows[row]);
    between.cam_from_world[row][3] = -conic_dot(rows[row], eye);
  }
  between.fx = on_the_way(from->fx, to->fx, part);
  between.fy = on_the_way(from->fy, to->fy, part);
  between.cx = on_the_way(from->cx, to->cx, part);
  between.cy = on_the_way(from->cy, to->cy, part);
  for (int i = 0; i < 8; i++)
    between.distortion[i] = on_the_way(from->distortion[i], to->distortion[i], part);
  *camera = between;
  return CONIC_OK;
}
