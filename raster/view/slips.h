/* Mistakes that a renderer of splats may make, on purpose: for whoever wants to know whether another one made them. */
#pragma once

#include "conic/render.h"

typedef enum conic_slip {
  CONIC_SLIP_AMPLITUDE = 1, /* weights are not lowered by as much as the prefilter widens splats */
  CONIC_SLIP_EPSILON = 2    /* ε is taken along the camera's axis in place of the ray */
} conic_slip;

/* Lets the renderer make them, as bits, until it is told otherwise. */
void conic_renderer_slip(conic_renderer *renderer, unsigned slips);
