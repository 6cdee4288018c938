/* How deep a picture hides, at several resolutions, so that the least of any rectangle of pixels is found by a few
 * looks.
 */
#pragma once

#include "raster/view/part.h"

enum { CONIC_HORIZON_LEVELS = 16 };

typedef struct conic_horizon {
  int width, height;
  float *pixels; /* inverse depths up to which all is hidden, width × height; the caller raises them */
  int n_levels;
  struct {
    int width, height;
    float *cells; /* the least of 8 × 8 pixels, of 16 × 16, … */
  } levels[CONIC_HORIZON_LEVELS];
} conic_horizon;

/* All zero: nothing is hidden. The caller closes it, on failure too. Errors: MEMORY. */
conic_status conic_horizon_open(conic_context *context, int width, int height, conic_horizon *horizon);
void conic_horizon_close(conic_context *context, conic_horizon *horizon);

/* Makes the levels agree with the pixels. */
void conic_horizon_update(conic_context *context, conic_horizon *horizon);

/* No more than the least of the window's pixels, which are in the picture. */
float conic_horizon_least(const conic_horizon *horizon, const conic_window *window);
