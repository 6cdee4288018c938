/* Values at the corners of triangles that fit best, by least squares, what is known at places on these. */
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
  uint32_t (*unknowns)[3]; /* of a triangle's corners; the caller fills them in. None: no such triangle */
  double (*squares)[6];    /* of each triangle, the system's entries for its corners 00, 01, 02, 11, 12, 22 */
  double *right[3], *solution;
  double *work; /* four arrays */
} conic_corner_fit;

/* Errors: MEMORY. The caller releases the fit, on failure too. */
conic_status conic_corner_fit_init(conic_context *context, size_t n_triangles, size_t n_unknowns, int n_values,
                                   conic_corner_fit *fit);
void conic_corner_fit_release(conic_corner_fit *fit);

/* Asks that at a place the sum of the corners' values times `parts` be `values`. `weight` says how much it matters. */
void conic_corner_fit_add(conic_corner_fit *fit, size_t triangle, const double parts[3], const double *values,
                          double weight);

/* Finds the best of one of the values: fit->solution, until the next is solved. It is small where nothing is known. */
void conic_corner_fit_solve(conic_corner_fit *fit, int value);

#endif
