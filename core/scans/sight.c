#include "core/scans/sight.h"

#include "core/base/vectors.h"

/* In metres: three times the reach of the best terrestrial scanners. Files without the scanner's place have 0 for it,
 * and map coordinates for the points. */
static const double farthest = 20000.0;

void conic_sight_find(const double scanner[3], const double point[3], double sight[3]) {
  conic_subtract(scanner, point, sight);
  if (!(conic_length(sight) < farthest) || !conic_normalize(sight))
    sight[0] = sight[1] = sight[2] = 0.0;
}
