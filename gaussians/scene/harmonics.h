/* Real spherical harmonics, with the signs of 3D Gaussian splatting, and what turning does to them. */
#pragma once

#include "conic/gaussians.h"

enum { CONIC_MOST_ORDERS = 2 * CONIC_MAX_SH_DEGREE + 1 };

/* The (degree + 1)² harmonics of a unit direction, lowest degree and order first. */
void conic_harmonics_evaluate(const double direction[3], int degree, double *y);

/* What the coefficients of each degree become where all directions d become R·d, R[row][column] a rotation:
 * new[j] = Σ turn[degree][j][k] old[k]. Elements that are 0, 1 or -1 but for rounding are made so. */
typedef double conic_harmonics_turn[CONIC_MAX_SH_DEGREE + 1][CONIC_MOST_ORDERS][CONIC_MOST_ORDERS];
void conic_harmonics_find_turn(const double rotation[3][3], conic_harmonics_turn turn);

/* Turns one Gaussian's harmonics, as conic_gaussians keeps them. */
void conic_harmonics_apply(conic_harmonics_turn turn, int degree, float *sh);
