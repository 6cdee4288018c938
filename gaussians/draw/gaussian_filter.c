#include "gaussians/draw/gaussian_filter.h"

#include <string.h>

#include "core/base/vectors.h"

enum { COLUMNS = 5, MOST_SWEEPS = 12 };

/* |Σ′|/|Σ′ + hI|, Σ′ the variance on the screen by the Jacobian at the mean. */
static double share_of_area(const conic_gaussian_view *view, const conic_gaussian_placed *p) {
  const double focal[2] = {view->camera->fx, view->camera->fy}, h = view->prefilter;
  double rows[2][3], area[3];
  for (int axis = 0; axis < 2; axis++)
    for (int k = 0; k < 3; k++)
      rows[axis][k] =
          focal[axis] / p->mean[2] * (p->unit[k][axis] - p->mean[axis] / p->mean[2] * p->unit[k][2]) * p->scale[k];
  conic_cross(rows[0], rows[1], area);
  double bare = conic_dot(area, area);
  return bare / (bare + h * (conic_dot(rows[0], rows[0]) + conic_dot(rows[1], rows[1])) + h * h);
}

/* Turns rows i and j of a factor of the variance so that they are at right angles, and the axes with them. Returns 0
 * where they are. */
static int turn_rows(double factor[3][COLUMNS], double axes[3][3], int i, int j) {
  double a = 0.0, b = 0.0, both = 0.0;
  for (int k = 0; k < COLUMNS; k++) {
    a += factor[i][k] * factor[i][k];
    b += factor[j][k] * factor[j][k];
    both += factor[i][k] * factor[j][k];
  }
  if (!(both * both > 1e-30 * a * b))
    return 0;
  double zeta = (b - a) / (2.0 * both), t = (zeta < 0.0 ? -1.0 : 1.0) / (fabs(zeta) + sqrt(1.0 + zeta * zeta));
  double c = 1.0 / sqrt(1.0 + t * t), s = c * t;
  for (int k = 0; k < COLUMNS; k++) {
    double of_i = factor[i][k], of_j = factor[j][k];
    factor[i][k] = c * of_i - s * of_j;
    factor[j][k] = s * of_i + c * of_j;
  }
  for (int k = 0; k < 3; k++) {
    double of_i = axes[i][k], of_j = axes[j][k];
    axes[i][k] = c * of_i - s * of_j;
    axes[j][k] = s * of_i + c * of_j;
  }
  return 1;
}

/* The axes of the variance whose factor this is, the shortest last: Jacobi's method on one side, which keeps the short
 * ones exact, too. */
static void find_filtered_axes(double factor[3][COLUMNS], conic_gaussian_placed *p) {
  double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, lengths[3];
  int is_turned = 1, order[3] = {0, 1, 2};
  for (int sweep = 0; sweep < MOST_SWEEPS && is_turned; sweep++) {
    is_turned = turn_rows(factor, axes, 0, 1);
    is_turned |= turn_rows(factor, axes, 0, 2);
    is_turned |= turn_rows(factor, axes, 1, 2);
  }
  for (int i = 0; i < 3; i++) {
    double squares = 0.0;
    for (int k = 0; k < COLUMNS; k++)
      squares += factor[i][k] * factor[i][k];
    lengths[i] = sqrt(squares);
  }
  for (int i = 0; i < 2; i++)
    if (lengths[order[i]] < lengths[order[2]]) {
      int shorter = order[i];
      order[i] = order[2];
      order[2] = shorter;
    }
  for (int i = 0; i < 3; i++) {
    p->scale[i] = lengths[order[i]];
    memcpy(p->unit[i], axes[order[i]], sizeof p->unit[i]);
  }
}

void conic_gaussian_filter(const conic_gaussian_view *view, conic_gaussian_placed *p) {
  const double z = p->mean[2], deviation = sqrt(view->prefilter);
  double factor[3][COLUMNS] = {{0}};
  if (!(z > 0.0))
    return;
  p->opacity *= sqrt(share_of_area(view, p));
  for (int row = 0; row < 3; row++)
    for (int k = 0; k < 3; k++)
      factor[row][k] = p->unit[k][row] * p->scale[k];
  factor[0][3] = deviation * z / view->camera->fx;
  factor[1][4] = deviation * z / view->camera->fy;
  find_filtered_axes(factor, p);
  p->is_flat = p->scale[2] <= 1e-12 * (p->scale[0] + p->scale[1]);
  if (p->is_flat)
    p->scale[2] = 0.0;
}
