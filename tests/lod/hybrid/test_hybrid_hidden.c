/* What is called hidden is: of a cluster that a back side hides, no face within its cone, anywhere in its sphere, is
 * turned to the eye. */
#include "lod/hybrid/hybrid_choose.h"
#include "lod/hybrid/hybrid_model.h"
#include "tests/support/fixture.h"

static const double pi = 3.14159265358979323846;

static void any_direction(uint64_t *state, double d[3]) {
  double z = 2.0 * fixture_random(state) - 1.0, angle = 2.0 * pi * fixture_random(state), r = sqrt(1.0 - z * z);
  d[0] = r * cos(angle);
  d[1] = r * sin(angle);
  d[2] = z;
}

/* Whether a face is turned to the eye, which is the origin: of many directions on the cone's border, at many places on
 * the sphere. */
static int has_front(const conic_hybrid_bound *bound, uint64_t *state) {
  const double axis[3] = {(double)bound->axis[0], (double)bound->axis[1], (double)bound->axis[2]};
  double cosine = (double)bound->cone, sine = sqrt(1.0 - cosine * cosine);
  for (int i = 0; i < 2000; i++) {
    double place[3], side[3], along = 0.0, length2 = 0.0, facing = 0.0;
    any_direction(state, place);
    any_direction(state, side);
    for (int k = 0; k < 3; k++)
      along += side[k] * axis[k];
    for (int k = 0; k < 3; k++) {
      side[k] -= along * axis[k];
      length2 += side[k] * side[k];
    }
    for (int k = 0; k < 3; k++) {
      double normal = cosine * axis[k] + sine * side[k] / sqrt(length2);
      facing += normal * ((double)bound->center[k] + (double)bound->radius * place[k]);
    }
    if (facing < 0.0)
      return 1;
  }
  return 0;
}

int main(void) {
  fixture f = fixture_open(1);
  conic_hybrid hybrid;
  conic_hybrid_camera view;
  uint64_t state = 12;
  int n_hidden = 0, n_front = 0, n_neither = 0;
  memset(&hybrid, 0, sizeof hybrid);
  fixture_camera(&f, 1000, 1000, 300.0);
  f.options.cull_back = 1;
  f.options.near_z = 0.01;
  conic_hybrid_camera_init(&hybrid, &f.camera, &f.options, &view);
  for (int i = 0; i < 1000; i++) {
    conic_hybrid_bound bound;
    double axis[3];
    memset(&bound, 0, sizeof bound);
    any_direction(&state, axis);
    for (int k = 0; k < 3; k++) {
      bound.center[k] = (float)(k == 2 ? 1.5 + fixture_random(&state) : fixture_random(&state) - 0.5);
      bound.axis[k] = (float)axis[k];
    }
    bound.radius = (float)fixture_random(&state);
    bound.cone = (float)(0.3 + 0.7 * fixture_random(&state));
    int is_hidden = conic_hybrid_is_hidden(&view, &bound, 0.0), is_front = has_front(&bound, &state);
    CHECK(!is_hidden || !is_front);
    n_hidden += is_hidden;
    n_front += is_front;
    n_neither += !is_hidden && !is_front;
  }
  printf("%d hidden, %d turned to the eye, %d neither\n", n_hidden, n_front, n_neither);
  CHECK(n_hidden > 50 && n_front > 300 && n_neither < 60);
  fixture_close(&f);
  return check_result();
}
