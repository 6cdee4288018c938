/* The oracle's own arithmetic: double precision, nothing shared with the pipeline. */
#pragma once

#include "core/base/base.h"

/* eˣ; relative error under 1e-15, 0 below -700 and infinite above 709. */
double conic_oracle_exp(double x);

/* ln x for 0 < x < ∞; relative error under 1e-15, near 1 of x − 1's. */
double conic_oracle_log(double x);

/* The inverse of a 3 × 3 matrix by elimination with pivots; 0 where it has none. */
int conic_oracle_invert(const double matrix[3][3], double inverse[3][3]);

/* The value of rank `rank` (from 0) among `values`, which are reordered. */
double conic_oracle_select(double *values, size_t n, size_t rank);

/* Of a picture's pixels, row after row, in n runs of equal length but for one: one pixel of each, always the same. */
void conic_oracle_choose_pixels(uint64_t whole, size_t n, uint32_t *pixels);

static inline double oracle_min(double a, double b) {
  return a < b ? a : b;
}
static inline double oracle_max(double a, double b) {
  return a > b ? a : b;
}
static inline double oracle_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline double oracle_length(const double a[3]) {
  return sqrt(oracle_dot(a, a));
}
static inline void oracle_cross(const double a[3], const double b[3], double result[3]) {
  result[0] = a[1] * b[2] - a[2] * b[1];
  result[1] = a[2] * b[0] - a[0] * b[2];
  result[2] = a[0] * b[1] - a[1] * b[0];
}
static inline int oracle_is_finite(double x) {
  return x - x == 0.0;
}

/* Symmetric 2 × 2 matrices: xx, xy, yy. */
typedef struct oracle_symmetric {
  double xx, xy, yy;
} oracle_symmetric;

static inline double oracle_determinant(oracle_symmetric m) {
  return m.xx * m.yy - m.xy * m.xy;
}
static inline oracle_symmetric oracle_inverse(oracle_symmetric m) {
  double d = oracle_determinant(m);
  return (oracle_symmetric){m.yy / d, -m.xy / d, m.xx / d};
}
static inline double oracle_lesser_eigenvalue(oracle_symmetric m) {
  double mean = 0.5 * (m.xx + m.yy), half = 0.5 * (m.xx - m.yy);
  return oracle_max(mean - sqrt(half * half + m.xy * m.xy), 0.0);
}
static inline double oracle_greater_eigenvalue(oracle_symmetric m) {
  double mean = 0.5 * (m.xx + m.yy), half = 0.5 * (m.xx - m.yy);
  return mean + sqrt(half * half + m.xy * m.xy);
}
static inline double oracle_form(oracle_symmetric m, const double v[2]) {
  return m.xx * v[0] * v[0] + 2.0 * m.xy * v[0] * v[1] + m.yy * v[1] * v[1];
}
static inline void oracle_apply(oracle_symmetric m, const double v[2], double result[2]) {
  double x = m.xx * v[0] + m.xy * v[1], y = m.xy * v[0] + m.yy * v[1];
  result[0] = x;
  result[1] = y;
}
