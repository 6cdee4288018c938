/* The polynomial over the local plane (PSS Eq. 3), by orthogonal columns and never by normal equations. */
#include "surface/surface.h"

/* What must be left of a monomial, as a share of its square, when the ones before it are taken out. */
static const double LEAST_SHARE = 1e-9;

/* How much a sample's error may grow in the value at the origin, squared: where the samples lie to one side, the
 * polynomial is led by what it was not told. */
static const double MOST_GAIN = 4.0;

/* The variance of the value at the origin when every sample has a variance of 1 / weight. */
static double gain_at_origin(int n_coefficients, double upper[CONIC_MAX_COLUMNS][CONIC_MAX_COLUMNS],
                             const double norms2[CONIC_MAX_COLUMNS]) {
  double z[CONIC_MAX_COLUMNS] = {1.0}, gain = 1.0 / norms2[0];
  for (int k = 1; k < n_coefficients; k++) {
    z[k] = 0.0;
    for (int j = 0; j < k; j++)
      z[k] -= z[j] * upper[j][k];
    gain += z[k] * z[k] / norms2[k];
  }
  return gain;
}

conic_surface_outcome conic_surface_fit(const conic_surface *surface, double h, conic_workspace *workspace,
                                        double frame[3][3], double t, conic_fit *fit) {
  double upper[CONIC_MAX_COLUMNS][CONIC_MAX_COLUMNS], norms2[CONIC_MAX_COLUMNS], before2[CONIC_MAX_COLUMNS];
  double coefficients[CONIC_MAX_COLUMNS] = {0.0};
  int n = conic_n_coefficients(surface->options.degree);
  surface->kernels->factor(&workspace->near, frame, t, 1.0 / h, surface->options.degree, upper, norms2, before2);
  for (int k = 0; k < n; k++)
    if (!(norms2[k] > LEAST_SHARE * before2[k]))
      return CONIC_SURFACE_ILL_CONDITIONED;
  if (!(gain_at_origin(n, upper, norms2) <= MOST_GAIN))
    return CONIC_SURFACE_ILL_CONDITIONED;
  for (int j = n; j-- > 0;) {
    coefficients[j] = upper[j][n];
    for (int k = j + 1; k < n; k++)
      coefficients[j] -= upper[j][k] * coefficients[k];
  }
  fit->value = coefficients[0] * h;
  fit->slope[0] = coefficients[1];
  fit->slope[1] = coefficients[2];
  return CONIC_SURFACE_DONE;
}
