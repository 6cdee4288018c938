/* Longitude and latitude: which points are taken for them, and how many metres they become. */
#include "core/splats/degrees.h"
#include "tests/support/check.h"

enum { N = 4 };

/* Four corners of a piece of ground so wide and deep, and so high. */
static conic_splats ground(float x[N], float y[N], float z[N], const double origin[3], double size, double height) {
  conic_splats points = {.count = N, .position = {x, y, z}};
  for (int i = 0; i < 3; i++)
    points.origin[i] = origin[i];
  for (int i = 0; i < N; i++) {
    x[i] = (float)(i % 2 ? size : 0.0);
    y[i] = (float)(i / 2 ? size : 0.0);
    z[i] = (float)(i == 3 ? height : 0.0);
  }
  return points;
}

static int are_degrees(double longitude, double latitude, double size, double height) {
  float x[N], y[N], z[N];
  const double origin[3] = {longitude, latitude, 0.0};
  conic_splats points = ground(x, y, z, origin, size, height);
  return conic_points_are_degrees(&points);
}

static void test_what_is_taken_for_degrees(void) {
  CHECK(are_degrees(-123.07, 44.05, 0.01, 100.0));
  CHECK(are_degrees(179.0, -89.9, 0.002, 2.0));
  CHECK(!are_degrees(635000.0, 848000.0, 3000.0, 150.0)); /* metres on a map */
  CHECK(!are_degrees(-0.5, -0.5, 1.0, 80.0));             /* a pole at the origin */
  CHECK(!are_degrees(-123.07, 44.05, 0.01, 0.1));         /* a small thing far out */
  CHECK(!are_degrees(-123.07, 89.999, 0.01, 100.0));      /* beyond the pole of the Earth */
  CHECK(!are_degrees(-123.07, 44.05, 0.0, 100.0));
}

/* The published lengths of a degree on the ellipsoid at 45°: 78,847 m across and 111,132 m along the meridian. */
static void test_metres(void) {
  float x[N], y[N], z[N];
  const double origin[3] = {7.0, 44.995, 100.0};
  double middle[2];
  conic_splats points = ground(x, y, z, origin, 0.01, 50.0);
  conic_points_take_metres(&points, middle);
  CHECK(fabs(middle[0] - 7.005) < 1e-6 && fabs(middle[1] - 45.0) < 1e-6);
  CHECK(fabs((double)(x[1] - x[0]) - 788.47) < 0.05);
  CHECK(fabs((double)(y[2] - y[0]) - 1111.32) < 0.05);
  CHECK(fabs((double)(x[0] + x[1])) < 0.01 && fabs((double)(y[0] + y[2])) < 0.01);
  CHECK(points.origin[0] == 0.0 && points.origin[1] == 0.0 && points.origin[2] == 100.0 && z[3] == 50.0f);
}

int main(void) {
  test_what_is_taken_for_degrees();
  test_metres();
  return check_result();
}
