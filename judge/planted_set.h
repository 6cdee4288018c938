/* Gaussians as a reader with a mistake reads them. */
#ifndef CONIC_PLANTED_SET_H
#define CONIC_PLANTED_SET_H

#include "conic/gaussians.h"
#include "gaussians/scene/gaussian_set.h"
#include "judge/planted.h"

enum { CONIC_PLANTED_RUN = 256 };

typedef struct conic_planted_run {
  float scale[3][CONIC_PLANTED_RUN], w[CONIC_PLANTED_RUN], opacity[CONIC_PLANTED_RUN];
  float sh[CONIC_PLANTED_RUN * CONIC_MOST_HARMONICS];
} conic_planted_run;

/* Gaussians first … first + n - 1 as their own set, which refers to the scene and to `room`. */
conic_gaussians conic_planted_read(const conic_planted *planted, const conic_gaussians *gaussians, size_t first,
                                   size_t n, conic_planted_run *room);

#endif
