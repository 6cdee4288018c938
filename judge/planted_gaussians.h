/* A Gaussian scene with a mistake in it, drawn at samples alone. */
#ifndef CONIC_PLANTED_GAUSSIANS_H
#define CONIC_PLANTED_GAUSSIANS_H

#include "judge/diagnosis_samples.h"

/* Composites at the samples, before a black background; `samples` × `samples` of each pixel, whose camera is already
 * that of the fine picture. Without a mistake these are the values of conic_gaussians_render. Errors: MEMORY,
 * CANCELLED. */
conic_status conic_planted_gaussians_draw(conic_context *context, const conic_gaussians *gaussians,
                                          const conic_planted *planted, int samples, const conic_diagnosis_samples *at,
                                          conic_channels *values);

#endif
