/* A Gaussian's colour by direction, in floats; docs/reference/gaussians.md, Colour. */
#ifndef CONIC_HARMONIC_COLOR_H
#define CONIC_HARMONIC_COLOR_H

#include "conic/gaussians.h"

/* max(0, ½ + Σ sh·Y) seen along `from_eye`, of any length. Returns 0 where it is not finite. */
int conic_harmonic_color(const conic_gaussians *gaussians, size_t i, const double from_eye[3], float color[3]);

#endif
