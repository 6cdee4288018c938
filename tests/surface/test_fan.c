/* A point's fan: the triangles with its neighbours on a bend, whatever lies on a sheet above or below. */
#include "surface/fan.h"

#include "tests/support/check.h"

enum { N_AROUND = 6 };

/* The point at the origin, N_AROUND others at distance 1 that lie `bend` below its tangent plane z = 0, and, where
 * `has_sheet`, as many on another sheet right below it, which face the other way where `is_back`. */
static conic_fan fan_of(conic_context *context, double bend, int has_sheet, int is_back) {
  float x[1 + 2 * N_AROUND] = {0}, y[1 + 2 * N_AROUND] = {0}, z[1 + 2 * N_AROUND] = {0};
  float facing[3][1 + 2 * N_AROUND] = {{0}};
  float *const normals[3] = {facing[0], facing[1], facing[2]};
  const float *const positions[3] = {x, y, z};
  const double normal[3] = {0.0, 0.0, 1.0};
  conic_neighbours tree;
  conic_fan fan;
  for (int i = 0; i < 2 * N_AROUND; i++) {
    double angle = 6.283185307179586 * (i + (i < N_AROUND ? 0.0 : 0.5)) / N_AROUND;
    double across = i < N_AROUND ? cos(bend) : is_back ? 0.5 : 0.2;
    x[1 + i] = (float)(across * cos(angle));
    y[1 + i] = (float)(across * sin(angle));
    z[1 + i] = i < N_AROUND ? (float)-sin(bend) : is_back ? -0.1f : -0.4f;
  }
  CHECK_OK(conic_neighbours_build(context, positions, 1 + N_AROUND + (has_sheet ? N_AROUND : 0), &tree));
  for (size_t slot = 0; slot < tree.n_slots; slot++)
    facing[2][slot] = is_back && tree.point_of_slot[slot] > N_AROUND ? -1.0f : 1.0f;
  conic_fan_find(&tree, normals, tree.slot_of_point[0], normal, 1.0, &fan);
  for (int i = 0; i < fan.n; i++)
    for (int k = 0; k < 2; k++)
      fan.pairs[i][k] = tree.point_of_slot[fan.pairs[i][k]];
  conic_neighbours_release(context, &tree);
  return fan;
}

/* Neighbours are laid into the plane at their distance in space: six about a point make six triangles on a bend as on a
 * plane, each with the next one. */
static void test_bends(conic_context *context) {
  for (double bend = 0.0; bend < 1.0; bend += 0.15)
    for (int sheet = 0; sheet < 3; sheet++) {
      conic_fan fan = fan_of(context, bend, sheet > 0, sheet > 1);
      CHECK(fan.n == N_AROUND);
      for (int i = 0; i < fan.n; i++)
        CHECK(fan.pairs[i][1] == fan.pairs[i][0] % N_AROUND + 1);
    }
}

/* What lies farther below than beside is another sheet. */
static void test_sheets(conic_context *context) {
  CHECK(fan_of(context, 1.2, 0, 0).n == 0);
  CHECK(fan_of(context, 1.2, 1, 0).n == 0);
}

/* Three on a circle: a triangle, unless the circle is a hole. Four on one are two triangles. */
static void test_circles(conic_context *context) {
  const float x[4] = {0.0f, 1.0f, 1.0f, 0.0f}, y[4] = {0.0f, 0.0f, 1.0f, 1.0f}, z[4] = {0};
  const float *const positions[3] = {x, y, z};
  const double normal[3] = {0.0, 0.0, 1.0};
  for (size_t n = 3; n <= 4; n++) {
    conic_neighbours tree;
    conic_fan fan;
    CHECK_OK(conic_neighbours_build(context, positions, n, &tree));
    conic_fan_find(&tree, NULL, tree.slot_of_point[0], normal, 0.72, &fan);
    CHECK(fan.n == (int)n - 2);
    conic_fan_find(&tree, NULL, tree.slot_of_point[0], normal, 0.7, &fan);
    CHECK(fan.n == 0);
    conic_neighbours_release(context, &tree);
  }
}

int main(void) {
  conic_context *context = check_context(1);
  test_bends(context);
  test_sheets(context);
  test_circles(context);
  conic_context_destroy(context);
  return check_result();
}
