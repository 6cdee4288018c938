/* Frames, and scenes turned from one to another. */

#include "core/base/vectors.h"
#include "gaussians/scene/activation.h"
#include "gaussians/scene/gaussian_set.h"
#include "gaussians/scene/harmonics.h"

/* Column i is where axis i of a frame points, in one whose axes are right, up and back. */
static int find_frame_axes(const char *frame, double axes[3][3]) {
  static const char letters[] = "rludbf"; /* right, left; up, down; back, front */
  int is_taken[3] = {0, 0, 0};
  memset(axes, 0, 9 * sizeof(double));
  for (int i = 0; i < 3; i++) {
    const char *letter = frame[i] ? strchr(letters, frame[i]) : NULL;
    if (!letter || is_taken[(letter - letters) / 2]++)
      return 0;
    axes[(letter - letters) / 2][i] = (letter - letters) % 2 ? -1.0 : 1.0;
  }
  return frame[3] == 0;
}

int conic_frame_is_one(const char *frame) {
  double axes[3][3];
  return find_frame_axes(frame, axes);
}

int conic_gaussians_find_turn(const char *from, const char *to, double rotation[3][3]) {
  double a[3][3], b[3][3], *r = rotation[0];
  if (!find_frame_axes(from, a) || !find_frame_axes(to, b))
    return 0;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      rotation[i][k] = b[0][i] * a[0][k] + b[1][i] * a[1][k] + b[2][i] * a[2][k];
  return r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) + r[2] * (r[3] * r[7] - r[4] * r[6]) >
         0.0;
}

void conic_gaussians_find_quaternion(const double r[3][3], double q[4]) {
  const double products[4][4] = {
      {1.0 + r[0][0] + r[1][1] + r[2][2], r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]},
      {r[2][1] - r[1][2], 1.0 + r[0][0] - r[1][1] - r[2][2], r[0][1] + r[1][0], r[2][0] + r[0][2]},
      {r[0][2] - r[2][0], r[0][1] + r[1][0], 1.0 - r[0][0] + r[1][1] - r[2][2], r[1][2] + r[2][1]},
      {r[1][0] - r[0][1], r[2][0] + r[0][2], r[1][2] + r[2][1], 1.0 - r[0][0] - r[1][1] + r[2][2]},
  }; /* 4 q[i] q[k] */
  int largest = 0;
  for (int i = 1; i < 4; i++)
    largest = products[i][i] > products[largest][largest] ? i : largest;
  for (int i = 0; i < 4; i++)
    q[i] = products[largest][i] / (2.0 * sqrt(products[largest][largest]));
}

enum { BLOCK = 4096 };

typedef struct turner {
  conic_gaussians *gaussians;
  const double (*rotation)[3];
  double quaternion[4], flips[4];
  int is_flip;
  conic_harmonics_turn harmonics;
} turner;

/* Σ factors[i] values[i] without the terms whose factor is 0, so that signs and exchanges round nothing, and keep NaN
 * and -0 where they were. */
static float sum_terms(const double *factors, const double *values, int n) {
  double sum = 0.0;
  int is_begun = 0;
  for (int i = 0; i < n; i++)
    if (factors[i] != 0.0) {
      sum = is_begun ? sum + factors[i] * values[i] : factors[i] * values[i];
      is_begun = 1;
    }
  return (float)sum;
}

/* Where axes only change signs, those of a Gaussian may as well, which stand for the same: its quaternion then stays
 * near what it was, and is the one that other programs write. Returns 0 where they do more. */
static int find_flips(const double r[3][3], double flips[4]) {
  flips[0] = 1.0;
  for (int i = 0; i < 3; i++) {
    flips[1 + i] = r[(i + 1) % 3][(i + 1) % 3] * r[(i + 2) % 3][(i + 2) % 3];
    if (fabs(flips[1 + i]) != 1.0)
      return 0;
  }
  return 1;
}

/* The product of two quaternions: the units i and k make unit i ^ k, of that sign. */
static void turn_quaternion(const double by[4], float *const rotation[4], size_t i_gaussian) {
  static const int signs[4][4] = {{1, 1, 1, 1}, {1, -1, 1, -1}, {1, -1, -1, 1}, {1, 1, -1, -1}};
  double values[4];
  float turned[4];
  for (int k = 0; k < 4; k++) {
    for (int i = 0; i < 4; i++)
      values[i] = signs[i][i ^ k] * (double)rotation[i ^ k][i_gaussian];
    turned[k] = sum_terms(by, values, 4);
  }
  for (int k = 0; k < 4; k++)
    rotation[k][i_gaussian] = turned[k];
}

static void turn_block(void *data, size_t i_block) {
  turner *self = data;
  conic_gaussians *gaussians = self->gaussians;
  size_t first = i_block * BLOCK, left = gaussians->count - first, end = first + (left < BLOCK ? left : BLOCK);
  size_t n = conic_harmonics_of_degree(gaussians->sh_degree);
  float room[CONIC_MOST_HARMONICS];
  for (size_t i = first; i < end; i++) {
    double mean[3];
    conic_vector_at(gaussians->position, i, mean);
    for (int axis = 0; axis < 3; axis++)
      gaussians->position[axis][i] = sum_terms(self->rotation[axis], mean, 3);
    for (int k = 0; self->is_flip && k < 4; k++)
      gaussians->rotation[k][i] *= (float)self->flips[k];
    if (!self->is_flip)
      turn_quaternion(self->quaternion, gaussians->rotation, i);
    if (gaussians->sh_degree == 0)
      continue;
    if (gaussians->sh) {
      conic_harmonics_apply(self->harmonics, gaussians->sh_degree, gaussians->sh + i * n);
      continue;
    }
    conic_gaussians_harmonics(gaussians, i, room);
    conic_harmonics_apply(self->harmonics, gaussians->sh_degree, room);
    for (size_t k = 0; k < n; k++)
      gaussians->sh_half[i * n + k] = conic_half_of_float(room[k]);
  }
}

void conic_gaussians_rotate(conic_context *context, conic_gaussians *gaussians, const double rotation[3][3]) {
  turner self = {.gaussians = gaussians, .rotation = rotation};
  double origin[3];
  conic_gaussians_find_quaternion(rotation, self.quaternion);
  self.is_flip = find_flips(rotation, self.flips);
  conic_harmonics_find_turn(rotation, self.harmonics);
  memcpy(origin, gaussians->origin, sizeof origin);
  for (int axis = 0; axis < 3; axis++)
    gaussians->origin[axis] = conic_dot(rotation[axis], origin);
  const double up[3] = {(double)gaussians->up[0], (double)gaussians->up[1], (double)gaussians->up[2]};
  for (int axis = 0; axis < 3; axis++)
    gaussians->up[axis] = sum_terms(rotation[axis], up, 3);
  conic_parallel_for(context, (gaussians->count + BLOCK - 1) / BLOCK, turn_block, &self);
}

void conic_gaussians_shift(conic_gaussians *gaussians, double scale, const double shift[3]) {
  for (int axis = 0; axis < 3; axis++) {
    gaussians->origin[axis] = gaussians->origin[axis] * scale + shift[axis];
    for (size_t i = 0; scale != 1.0 && i < gaussians->count; i++) {
      gaussians->position[axis][i] = (float)((double)gaussians->position[axis][i] * scale);
      if (gaussians->scale[axis])
        gaussians->scale[axis][i] = (float)((double)gaussians->scale[axis][i] * scale);
      if (gaussians->scale[axis] && gaussians->log_scale[axis])
        gaussians->log_scale[axis][i] = conic_log_of_scale(gaussians->scale[axis][i]);
    }
  }
}

void conic_gaussians_find_up(const conic_gaussians *gaussians, double up[3]) {
  const char *frame = gaussians->frame;
  for (int axis = 0; axis < 3; axis++)
    up[axis] = (double)gaussians->up[axis];
  if (!conic_normalize(up))
    for (int axis = 0; axis < 3; axis++)
      up[axis] = frame[axis] == 'u' ? 1.0 : frame[axis] == 'd' ? -1.0 : 0.0;
}

conic_status conic_gaussians_turn(conic_context *context, conic_gaussians *gaussians, const char *frame) {
  double rotation[3][3];
  if (!conic_gaussians_find_turn(gaussians->frame, frame, rotation))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "'%s' is no frame, or a mirror image of '%s'", frame,
                      gaussians->frame);
  if (memcmp(gaussians->frame, frame, sizeof gaussians->frame) != 0)
    conic_gaussians_rotate(context, gaussians, rotation);
  memcpy(gaussians->frame, frame, sizeof gaussians->frame);
  return CONIC_OK;
}
