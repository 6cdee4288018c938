/* Draws a Gaussian scene with a mistake, at samples only. */
#ifndef CONIC_PLANTED_GAUSSIANS_H
#define CONIC_PLANTED_GAUSSIANS_H

#include "judge/diagnosis_samples.h"

/* Composites at the samples, before a black background, with `samples` × `samples` samples a pixel; the camera is the
 * fine picture's already. Without a mistake these are the values of conic_gaussians_render. Errors: MEMORY,
 * CANCELLED. */
conic_status conic_planted_gaussians_draw(conic_context *context, const conic_gaussians *gaussians,
                                          const conic_planted *planted, int samples, const conic_diagnosis_samples *at,
                                          conic_channels *values);

#endif
