/* Values at the corners of triangles that fit what is known at places on them, in the sense of least squares. */
#ifndef CONIC_CORNER_FIT_H
#define CONIC_CORNER_FIT_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"

/* Up to three values at a time, that are fitted each by itself. */
typedef struct conic_corner_fit {
  conic_context *context;
  size_t n_triangles, n_unknowns;
  int n_values;
  uint32_t (*unknowns)[3]; /* which a triangle's corners have; the caller's to fill in. None: no such triangle */
  double (*squares)[6];    /* of each triangle: what the system has of its corners 00, 01, 02, 11, 12, 22 */
  double *right[3], *solution;
  double *work; /* four arrays */
} conic_corner_fit;

/* Errors: MEMORY. The caller releases the fit, on failure too. */
conic_status conic_corner_fit_init(conic_context *context, size_t n_triangles, size_t n_unknowns, int n_values,
                                   conic_corner_fit *fit);
void conic_corner_fit_release(conic_corner_fit *fit);

/* At a place the sum of the corners' values times `parts` should be these, `weight` saying by how much it matters. */
void conic_corner_fit_add(conic_corner_fit *fit, size_t triangle, const double parts[3], const double *values,
                          double weight);

/* What is best of one of the values, which is small where nothing is known: fit->solution, until the next is solved. */
void conic_corner_fit_solve(conic_corner_fit *fit, int value);

#endif
