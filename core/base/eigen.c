#include "core/base/eigen.h"

#include <math.h>

void conic_eigen2(double xx, double xy, double yy, double values[2], double major[2]) {
  double middle = 0.5 * (xx + yy), half_difference = 0.5 * (xx - yy);
  double radius = sqrt(half_difference * half_difference + xy * xy);
  values[0] = middle + radius;
  values[1] = middle - radius;
  /* Take the row whose vector does not cancel. */
  double x = half_difference >= 0.0 ? half_difference + radius : xy;
  double y = half_difference >= 0.0 ? xy : radius - half_difference;
  double length = sqrt(x * x + y * y);
  if (!(length > 0.0)) {
    major[0] = 1.0;
    major[1] = 0.0;
    return;
  }
  double sign = x < 0.0 || (x == 0.0 && y < 0.0) ? -1.0 : 1.0;
  major[0] = sign * x / length;
  major[1] = sign * y / length;
}

/* One Jacobi rotation that makes matrix[p][q] zero; r is the third index. */
static void rotate_pair(double matrix[3][3], double vectors[3][3], int p, int q) {
  if (matrix[p][q] == 0.0)
    return;
  int r = 3 - p - q;
  double theta = (matrix[q][q] - matrix[p][p]) / (2.0 * matrix[p][q]);
  double t = (theta >= 0.0 ? 1.0 : -1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
  double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
  matrix[p][p] -= t * matrix[p][q];
  matrix[q][q] += t * matrix[p][q];
  matrix[p][q] = matrix[q][p] = 0.0;
  double rp = matrix[r][p], rq = matrix[r][q];
  matrix[r][p] = matrix[p][r] = c * rp - s * rq;
  matrix[r][q] = matrix[q][r] = s * rp + c * rq;
  for (int i = 0; i < 3; i++) {
    double vp = vectors[p][i], vq = vectors[q][i];
    vectors[p][i] = c * vp - s * vq;
    vectors[q][i] = s * vp + c * vq;
  }
}

static void swap_pairs(double values[3], double vectors[3][3], int a, int b) {
  double value = values[a];
  values[a] = values[b];
  values[b] = value;
  for (int i = 0; i < 3; i++) {
    double component = vectors[a][i];
    vectors[a][i] = vectors[b][i];
    vectors[b][i] = component;
  }
}

static void settle_sign(double vector[3]) {
  int greatest = 0;
  for (int i = 1; i < 3; i++)
    if (fabs(vector[i]) > fabs(vector[greatest]))
      greatest = i;
  if (vector[greatest] < 0.0)
    for (int i = 0; i < 3; i++)
      vector[i] = -vector[i];
}

void conic_eigen3(const double matrix[6], double values[3], double vectors[3][3]) {
  double m[3][3] = {
      {matrix[0], matrix[1], matrix[2]}, {matrix[1], matrix[3], matrix[4]}, {matrix[2], matrix[4], matrix[5]}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      vectors[i][j] = i == j ? 1.0 : 0.0;
  /* Converges quadratically: after a few sweeps the rest is below the diagonal's last bit. */
  for (int sweep = 0; sweep < 12; sweep++) {
    double off = fabs(m[0][1]) + fabs(m[0][2]) + fabs(m[1][2]);
    double diagonal = fabs(m[0][0]) + fabs(m[1][1]) + fabs(m[2][2]);
    if (!(off > 1e-18 * diagonal))
      break;
    rotate_pair(m, vectors, 0, 1);
    rotate_pair(m, vectors, 0, 2);
    rotate_pair(m, vectors, 1, 2);
  }
  for (int i = 0; i < 3; i++)
    values[i] = m[i][i];
  if (values[0] < values[1])
    swap_pairs(values, vectors, 0, 1);
  if (values[1] < values[2])
    swap_pairs(values, vectors, 1, 2);
  if (values[0] < values[1])
    swap_pairs(values, vectors, 0, 1);
  for (int i = 0; i < 3; i++)
    settle_sign(vectors[i]);
}
