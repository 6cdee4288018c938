/* Points whose x and y are degrees of longitude and latitude, beside heights in metres: drawn as they stand they are a
 * needle. */
#pragma once

#include "conic/splats.h"

/* Whether the points' coordinates can be nothing else: in range, far more of height than of ground, and far from where
 * the two scales begin. */
int conic_points_are_degrees(const conic_splats *points);

/* Makes metres of them, to the east and to the north of the middle of their box, on the WGS 84 ellipsoid: true there,
 * and within a thousandth of that over a degree. `middle` is its longitude and latitude. */
void conic_points_take_metres(conic_splats *points, double middle[2]);
