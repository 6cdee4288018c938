/* Vectors of three doubles. Sums go from the first component to the last, so that results have the same bits
 * everywhere. */
#pragma once

#include <math.h>
#include <stddef.h>

/* Vector i of those that three arrays hold. */
static inline void conic_vector_at(float *const arrays[3], size_t i, double v[3]) {
  for (int axis = 0; axis < 3; axis++)
    v[axis] = (double)arrays[axis][i];
}

static inline double conic_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* c may be neither a nor b. */
static inline void conic_cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Adds a·bᵀ, where b is a multiple of a: xx, xy, xz, yy, yz, zz. */
static inline void conic_add_outer(double sums[6], const double a[3], const double b[3]) {
  sums[0] += a[0] * b[0];
  sums[1] += a[0] * b[1];
  sums[2] += a[0] * b[2];
  sums[3] += a[1] * b[1];
  sums[4] += a[1] * b[2];
  sums[5] += a[2] * b[2];
}

static inline double conic_length(const double v[3]) {
  return sqrt(conic_dot(v, v));
}

/* aᵀ·M·b of such a matrix. */
static inline double conic_quadratic_form(const double m[6], const double a[3], const double b[3]) {
  return a[0] * (m[0] * b[0] + m[1] * b[1] + m[2] * b[2]) + a[1] * (m[1] * b[0] + m[3] * b[1] + m[4] * b[2]) +
         a[2] * (m[2] * b[0] + m[4] * b[1] + m[5] * b[2]);
}

/* The cosine of the angle between two vectors; −1 where one has no direction. Axes that are kept as floats are not of
 * length 1: beside a cosine near 1, that would be much of the angle. */
static inline double conic_cosine_between(const double a[3], const double b[3]) {
  double lengths = sqrt(conic_dot(a, a) * conic_dot(b, b));
  return lengths > 0.0 ? conic_dot(a, b) / lengths : -1.0;
}

/* The cosine of the sum of two angles, given theirs; −1 where it is more than a half turn. */
static inline double conic_cosine_of_sum(double a, double b) {
  a = a > 1.0 ? 1.0 : a < -1.0 ? -1.0 : a;
  b = b > 1.0 ? 1.0 : b < -1.0 ? -1.0 : b;
  if (a + b <= 0.0) /* over a half turn together: a ≤ cos(π − angle of b) */
    return -1.0;
  return a * b - sqrt((1.0 - a * a) * (1.0 - b * b));
}

static inline void conic_subtract(const double a[3], const double b[3], double difference[3]) {
  for (int axis = 0; axis < 3; axis++)
    difference[axis] = a[axis] - b[axis];
}

/* Widens low and high until they hold what is from `from` to `to`; by what is no number they stay. */
#define CONIC_WIDEN(low, high, from, to)                                                                               \
  ((low) = (from) < (low) ? (from) : (low), (high) = (to) > (high) ? (to) : (high))

/* Widens a box by a place; one of no place is from HUGE_VAL to -HUGE_VAL. */
static inline void conic_widen_box(double low[3], double high[3], const double at[3]) {
  for (int axis = 0; axis < 3; axis++)
    CONIC_WIDEN(low[axis], high[axis], at[axis], at[axis]);
}

/* Makes v a unit vector. Returns 0, with v zero, where it has no direction. */
static inline int conic_normalize(double v[3]) {
  double length = conic_length(v);
  int is_good = length > 0.0 && length - length == 0.0;
  for (int axis = 0; axis < 3; axis++)
    v[axis] = is_good ? v[axis] / length : 0.0;
  return is_good;
}

/* The rows that turn normals where a matrix's turn places: its cofactors. A mirrored mesh has its corners turned round,
 * so its normals change sign, too. Returns whether it is one. */
static inline int conic_normal_rows(const double place[3][4], double rows[3][3]) {
  double determinant = 0.0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const double *a = place[(i + 1) % 3], *b = place[(i + 2) % 3];
      rows[i][j] = a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3];
    }
  for (int j = 0; j < 3; j++)
    determinant += place[0][j] * rows[0][j];
  for (int i = 0; i < 3 && determinant < 0.0; i++)
    for (int j = 0; j < 3; j++)
      rows[i][j] = -rows[i][j];
  return determinant < 0.0;
}

/* The rotation of a unit quaternion, of numbers or of vectors of them. */
#define CONIC_ROTATION_OF(rows, w, x, y, z)                                                                            \
  do {                                                                                                                 \
    (rows)[0][0] = 1.0 - 2.0 * ((y) * (y) + (z) * (z));                                                                \
    (rows)[0][1] = 2.0 * ((x) * (y) - (w) * (z));                                                                      \
    (rows)[0][2] = 2.0 * ((x) * (z) + (w) * (y));                                                                      \
    (rows)[1][0] = 2.0 * ((x) * (y) + (w) * (z));                                                                      \
    (rows)[1][1] = 1.0 - 2.0 * ((x) * (x) + (z) * (z));                                                                \
    (rows)[1][2] = 2.0 * ((y) * (z) - (w) * (x));                                                                      \
    (rows)[2][0] = 2.0 * ((x) * (z) - (w) * (y));                                                                      \
    (rows)[2][1] = 2.0 * ((y) * (z) + (w) * (x));                                                                      \
    (rows)[2][2] = 1.0 - 2.0 * ((x) * (x) + (y) * (y));                                                                \
  } while (0)

static inline void conic_rotation_of(const double quaternion[4], double rows[3][3]) {
  CONIC_ROTATION_OF(rows, quaternion[0], quaternion[1], quaternion[2], quaternion[3]);
}

/* The quaternion w, x, y, z of a rotation's rows, from the largest of the four, so that nothing is divided by a small
 * number (Shepperd 1978). */
static inline void conic_quaternion_of(const double m[3][4], double q[4]) {
  double squares[4] = {m[0][0] + m[1][1] + m[2][2], m[0][0] - m[1][1] - m[2][2], m[1][1] - m[0][0] - m[2][2],
                       m[2][2] - m[0][0] - m[1][1]};
  int largest = 0;
  for (int i = 1; i < 4; i++)
    largest = squares[i] > squares[largest] ? i : largest;
  double root = sqrt(1.0 + squares[largest]), scale = 0.5 / root;
  const double sums[3] = {m[1][2] + m[2][1], m[2][0] + m[0][2], m[0][1] + m[1][0]};
  const double differences[3] = {m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]};
  q[largest] = 0.5 * root;
  for (int i = 0; i < 3; i++) {
    if (largest == 0)
      q[1 + i] = scale * differences[i];
    else if (1 + i != largest)
      q[1 + i] = scale * sums[3 - i - (largest - 1)];
  }
  if (largest > 0)
    q[0] = scale * differences[largest - 1];
}
