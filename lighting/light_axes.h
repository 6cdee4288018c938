/* The axes of a camera that looks along a light. */
#pragma once

#include "core/base/vectors.h"

/* Right, down and forward. Forward is opposite to the unit direction towards the light; right is at a right angle to
 * the world's axis that is farthest from the light's direction. */
static inline void conic_light_axes(const double direction[3], double rows[3][3]) {
  int axis = 0;
  double helper[3] = {0.0, 0.0, 0.0};
  for (int i = 1; i < 3; i++)
    if (fabs(direction[i]) < fabs(direction[axis]))
      axis = i;
  helper[axis] = 1.0;
  for (int i = 0; i < 3; i++)
    rows[2][i] = -direction[i];
  conic_cross(helper, rows[2], rows[0]);
  conic_normalize(rows[0]);
  conic_cross(rows[2], rows[0], rows[1]);
}
