/* The near distance that fits a box: what near_z = 0 stands for. */
#pragma once

#include <math.h>

static inline double conic_near_of_box(const double low[3], const double high[3]) {
  double diagonal_squared = 0.0;
  for (int i = 0; i < 3; i++)
    diagonal_squared += (high[i] - low[i]) * (high[i] - low[i]);
  return diagonal_squared > 0.0 ? 1e-4 * sqrt(diagonal_squared) : 1e-4;
}
