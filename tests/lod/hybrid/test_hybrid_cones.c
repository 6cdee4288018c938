/* Cones of normals: one that is joined of two holds both, however near their axes are to each other. */
#include "core/base/vectors.h"
#include "lod/hybrid/model/hybrid_model.h"
#include "tests/support/check.h"
#include "tests/support/random_numbers.h"

static void turn(const double from[3], double angle, uint64_t *state, double to[3]) {
  double chance[3], aside[3];
  for (int axis = 0; axis < 3; axis++)
    chance[axis] = 2.0 * random_unit(state) - 1.0;
  conic_cross(from, chance, aside);
  conic_normalize(aside);
  for (int axis = 0; axis < 3; axis++)
    to[axis] = cos(angle) * from[axis] + sin(angle) * aside[axis];
}

static conic_hybrid_bound cone_about(const double axis[3], double angle) {
  conic_hybrid_bound bound = {.radius = 1.0f, .cone = (float)cos(angle)};
  for (int i = 0; i < 3; i++)
    bound.axis[i] = (float)axis[i];
  return bound;
}

/* Whether normals at the edge of a cone are in another. */
static void check_within(const conic_hybrid_bound *both, const conic_hybrid_bound *one, uint64_t *state) {
  double axis[3], normal[3], about[3];
  for (int i = 0; i < 3; i++) {
    axis[i] = (double)one->axis[i];
    about[i] = (double)both->axis[i];
  }
  conic_normalize(axis);
  for (int k = 0; k < 20 && both->cone > -1.0f; k++) {
    turn(axis, acos((double)one->cone), state, normal);
    CHECK(conic_dot(normal, about) >= (double)both->cone - 1e-6);
  }
}

int main(void) {
  uint64_t state = 1;
  size_t n_held = 0;
  for (int i = 0; i < 20000; i++) {
    double axes[2][3], first[3];
    for (int axis = 0; axis < 3; axis++)
      first[axis] = 2.0 * random_unit(&state) - 1.0;
    conic_normalize(first);
    memcpy(axes[0], first, sizeof first);
    turn(first, pow(10.0, -5.0 * random_unit(&state)), &state, axes[1]);
    const conic_hybrid_bound a = cone_about(axes[0], 1.2 * random_unit(&state)),
                             b = cone_about(axes[1], 1.2 * random_unit(&state)), both = conic_hybrid_join(&a, &b);
    n_held += both.cone > -1.0f;
    check_within(&both, &a, &state);
    check_within(&both, &b, &state);
  }
  CHECK(n_held > 10000);
  return check_result();
}
