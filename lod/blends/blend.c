/* Moments of Gaussians. */

#include "lod/blends/blend.h"

#include "core/base/eigen.h"
#include "core/base/gaussian.h"
#include "core/base/power.h"
#include "core/base/vectors.h"
#include "gaussians/scene/harmonics.h"

/* Of merged rows so many bits of 24 are kept, as they are no truth to the last one, and files become smaller. */
static const uint32_t dropped_bits = 0x7ff;

/* A float of a merged row, rounded to nearest. */
float conic_blend_rounded(double value) {
  return conic_float_of_bits((conic_bits_of_float((float)value) + (dropped_bits + 1) / 2) & ~dropped_bits);
}

/* |Σ|^½ of an ellipsoid's projection is 1 / π of the area; its mean over directions is a quarter of the surface, here
 * by the mean of the squares. */
static double mean_area(const double s2[3]) {
  return sqrt((s2[0] * s2[1] + s2[0] * s2[2] + s2[1] * s2[2]) / 3.0);
}

/* The optical depth at the middle; that of what is opaque is not without end. */
static double depth_of(double opacity) {
  return -conic_logarithm(1.0 - fmin(opacity, 0.99));
}

void conic_blend_take(const float *row, int sh_degree, conic_blend *blend) {
  double q[4], rows[3][3], s2[3], length = 0.0, sum = 0.0;
  const size_t n = conic_harmonics_of_degree(sh_degree);
  memset(blend, 0, sizeof *blend);
  blend->row = row;
  for (size_t i = 0; i < CONIC_BLEND_HARMONICS + n; i++)
    sum += (double)row[i] * 0.0;
  for (int k = 0; k < 4; k++)
    length += (double)row[CONIC_BLEND_ROTATION + k] * (double)row[CONIC_BLEND_ROTATION + k];
  blend->is_drawn = sum == 0.0 && length > 0.0 && row[3] >= 0.0f && row[4] >= 0.0f && row[5] >= 0.0f &&
                    row[CONIC_BLEND_OPACITY] >= 0.0f;
  for (int axis = 0; axis < 3; axis++)
    blend->mean[axis] = conic_is_finite((double)row[axis]) ? (double)row[axis] : 0.0;
  if (!blend->is_drawn)
    return;
  for (int k = 0; k < 4; k++)
    q[k] = (double)row[CONIC_BLEND_ROTATION + k] / sqrt(length);
  conic_rotation_of(q, rows);
  for (int k = 0; k < 3; k++) {
    const double axis[3] = {rows[0][k], rows[1][k], rows[2][k]}, s = (double)row[CONIC_BLEND_SCALE + k];
    s2[k] = s * s;
    const double scaled[3] = {axis[0] * s2[k], axis[1] * s2[k], axis[2] * s2[k]};
    conic_add_outer(blend->covariance, axis, scaled);
  }
  blend->area = mean_area(s2);
  for (int c = 0; c < 3; c++)
    blend->color[c] = fmax(0.0, 0.5 + CONIC_SH_CONSTANT * (double)row[CONIC_BLEND_HARMONICS + c]);
  const double depth = depth_of((double)row[CONIC_BLEND_OPACITY]);
  blend->parts = (conic_blend_parts){
      .depth = (float)depth,
      .edge = (float)(depth * sqrt(2.0 / 3.0 * (s2[0] + s2[1] + s2[2]))),
      .reach = CONIC_BLEND_DEVIATIONS * (float)sqrt(fmax(s2[0], fmax(s2[1], s2[2]))),
      .tint = {row[CONIC_BLEND_HARMONICS], row[CONIC_BLEND_HARMONICS + 1], row[CONIC_BLEND_HARMONICS + 2]}};
}

static double weight_of(const conic_blend *part) {
  return part->is_drawn ? (double)part->row[CONIC_BLEND_OPACITY] * part->area + 1e-30 : 0.0;
}

/* Of the parts about their mean, with the parts' own. */
static void find_covariance(const conic_blend *parts, size_t n, const double mean[3], double weight,
                            double covariance[6]) {
  memset(covariance, 0, 6 * sizeof *covariance);
  for (size_t i = 0; i < n; i++) {
    const double w = weight_of(&parts[i]) / weight;
    double d[3];
    conic_subtract(parts[i].mean, mean, d);
    const double scaled[3] = {w * d[0], w * d[1], w * d[2]};
    conic_add_outer(covariance, d, scaled);
    for (int k = 0; k < 6; k++)
      covariance[k] += w * parts[i].covariance[k];
  }
}

/* Deviations and rotation; returns the area. */
static double put_shape(const double covariance[6], float *row) {
  double s2[3], axes[3][3], rows[3][3], q[4];
  conic_eigen3(covariance, s2, axes);
  conic_cross(axes[0], axes[1], axes[2]);
  for (int k = 0; k < 3; k++) {
    s2[k] = fmax(s2[k], 0.0);
    row[CONIC_BLEND_SCALE + k] = conic_blend_rounded(sqrt(s2[k]));
    for (int axis = 0; axis < 3; axis++)
      rows[axis][k] = axes[k][axis];
  }
  conic_gaussians_find_quaternion((const double(*)[3])rows, q);
  for (int k = 0; k < 4; k++)
    row[CONIC_BLEND_ROTATION + k] = conic_blend_rounded(q[k]);
  return mean_area(s2);
}

void conic_blend_merge(const conic_blend *parts, size_t n, int sh_degree, float *row) {
  const size_t n_harmonics = conic_harmonics_of_degree(sh_degree);
  double weight = 0.0, depth = 0.0, mean[3] = {0.0, 0.0, 0.0}, harmonics[CONIC_MOST_HARMONICS] = {0.0}, covariance[6];
  for (size_t i = 0; i < n; i++) {
    const double w = weight_of(&parts[i]);
    if (!parts[i].is_drawn)
      continue;
    weight += w;
    depth += depth_of((double)parts[i].row[CONIC_BLEND_OPACITY]) * parts[i].area;
    for (int axis = 0; axis < 3; axis++)
      mean[axis] += w * parts[i].mean[axis];
    for (size_t k = 0; k < n_harmonics; k++)
      harmonics[k] += w * (double)parts[i].row[CONIC_BLEND_HARMONICS + k];
  }
  if (weight == 0.0) { /* no picture shows them, nor this */
    memcpy(row, parts[0].row, (CONIC_BLEND_HARMONICS + n_harmonics) * sizeof *row);
    return;
  }
  for (int axis = 0; axis < 3; axis++) {
    mean[axis] /= weight;
    row[axis] = (float)mean[axis];
  }
  find_covariance(parts, n, mean, weight, covariance);
  const double area = put_shape(covariance, row);
  row[CONIC_BLEND_OPACITY] = area > 0.0 ? conic_blend_rounded(1.0 - conic_gaussian_exp(-depth / area)) : 0.0f;
  for (size_t k = 0; k < n_harmonics; k++)
    row[CONIC_BLEND_HARMONICS + k] = conic_blend_rounded(harmonics[k] / weight);
}

void conic_blend_dilate(const conic_blend_parts *parts, double variance, float *row) {
  double s2[3];
  for (int k = 0; k < 3; k++)
    s2[k] = (double)row[CONIC_BLEND_SCALE + k] * (double)row[CONIC_BLEND_SCALE + k];
  const double own = depth_of((double)row[CONIC_BLEND_OPACITY]) * mean_area(s2), depth = (double)parts->depth;
  /* the square of a mean area is that of what it was, and the trace's and 1 times the variance and its square */
  const double all =
      sqrt(own * own + (double)(parts->edge * parts->edge) * variance + depth * depth * variance * variance);
  for (int k = 0; k < 3; k++)
    s2[k] += variance;
  const double area = mean_area(s2), added = all > own ? 1.0 - own / all : 0.0;
  if (!(area > 0.0))
    return;
  row[CONIC_BLEND_OPACITY] = (float)(1.0 - conic_gaussian_exp(-all / area));
  for (int c = 0; c < 3; c++) {
    float *color = &row[CONIC_BLEND_HARMONICS + c];
    *color += (float)added * (parts->tint[c] - *color);
  }
}
