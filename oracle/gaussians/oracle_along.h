/* Emission and absorption along a pixel's ray, for the oracle. */
#ifndef CONIC_ORACLE_ALONG_H
#define CONIC_ORACLE_ALONG_H

#include <stddef.h>

/* A Gaussian on the ray: its optical depth, spread as a normal density about z. */
typedef struct oracle_cloud {
  double depth, z, width, color[3];
} oracle_cloud;

/* The error function; absolute error under 1e-15. */
double conic_oracle_erf(double x);

/* ∫ Σ color_i·density_i·exp(−depth up to there) dz over all of the ray. `places` has room for 2·n·ORACLE_PLACES
 * numbers. Returns the change that the last halving of the steps made. */
double conic_oracle_integrate(const oracle_cloud *clouds, size_t n, double *places, double color[3]);

enum { ORACLE_PLACES = 17 };

#endif
