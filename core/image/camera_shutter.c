#include "core/image/camera_shutter.h"

#include "core/base/base.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"

CONIC_DEFINE_NAMES(conic_shutter_name, conic_shutter, CONIC_N_SHUTTERS, "global", "top-to-bottom", "left-to-right",
                   "bottom-to-top", "right-to-left")

static void take_turn(const conic_camera *camera, conic_camera_shutter *s) {
  const double length = conic_length(camera->turn), part = length < 1.0 ? length : 1.0;
  s->angle = 2.0 * conic_angle(part, sqrt(1.0 - part * part));
  for (int i = 0; i < 3; i++)
    s->axis[i] = length > 0.0 ? camera->turn[i] / length : i == 2;
}

static void find_turn(const conic_camera_shutter *s, double share, double turn[3][3]) {
  const double sine = conic_sin(0.5 * share * s->angle);
  conic_rotation_of(
      (const double[4]){conic_cos(0.5 * share * s->angle), sine * s->axis[0], sine * s->axis[1], sine * s->axis[2]},
      turn);
}

/* The pose at a share from the begin on. */
static void pose_from_begin(const conic_camera *camera, double share, double pose[3][4]) {
  conic_camera_shutter s;
  double turn[3][3];
  take_turn(camera, &s);
  find_turn(&s, share, turn);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++)
      pose[i][j] = turn[i][0] * camera->cam_from_world[0][j] + turn[i][1] * camera->cam_from_world[1][j] +
                   turn[i][2] * camera->cam_from_world[2][j];
    pose[i][3] = camera->cam_from_world[i][3] + share * camera->shift[i];
  }
}

void conic_camera_shutter_middle(const conic_camera *camera, conic_camera *middle) {
  double pose[3][4];
  *middle = *camera;
  if (!camera->shutter)
    return;
  pose_from_begin(camera, 0.5, pose);
  memcpy(middle->cam_from_world, pose, sizeof pose);
}

void conic_camera_shutter_end(const conic_camera *camera, double cam_from_world[3][4]) {
  pose_from_begin(camera, 1.0, cam_from_world);
}

void conic_camera_shutter_eye(const conic_camera *camera, double eye[3]) {
  double poses[2][3][4];
  memcpy(poses[0], camera->cam_from_world, sizeof poses[0]);
  pose_from_begin(camera, 1.0, poses[1]);
  for (int axis = 0; axis < 3; axis++) {
    eye[axis] = 0.0;
    for (int row = 0; row < 6; row++)
      eye[axis] -= 0.5 * (poses[row / 3][row % 3][axis] * poses[row / 3][row % 3][3]);
  }
}

void conic_camera_shutter_init(const conic_camera *middle, conic_camera_shutter *s) {
  const int is_across =
      middle->shutter == CONIC_SHUTTER_LEFT_TO_RIGHT || middle->shutter == CONIC_SHUTTER_RIGHT_TO_LEFT;
  *s = (conic_camera_shutter){.way = middle->shutter, .n = is_across ? middle->width : middle->height};
  take_turn(middle, s);
  memcpy(s->shift, middle->shift, sizeof s->shift);
  for (int i = 0; i < 3; i++)
    s->translation[i] = middle->cam_from_world[i][3];
}

double conic_camera_shutter_share(const conic_camera_shutter *s, const double place[2]) {
  const int is_across = s->way == CONIC_SHUTTER_LEFT_TO_RIGHT || s->way == CONIC_SHUTTER_RIGHT_TO_LEFT;
  const double given = place[!is_across], at = given > -1e15 && given < 1e15 ? given : given < 0.0 ? -1e15 : 1e15;
  const double whole = (double)(int64_t)at;
  if (s->way == CONIC_SHUTTER_TOP_TO_BOTTOM || s->way == CONIC_SHUTTER_LEFT_TO_RIGHT)
    return (whole - (whole > at)) / (s->n - 1) - 0.5;
  return (s->n - (whole + (whole < at))) / (s->n - 1) - 0.5;
}

void conic_camera_shutter_pose(const conic_camera_shutter *s, double share, double turn[3][3], double moved[3]) {
  find_turn(s, share, turn);
  for (int i = 0; i < 3; i++)
    moved[i] = s->translation[i] - conic_dot(turn[i], s->translation) + share * s->shift[i];
}

/* The quaternion of a rotation, whose w is not below 0: its largest component first. */
static void quaternion_of(const double r[3][3], double q[4]) {
  const double squares[4] = {1.0 + r[0][0] + r[1][1] + r[2][2], 1.0 + r[0][0] - r[1][1] - r[2][2],
                             1.0 - r[0][0] + r[1][1] - r[2][2], 1.0 - r[0][0] - r[1][1] + r[2][2]};
  int most = 0;
  for (int i = 1; i < 4; i++)
    most = squares[i] > squares[most] ? i : most;
  const double sums[4][4] = {
      {squares[0], r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]},
      {r[2][1] - r[1][2], squares[1], r[1][0] + r[0][1], r[0][2] + r[2][0]},
      {r[0][2] - r[2][0], r[1][0] + r[0][1], squares[2], r[2][1] + r[1][2]},
      {r[1][0] - r[0][1], r[0][2] + r[2][0], r[2][1] + r[1][2], squares[3]},
  };
  double length = 0.0;
  for (int i = 0; i < 4; i++)
    length += sums[most][i] * sums[most][i];
  for (int i = 0; i < 4; i++)
    q[i] = sums[most][i] / (sums[most][0] < 0.0 ? -sqrt(length) : sqrt(length));
}

void conic_camera_shutter_between(const conic_camera *end, conic_camera *camera) {
  double turn[3][3], q[4];
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++)
      turn[i][j] = conic_dot(end->cam_from_world[i], camera->cam_from_world[j]);
    camera->shift[i] = end->cam_from_world[i][3] - camera->cam_from_world[i][3];
  }
  quaternion_of((const double(*)[3])turn, q);
  memcpy(camera->turn, q + 1, sizeof camera->turn);
}
