/* Emission and absorption along a ray: docs/reference/gaussians.md, Truth. Between the places where a density begins,
 * ends or bends, Gauss's rule of six points; the steps are halved until nothing changes. */
#include "oracle/gaussians/oracle_along.h"

#include <stdlib.h>

#include "oracle/oracle_math.h"

#define ROOT_OF_TWO 1.4142135623730950488
#define ONE_OVER_ROOT_OF_TWO_PI 0.39894228040143267794
#define TWO_OVER_ROOT_OF_PI 1.1283791670955125739

enum { REACH = 8, MOST_HALVINGS = 6 };

/* Its series in e^(−x²), all of whose terms have one sign; from 6 on it is 1 to the last bit. */
double conic_oracle_erf(double x) {
  double size = fabs(x), term = size, sum = size;
  if (size >= 6.0)
    return x < 0.0 ? -1.0 : 1.0;
  for (int n = 1; term > 1e-18 * sum; n++) {
    term *= 2.0 * size * size / (2 * n + 1);
    sum += term;
  }
  double value = sum > 0.0 ? TWO_OVER_ROOT_OF_PI * conic_oracle_exp(-size * size) * sum : 0.0;
  return x < 0.0 ? -value : value;
}

static int compare_places_along(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* What is emitted at z and comes to the eye. */
static void emitted(const oracle_cloud *clouds, size_t n, double z, double color[3]) {
  double depth = 0.0, sum[3] = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < n; i++) {
    double u = (z - clouds[i].z) / clouds[i].width;
    if (u < -(REACH + 1.0))
      continue;
    depth += clouds[i].depth * 0.5 * (1.0 + conic_oracle_erf(u / ROOT_OF_TWO));
    if (u > REACH + 1.0)
      continue;
    double density = clouds[i].depth * ONE_OVER_ROOT_OF_TWO_PI / clouds[i].width * conic_oracle_exp(-0.5 * u * u);
    for (int c = 0; c < 3; c++)
      sum[c] += density * clouds[i].color[c];
  }
  double seen = conic_oracle_exp(-depth);
  for (int c = 0; c < 3; c++)
    color[c] = sum[c] * seen;
}

static void add_interval(const oracle_cloud *clouds, size_t n, double from, double to, double color[3]) {
  static const double at[3] = {0.23861918608319690863, 0.66120938646626451366, 0.93246951420315202781};
  static const double weight[3] = {0.46791393457269104739, 0.36076157304813860757, 0.17132449237917034504};
  double middle = 0.5 * (from + to), half = 0.5 * (to - from), here[3];
  for (int k = 0; k < 6; k++) {
    emitted(clouds, n, middle + (k & 1 ? half : -half) * at[k / 2], here);
    for (int c = 0; c < 3; c++)
      color[c] += here[c] * weight[k / 2] * half;
  }
}

double conic_oracle_integrate(const oracle_cloud *clouds, size_t n, double *places, double color[3]) {
  size_t n_places = 0;
  double change = 0.0, before[3] = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < ORACLE_PLACES; k++)
      places[n_places++] =
          clouds[i].z + (k - ORACLE_PLACES / 2) * (2.0 * REACH / (ORACLE_PLACES - 1)) * clouds[i].width;
  qsort(places, n_places, sizeof *places, compare_places_along);
  for (int halving = 0; halving < MOST_HALVINGS; halving++) {
    int n_steps = 1 << halving;
    color[0] = color[1] = color[2] = 0.0;
    for (size_t i = 0; i + 1 < n_places; i++)
      for (int k = 0; k < n_steps; k++) {
        double width = places[i + 1] - places[i];
        if (width > 0.0)
          add_interval(clouds, n, places[i] + width * k / n_steps, places[i] + width * (k + 1) / n_steps, color);
      }
    change = 0.0;
    for (int c = 0; c < 3; c++) {
      change = oracle_max(change, fabs(color[c] - before[c]));
      before[c] = color[c];
    }
    if (halving > 0 && change < 1e-10)
      break;
  }
  return change;
}
