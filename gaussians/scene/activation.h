/* Scales and opacities as they are used, and as 3D Gaussian splatting trains and keeps them: ln s, logit o. */
#pragma once

#include "conic/gaussians.h"

/* e^x as a float, with the same bits on every machine; NaN stays NaN. */
float conic_scale_of_log(float log_scale);
/* 1 / (1 + e^-x). */
float conic_opacity_of_logit(float logit);

/* Their inverses, rounded to float. 0 and 1 have finite ones which give them back; what has none (a negative scale, an
 * opacity beyond 1) is NaN. */
float conic_log_of_scale(float scale);
float conic_logit_of_opacity(float opacity);

/* Of n Gaussians, makes scales of the logarithms, and opacities of the logits, that a reader has put in their places;
 * keeps these where the set has arrays for them. */
void conic_gaussians_activate(conic_gaussians *gaussians, size_t first, size_t n);
