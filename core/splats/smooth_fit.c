#include "core/splats/smooth_fit.h"

enum { TERMS = CONIC_PROFILE_SMOOTH_TERMS, NODES = CONIC_SMOOTH_NODES };

/* Of each coefficient, the powers of q and of its part across. */
static const int powers[TERMS][2] = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}, {6, 0}, {0, 1},
                                     {1, 1}, {2, 1}, {3, 1}, {0, 2}, {1, 2}, {2, 2}, {0, 3}, {1, 3}};

static double whole_power(double x, int power) {
  double product = 1.0;
  for (int i = 0; i < power; i++)
    product *= x;
  return product;
}

double conic_smooth_place(int i_place) {
  double v = (double)i_place / (double)(CONIC_SMOOTH_PLACES - 1);
  return v * v * (3.0 - 2.0 * v);
}

static double inner_product(const double *a, const double *b) {
  double sum = 0.0;
  for (int i = 0; i < NODES; i++)
    sum += a[i] * b[i];
  return sum;
}

/* Gram and Schmidt's columns. */
void conic_smooth_fit_begin(const double directions[CONIC_SMOOTH_DIRECTIONS], conic_smooth_fit *fit) {
  for (int term = 0; term < TERMS; term++) {
    double *column = fit->column[term];
    for (int i = 0; i < NODES; i++) {
      double q = conic_smooth_place(i / CONIC_SMOOTH_DIRECTIONS);
      double across = q * directions[i % CONIC_SMOOTH_DIRECTIONS];
      column[i] = whole_power(q, powers[term][0]) * whole_power(across, powers[term][1]);
    }
    for (int before = 0; before < term; before++) {
      double part = inner_product(fit->column[before], column);
      fit->triangle[before][term] = part;
      for (int i = 0; i < NODES; i++)
        column[i] -= part * fit->column[before][i];
    }
    double length = sqrt(inner_product(column, column));
    fit->triangle[term][term] = length;
    for (int i = 0; i < NODES; i++)
      column[i] /= length;
  }
}

void conic_smooth_fit_solve(const conic_smooth_fit *fit, const double values[NODES], double support,
                            float coefficients[TERMS]) {
  double solved[TERMS];
  for (int term = TERMS - 1; term >= 0; term--) {
    double rest = inner_product(fit->column[term], values);
    for (int after = term + 1; after < TERMS; after++)
      rest -= fit->triangle[term][after] * solved[after];
    solved[term] = rest / fit->triangle[term][term];
    coefficients[term] = (float)(solved[term] / whole_power(support, powers[term][0] + powers[term][1]));
  }
}
