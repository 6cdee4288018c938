/* A scanned place: a wavy ground of splats, leaves above it that face anywhere, and dots. */
#pragma once

#include "conic/splats.h"
#include "core/base/random.h"
#include "core/splats/ellipse.h"
#include "tests/support/check.h"

enum { CLOUD_SIDE = 48, CLOUD_GROUND = CLOUD_SIDE * CLOUD_SIDE };

static inline double cloud_chance(size_t i, uint64_t k) {
  return (double)(conic_random_bits(i, k, 5) >> 11) * 0x1p-53;
}

/* The ground has a hole of a fifth of its side in its middle where `has_hole`. Its splats reach 1.3 of their distance.
 */
static inline void cloud_fixture(conic_context *context, size_t n_leaves, size_t n_dots, int has_hole,
                                 conic_splats *cloud) {
  const double step = 1.0 / CLOUD_SIDE;
  size_t n = 0;
  CHECK_OK(conic_splats_allocate(context, CLOUD_GROUND + n_leaves + n_dots,
                                 CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_DOTS, cloud));
  for (size_t i = 0; i < cloud->count; i++) {
    int is_ground = i < CLOUD_GROUND;
    double x = ((double)(i % CLOUD_SIDE) + 0.5 * cloud_chance(i, 0)) * step;
    double z = ((double)(i / CLOUD_SIDE) + 0.5 * cloud_chance(i, 1)) * step, u[3], v[3];
    double at[3] = {x, 0.05 * sin(7.0 * x) * sin(5.0 * z), z};
    double normal[3] = {-0.35 * cos(7.0 * x) * sin(5.0 * z), 1.0, -0.25 * sin(7.0 * x) * cos(5.0 * z)};
    if (is_ground && has_hole && fabs(x - 0.5) < 0.1 && fabs(z - 0.5) < 0.1)
      continue;
    for (int axis = 0; axis < 3 && !is_ground; axis++) {
      at[axis] = 0.3 + 0.4 * cloud_chance(i, 2 + (uint64_t)axis);
      normal[axis] = cloud_chance(i, 5 + (uint64_t)axis) - 0.5;
    }
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int axis = 0; axis < 3; axis++)
      normal[axis] /= length;
    conic_tangent_basis(normal, u, v);
    for (int axis = 0; axis < 3; axis++) {
      cloud->position[axis][n] = (float)at[axis];
      cloud->tangent_u[axis][n] = (float)(1.3 * step / 1.5 * u[axis]);
      cloud->tangent_v[axis][n] = (float)(1.3 * step / 1.5 * v[axis]);
      cloud->color[axis][n] = (float)(0.5 + 0.3 * sin(9.0 * at[axis]));
    }
    cloud->dot[n++] = i >= CLOUD_GROUND + n_leaves ? 1.0f : 0.0f;
  }
  cloud->count = n;
}
