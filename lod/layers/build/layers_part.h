/* How far what full resolution draws is from the discs that stand for it, found by holding discs against discs. */
#ifndef CONIC_LAYERS_PART_H
#define CONIC_LAYERS_PART_H

#include "lod/layers/build/layers_thin.h"

/* A sample as it is drawn; lengths in steps of the grid. */
typedef struct conic_layers_disc {
  float center[3], normal[3], radius;
} conic_layers_disc;

/* Those of the points that a thinner has chosen, in the order in which they were; several threads may look. */
typedef struct conic_layers_standing {
  const conic_thinner *thinner;
  const conic_layers_disc *discs;
} conic_layers_standing;

/* How far what the n discs stand for is at most from those standing: they themselves, and `beyond` as they are off
 * already; `part` where that is more. It is a bound where one disc holds all of another; else it is measured at the
 * middle and 16 places around. The greatest of several is the same in whichever order they come. */
double conic_layers_part(const conic_layers_standing *standing, const conic_layers_disc *discs, size_t n, double beyond,
                         double part);

#endif
