/* Neighbours on a bent sheet, for the sums over them; some lie beyond the reach. */
#pragma once

#include "surface/loops/weight.h"
#include "tests/support/random_numbers.h"

static double bent_sheet_frame[3][3] = {{0.8, 0.0, -0.6}, {0.0, 1.0, 0.0}, {0.6, 0.0, 0.8}};

/* n of them, into arrays that have room for whole eights. */
static inline void bent_sheet_fill(conic_near *near, size_t n, uint64_t seed) {
  near->n = n;
  near->n_padded = (n + 7) / 8 * 8;
  for (size_t i = 0; i < near->n_padded; i++) {
    double x = 4.0 * random_unit(&seed) - 2.0, y = 4.0 * random_unit(&seed) - 2.0;
    double z = 0.1 * (x * x - y) + 0.2 * random_unit(&seed);
    const double place[3] = {x, y, z}, normal[3] = {-0.2 * x, 0.1, 1.0};
    for (int axis = 0; axis < 3; axis++) {
      near->offset[axis][i] = i < n ? place[axis] : 0.0;
      near->normal[axis][i] = i < n ? normal[axis] : 0.0;
    }
    near->mass[i] = i < n ? 1.0 + (double)(i % 3) : 0.0;
    near->inverse_h2[i] = i < n ? 0.8 + 0.1 * random_unit(&seed) : 0.0;
  }
}

static inline conic_weighing bent_sheet_weighing(conic_surface_weight weight, double neglect) {
  return (conic_weighing){weight, neglect * neglect, conic_weight_exp(neglect * neglect)};
}
