/* The widest gap about a point: where neighbours on a bend leave one, whatever lies on a sheet above or below. */
#include "surface/gap.h"

#include "tests/support/check.h"

enum { N_AROUND = 6 };

/* The point at the origin, N_AROUND others at distance 1 that lie `bend` below its tangent plane z = 0, and, where
 * `has_sheet`, as many on another sheet right below it. */
static conic_gap gap_of(conic_context *context, double bend, int has_sheet) {
  float x[1 + 2 * N_AROUND] = {0}, y[1 + 2 * N_AROUND] = {0}, z[1 + 2 * N_AROUND] = {0};
  const float *const positions[3] = {x, y, z};
  const double center[3] = {0.0, 0.0, 0.0}, normal[3] = {0.0, 0.0, 1.0};
  conic_neighbours tree;
  conic_gap gap;
  for (int i = 0; i < 2 * N_AROUND; i++) {
    double angle = 6.283185307179586 * (i + (i < N_AROUND ? 0.0 : 0.5)) / N_AROUND;
    double across = i < N_AROUND ? cos(bend) : 0.2;
    x[1 + i] = (float)(across * cos(angle));
    y[1 + i] = (float)(across * sin(angle));
    z[1 + i] = i < N_AROUND ? (float)-sin(bend) : -0.4f;
  }
  CHECK_OK(conic_neighbours_build(context, positions, 1 + N_AROUND + (has_sheet ? N_AROUND : 0), &tree));
  conic_gap_find(&tree, tree.slot_of_point[0], center, normal, 0.1, 1.0, &gap);
  conic_neighbours_release(context, &tree);
  return gap;
}

/* Neighbours are laid into the plane at their distance in space, so that the gap between a point and two of six about
 * it is the same on a bend as on a plane. */
static void test_bends(conic_context *context) {
  for (double bend = 0.0; bend < 1.0; bend += 0.15)
    for (int has_sheet = 0; has_sheet < 2; has_sheet++) {
      conic_gap gap = gap_of(context, bend, has_sheet);
      CHECK_NEAR(gap.radius, 1.0 / sqrt(3.0), 1e-6);
      if (!(gap.radius > 0.0))
        continue;
      CHECK_NEAR(hypot(gap.center[0], gap.center[1]), gap.radius, 1e-6);
      CHECK(gap.center[2] == 0.0);
      double sixths = atan2(gap.center[1], gap.center[0]) / (3.14159265358979 / N_AROUND);
      CHECK_NEAR(fabs(remainder(sixths, 2.0)), 1.0, 1e-5); /* halfway between two of them */
    }
}

/* What lies farther below than beside is another sheet: about that alone there is no gap. */
static void test_sheets(conic_context *context) {
  CHECK(gap_of(context, 1.2, 0).radius == 0.0);
  CHECK(gap_of(context, 1.2, 1).radius == 0.0);
}

/* Three on a circle: there is a gap at its middle, unless that sees nobody over more than 150°. */
static void test_open(conic_context *context) {
  for (double apart_deg = 120.0; apart_deg < 180.0; apart_deg += 7.0) {
    double half = 0.5 * apart_deg * 3.14159265358979 / 180.0;
    float x[3] = {0.0f, (float)(1.0 + cos(half)), (float)(1.0 + cos(half))}, z[3] = {0};
    float y[3] = {0.0f, (float)sin(half), (float)-sin(half)};
    const float *const positions[3] = {x, y, z};
    const double center[3] = {0.0, 0.0, 0.0}, normal[3] = {0.0, 0.0, 1.0};
    conic_neighbours tree;
    conic_gap gap;
    CHECK_OK(conic_neighbours_build(context, positions, 3, &tree));
    conic_gap_find(&tree, tree.slot_of_point[0], center, normal, 0.1, 1.5, &gap);
    CHECK_NEAR(gap.radius, apart_deg < 150.0 ? 1.0 : 0.0, 1e-6);
    conic_neighbours_release(context, &tree);
  }
}

int main(void) {
  conic_context *context = check_context(1);
  test_bends(context);
  test_open(context);
  test_sheets(context);
  conic_context_destroy(context);
  return check_result();
}
