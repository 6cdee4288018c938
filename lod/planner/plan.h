/* Finds the error for which a picture takes no more than a number of primitives: of what can be chosen for any error,
 * as nodes of octrees, places of layered clouds, and clusters of hybrid models are. */
#ifndef CONIC_PLAN_H
#define CONIC_PLAN_H

#include <stdint.h>

typedef struct conic_plan {
  void *data;
  /* Chooses for an error on the screen, in pixels, and returns how many primitives that are; where they are more than
   * `most`, any number above it. `*reached_px` is the error asked for, and may become that of what was chosen. */
  uint64_t (*choose)(void *data, double error_px, uint64_t most, double *reached_px);
} conic_plan;

/* Finds an error above `low_px` for which `budget` primitives are enough, where they are not for the next less that
 * was tried: the least error if the number never grows with it. Returns whether there is any, which is then the error
 * of the last choice. */
int conic_plan_fit(const conic_plan *plan, uint64_t budget, double low_px, double *error_px);

#endif
