/* What the readers and writers of Gaussian scenes share about the set itself. */
#pragma once

#include "conic/gaussians.h"
#include "gaussians/scene/half.h"

enum {
  CONIC_MOST_HARMONICS = 3 * (CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1),
  CONIC_MOST_GAUSSIANS = 0x7fffffff
};

#define CONIC_SH_CONSTANT 0.28209479177387814 /* of the harmonic of degree 0 */

/* Numbers of each Gaussian's harmonics: 3 × (degree + 1)². */
static inline size_t conic_harmonics_of_degree(int degree) {
  return 3 * (size_t)(degree + 1) * (size_t)(degree + 1);
}

/* The degree that has so many coefficients a channel, degree 0's included; -1: none. */
int conic_degree_of_coefficients(size_t n);

/* Gaussian i's harmonics, in `room` where they are not kept as floats. */
const float *conic_gaussians_harmonics(const conic_gaussians *gaussians, size_t i, float room[CONIC_MOST_HARMONICS]);

static inline void conic_gaussians_put_harmonic(conic_gaussians *gaussians, size_t i, size_t i_number, float value) {
  size_t at = i * conic_harmonics_of_degree(gaussians->sh_degree) + i_number;
  if (gaussians->sh)
    gaussians->sh[at] = value;
  else
    gaussians->sh_half[at] = conic_half_of_float(value);
}

/* Gaussian i's ln s and logit o: as its file had them where they were kept. */
float conic_gaussians_log_scale(const conic_gaussians *gaussians, int axis, size_t i);
float conic_gaussians_logit(const conic_gaussians *gaussians, size_t i);

static inline double conic_gaussians_mean(const conic_gaussians *gaussians, int axis, size_t i) {
  double mean = (double)gaussians->position[axis][i];
  return gaussians->origin[axis] != 0.0 ? mean + gaussians->origin[axis] : mean; /* adding 0 would turn -0 into 0 */
}

/* The unit vector up: as the file says, or by the frame's letters. */
void conic_gaussians_find_up(const conic_gaussians *gaussians, double up[3]);

/* The rotation from one frame to another; returns 0 where there is none. */
int conic_gaussians_find_turn(const char *from, const char *to, double rotation[3][3]);

/* The arrays of one number a Gaussian that a set has; returns how many. */
enum { CONIC_MOST_GAUSSIAN_COLUMNS = 15 };
int conic_gaussians_list_columns(const conic_gaussians *gaussians, float **columns[CONIC_MOST_GAUSSIAN_COLUMNS]);

/* Moves the arrays of `used` Gaussians into room for `room`. Errors: MEMORY. */
conic_status conic_gaussians_grow(conic_context *context, conic_gaussians *gaussians, size_t used, size_t room);

/* Copies all of `from` to places from `first` on, of a set that has as many scales, and no arrays that `from` lacks.
 * Harmonics of higher degrees are left out, and those that are not there 0. */
void conic_gaussians_put(const conic_gaussians *from, conic_gaussians *to, size_t first);

/* A unit quaternion w, x, y, z of a rotation. */
void conic_gaussians_find_quaternion(const double rotation[3][3], double quaternion[4]);

/* Turns a scene about the origin by a rotation, harmonics too. */
void conic_gaussians_rotate(conic_context *context, conic_gaussians *gaussians, const double rotation[3][3]);

/* Whether a frame's letters say where x, y and z point. */
int conic_frame_is_one(const char *frame);

/* Scales a scene evenly about the origin, and shifts it then. */
void conic_gaussians_shift(conic_gaussians *gaussians, double scale, const double shift[3]);

/* Whether a set that a caller hands in is whole. Errors: ARGUMENT. */
conic_status conic_gaussians_check(conic_context *context, const conic_gaussians *gaussians, const char *name);
