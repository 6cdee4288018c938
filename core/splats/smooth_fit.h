/* The smooth part of a kernel's profile as a polynomial of q and of q's part across, by least squares
 * (docs/reference/picture.md, Profile). */
#ifndef CONIC_SMOOTH_FIT_H
#define CONIC_SMOOTH_FIT_H

#include "core/splats/profile.h"

/* It is fitted at so many q and directions. */
enum { CONIC_SMOOTH_PLACES = 9, CONIC_SMOOTH_DIRECTIONS = 5 };
enum { CONIC_SMOOTH_NODES = CONIC_SMOOTH_PLACES * CONIC_SMOOTH_DIRECTIONS };

/* The polynomials' values at the nodes, as orthogonal columns times a triangle. */
typedef struct conic_smooth_fit {
  double column[CONIC_PROFILE_SMOOTH_TERMS][CONIC_SMOOTH_NODES];
  double triangle[CONIC_PROFILE_SMOOTH_TERMS][CONIC_PROFILE_SMOOTH_TERMS];
} conic_smooth_fit;

/* Over the support: 0 to 1. */
double conic_smooth_place(int i_place);

void conic_smooth_fit_begin(const double directions[CONIC_SMOOTH_DIRECTIONS], conic_smooth_fit *fit);

/* Finds the coefficients of the polynomial from its values, place by place. q ends at the support. */
void conic_smooth_fit_solve(const conic_smooth_fit *fit, const double values[CONIC_SMOOTH_NODES], double support,
                            float coefficients[CONIC_PROFILE_SMOOTH_TERMS]);

#endif
