/* What is chosen by: of a cluster that is called hidden no face within its cone, anywhere in its sphere, is turned to
 * the eye; and a point that stands for a node is off by its error, and by what its disc sticks out of the sphere. */
#include "lod/hybrid/draw/hybrid_offers.h"
#include "lod/hybrid/model/hybrid_model.h"
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

static void test_hidden(const conic_hybrid_camera *view) {
  uint64_t state = 12;
  int n_hidden = 0, n_front = 0, n_neither = 0;
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
    int is_hidden = conic_hybrid_is_hidden(view, &bound, 0.0), is_front = has_front(&bound, &state);
    CHECK(!is_hidden || !is_front);
    n_hidden += is_hidden;
    n_front += is_front;
    n_neither += !is_hidden && !is_front;
  }
  printf("%d hidden, %d turned to the eye, %d neither\n", n_hidden, n_front, n_neither);
  CHECK(n_hidden > 50 && n_front > 300 && n_neither < 60);
}

static void test_point(const conic_hybrid_camera *view) {
  const double radius = 0.25, error = 0.3;
  for (double distance = 0.3; distance < 5.0; distance *= 1.7) {
    conic_hybrid_node node;
    memset(&node, 0, sizeof node);
    node.bound.center[2] = (float)distance;
    node.bound.radius = node.point.radius = (float)radius;
    node.point.error = (float)error;
    /* Rays that touch the sphere leave its middle by this angle. */
    double disc = distance * tan(asin(radius / distance)), off = error + (disc - radius);
    double unit = conic_hybrid_pixels_a_unit(view, &node.bound, disc - radius);
    double found = conic_hybrid_point_error_px(view, &node);
    CHECK(unit == HUGE_VAL ? found == HUGE_VAL : fabs(found / (off * unit) - 1.0) < 1e-5);
    CHECK((unit == HUGE_VAL) == (distance < 0.4));
  }
}

int main(void) {
  fixture f = fixture_open(1);
  conic_hybrid hybrid;
  conic_hybrid_camera view;
  memset(&hybrid, 0, sizeof hybrid);
  fixture_camera(&f, 1000, 1000, 300.0);
  f.options.cull_back = 1;
  f.options.near_z = 0.01;
  conic_hybrid_camera_init(&hybrid, &f.camera, &f.options, &view);
  test_hidden(&view);
  test_point(&view);
  fixture_close(&f);
  return check_result();
}
