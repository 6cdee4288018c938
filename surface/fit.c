/* The polynomial over the local plane (PSS Eq. 3), by orthogonal columns instead of normal equations. */

#include "surface/mls_surface.h"

/* The least share of a monomial's square that must remain when the ones before it are taken out. */
static const double LEAST_SHARE = 1e-9;

/* The most that a sample's error may grow in the value at the origin, squared: where the samples lie to one side, the
 * polynomial follows no data. */
static const double MOST_GAIN = 4.0;

double conic_fit_gain(const conic_fit *fit, int degree, double x, double y) {
  double z[CONIC_MAX_COLUMNS] = {1.0}, gain = 0.0;
  int n = conic_n_coefficients(degree);
  for (int power = 1, first = 1; power <= degree; first += ++power) {
    for (int k = 0; k < power; k++)
      z[first + k] = z[first - power + k] * x;
    z[first + power] = z[first - 1] * y;
  }
  for (int j = 0; j < n; j++) {
    gain += z[j] * z[j] / fit->norms2[j];
    for (int k = j + 1; k < n; k++)
      z[k] -= z[j] * fit->upper[j][k];
  }
  return gain;
}

void conic_fit_solve(conic_fit *fit, int degree) {
  double *c = fit->coefficients;
  int n = conic_n_coefficients(degree);
  for (int j = 0; j < CONIC_MAX_COLUMNS; j++)
    c[j] = 0.0;
  for (int j = n; j-- > 0;) {
    c[j] = fit->upper[j][fit->n_columns];
    for (int k = j + 1; k < n; k++)
      c[j] -= fit->upper[j][k] * c[k];
  }
}

conic_surface_outcome conic_surface_fit(const conic_surface *surface, double h, conic_workspace *workspace,
                                        double frame[3][3], double t, conic_fit *fit) {
  double before2[CONIC_MAX_COLUMNS];
  int n = conic_n_coefficients(surface->options.degree);
  surface->loops.factor(&workspace->near, frame, t, 1.0 / h, surface->options.degree, fit->upper, fit->norms2, before2);
  for (int k = 0; k < n; k++)
    if (!(fit->norms2[k] > LEAST_SHARE * before2[k]))
      return CONIC_SURFACE_ILL_CONDITIONED;
  if (!(conic_fit_gain(fit, surface->options.degree, 0.0, 0.0) <= MOST_GAIN))
    return CONIC_SURFACE_ILL_CONDITIONED;
  fit->n_columns = n;
  conic_fit_solve(fit, surface->options.degree);
  fit->value = fit->coefficients[0] * h;
  fit->slope[0] = fit->coefficients[1];
  fit->slope[1] = fit->coefficients[2];
  for (int axis = 0; axis < 3; axis++)
    fit->foot[axis] = t * frame[2][axis];
  memcpy(fit->frame, frame, sizeof fit->frame);
  return CONIC_SURFACE_DONE;
}
