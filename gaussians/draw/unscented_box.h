/* The box of the unscented transform: docs/reference/gaussians.md, Set-up. */
#pragma once

#include "gaussians/draw/gaussian_outline.h"

/* The mean of the sigma points, and half the size of the box about it. Returns 0 where nothing is drawn. */
int conic_gaussian_unscented_box(const conic_gaussian_view *view, const conic_gaussian_placed *p, double place[2],
                                 double half[2]);
