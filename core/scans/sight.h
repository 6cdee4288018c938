/* The direction from which a scan's points were seen. */
#pragma once

#include "core/base/vectors.h"

/* In metres: three times the reach of the best terrestrial scanners. Files without the scanner's place have 0 for it,
 * and map coordinates for the points. */
#define CONIC_FARTHEST_SIGHT 20000.0

/* The unit vector from a point towards the scanner; zero where that is too far for a scanner, whose place in the file
 * must then be wrong. */
static inline void conic_sight_find(const double scanner[3], const double point[3], double sight[3]) {
  conic_subtract(scanner, point, sight);
  if (!(conic_length(sight) < CONIC_FARTHEST_SIGHT) || !conic_normalize(sight))
    sight[0] = sight[1] = sight[2] = 0.0;
}
