/* The ellipse of a Gaussian on the screen, as profiles change it. */
#pragma once

#include "gaussians/draw/gaussian_footprint.h"

typedef struct conic_screen_variance {
  double c[3], area; /* xx, xy, yy in px², and their determinant */
} conic_screen_variance;

/* The share of its opacity that a Gaussian keeps, of the determinants before and after the dilation. */
double conic_screen_compensation(const conic_profile_row *rules, double bare, double wide);

/* Limits the variances along the axes. The direction of the longer is (xy, λ − xx), λ being its variance before the
 * greatest is looked at. Returns 0 where nothing is drawn. */
int conic_screen_limit_axes(const conic_gaussian_view *view, conic_screen_variance *v);
