/* The filter of `exact`: a Gaussian as wide as pixels see it. */
#ifndef CONIC_GAUSSIAN_FILTER_H
#define CONIC_GAUSSIAN_FILTER_H

#include "gaussians/draw/gaussian_outline.h"

/* Adds the variance of the view's filter to a Gaussian, across the line of sight at its mean, and makes it as much
 * fainter as it gets wider there. Nothing where the mean is not before the eye. */
void conic_gaussian_filter(const conic_gaussian_view *view, conic_gaussian_placed *p);

#endif
