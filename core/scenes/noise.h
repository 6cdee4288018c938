/* Gradient noise in the plane, smooth to its second derivatives, which it also gives. */
#pragma once

#include <stdint.h>

/* A function's value and derivatives at a place. */
typedef struct conic_jet {
  double value;
  double gradient[2];
  double xx, xy, yy; /* second derivatives */
} conic_jet;

/* About -0.7 to 0.7, zero where x and y are whole; features are about one unit wide. Each seed gives another noise.
 * |x|, |y| < 2³¹. */
void conic_noise(uint64_t seed, double x, double y, conic_jet *jet);
