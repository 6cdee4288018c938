/* The smallest ellipse about points of a plane. */
#include "lod/clusters/cluster_sites.h"

/* Each round a point's weight is multiplied by what it wants of the ellipse (Titterington 1978): those on its border
 * come to hold all weight, the points within lose theirs. So many rounds leave a few per cent of the area to win. */
enum { ROUNDS = 8 };

/* For points in a line, the covariance says no more than that. */
static const double flattest = 1e-9;

typedef struct weighing {
  double weights[CONIC_LEAST_ELLIPSE_POINTS];
} weighing;

static void find_moments(const weighing *w, const double (*points)[2], int n_points, double center[2],
                         double covariance[3]) {
  center[0] = center[1] = covariance[0] = covariance[1] = covariance[2] = 0.0;
  for (int i = 0; i < n_points; i++) {
    center[0] += w->weights[i] * points[i][0];
    center[1] += w->weights[i] * points[i][1];
  }
  for (int i = 0; i < n_points; i++) {
    double x = points[i][0] - center[0], y = points[i][1] - center[1];
    covariance[0] += w->weights[i] * x * x;
    covariance[1] += w->weights[i] * x * y;
    covariance[2] += w->weights[i] * y * y;
  }
}

void conic_least_ellipse(const double (*points)[2], int n_points, double center[2], double covariance[3]) {
  weighing w;
  for (int i = 0; i < n_points; i++)
    w.weights[i] = 1.0 / (double)n_points;
  for (int round = 0; round < ROUNDS; round++) {
    find_moments(&w, points, n_points, center, covariance);
    double trace = covariance[0] + covariance[2];
    double determinant = covariance[0] * covariance[2] - covariance[1] * covariance[1];
    if (!(determinant > flattest * trace * trace))
      return;
    for (int i = 0; i < n_points; i++) {
      double x = points[i][0] - center[0], y = points[i][1] - center[1];
      double square = (covariance[2] * x * x - 2.0 * covariance[1] * x * y + covariance[0] * y * y) / determinant;
      w.weights[i] *= (1.0 + square) / 3.0; /* their sum stays 1 */
    }
  }
  find_moments(&w, points, n_points, center, covariance);
}
