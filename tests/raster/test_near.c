/* Where other splatters open holes: discs that reach the camera plane, the eye in a splat's plane, centres behind the
 * eye. A floor that runs under the camera must fill the picture up to the horizon, and not a pixel above it. */
#include "tests/support/fixture.h"

/* A floor of n × n overlapping discs at `height` below the eye, from behind it to far ahead, rolled about the view
 * axis. */
static void fill_floor(fixture *f, int n, double height, double roll, double half_size, double outline_in_spacings) {
  double spacing = 2.0 * half_size / n, sigma = outline_in_spacings * spacing / 1.5, c = cos(roll), s = sin(roll);
  fixture_splats(f, (size_t)n * (size_t)n);
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      double x = (i + 0.5) * spacing - half_size, z = (j + 0.5) * spacing - half_size + 0.4 * half_size;
      const double p[3] = {c * x - s * height, s * x + c * height, z}, tu[3] = {c * sigma, s * sigma, 0};
      const double tv[3] = {0, 0, -sigma};
      fixture_set(f, (size_t)j * (size_t)n + (size_t)i, p, tu, tv, 0.2f, 0.4f, 0.6f);
    }
}

static void check_floor(fixture *f, double height, double roll, double half_size) {
  int n_holes = 0, n_above = 0, n_floor = 0;
  double worst = 0.0;
  fixture_render(f);
  for (int y = 0; y < f->camera.height; y++)
    for (int x = 0; x < f->camera.width; x++) {
      double dx = (x + 0.5 - f->camera.cx) / f->camera.fx, dy = (y + 0.5 - f->camera.cy) / f->camera.fy;
      double across = cos(roll) * dx + sin(roll) * dy, down = cos(roll) * dy - sin(roll) * dx;
      int is_covered = fixture_index(f, CONIC_PLANE_ID, x, y) != CONIC_NO_ID;
      if (down <= 0.0) { /* above the horizon, but for the prefilter's rim and the far edge's discs */
        n_above += is_covered && -down * f->camera.fy > 3.0;
        continue;
      }
      double z = height / down;
      if (z > 1.2 * half_size || fabs(across * z) > 0.9 * half_size)
        continue;
      n_floor++;
      n_holes += !is_covered;
      if (is_covered && z < 0.3 * half_size)
        worst = fmax(worst, fabs((double)*fixture_pixel(f, CONIC_PLANE_Z, x, y) / z - 1.0));
    }
  printf("floor %g below, rolled %.2f: %d pixels, %d holes, %d above the horizon, Z off by %.2g, %llu by ray\n", height,
         roll, n_floor, n_holes, n_above, worst, (unsigned long long)f->statistics.splats_by_method[CONIC_METHOD_RAY]);
  CHECK(n_floor > 1000);
  CHECK(n_holes == 0);
  CHECK(n_above == 0);
  CHECK(worst < 1e-4);
  CHECK(f->statistics.splats_by_method[CONIC_METHOD_RAY] > 0);
}

static void test_floors(void) {
  const double rolls[] = {0.0, 0.4, 1.2};
  fixture f = fixture_open(2);
  fixture_camera(&f, 240, 200, 150.0);
  f.options.near_z = 1e-3;
  for (int k = 0; k < 3; k++) {
    fill_floor(&f, 60, 0.5, rolls[k], 4.0, 1.5);
    check_floor(&f, 0.5, rolls[k], 4.0);
    fill_floor(&f, 12, 0.3, rolls[k], 4.0, 1.5); /* discs far larger than the eye's height above them */
    check_floor(&f, 0.3, rolls[k], 4.0);
  }
  fixture_close(&f);
}

/* One disc that surrounds the eye's foot: it reaches behind the camera. Every pixel below the horizon sees it. */
static void test_single_disc(void) {
  fixture f = fixture_open(1);
  fixture_camera(&f, 100, 100, 80.0);
  f.options.near_z = 1e-3;
  fixture_splats(&f, 1);
  const double p[3] = {0, 1.0, -0.5}, tu[3] = {40, 0, 0}, tv[3] = {0, 0, -40}; /* the centre is behind the eye */
  fixture_set(&f, 0, p, tu, tv, 1, 1, 1);
  fixture_render(&f);
  CHECK(f.statistics.splats_drawn == 1 && f.statistics.splats_by_method[CONIC_METHOD_RAY] == 1);
  int n_wrong = 0;
  for (int y = 0; y < 100; y++)
    for (int x = 0; x < 100; x++) {
      double below = y + 0.5 - 50.0;
      int is_covered = fixture_index(&f, CONIC_PLANE_ID, x, y) != CONIC_NO_ID;
      double z = below > 0.0 ? 80.0 / below : 0.0;
      if (below > 0.0 && hypot((x - 49.5) / 80.0 * z, z + 0.5) < 55.0)
        n_wrong += !is_covered;
      else if (below < -4.0)
        n_wrong += is_covered;
    }
  CHECK(n_wrong == 0);
  fixture_close(&f);
}

/* Seen exactly from its edge, before near and across it, a disc is a line as wide as the prefilter: no hole, no spike,
 * no false depth. */
static void test_edge_on(void) {
  const double centers_z[] = {2.0, 0.5};
  for (int k = 0; k < 2; k++) {
    fixture f = fixture_open(1);
    fixture_camera(&f, 100, 100, 80.0);
    f.options.near_z = 1e-2;
    fixture_splats(&f, 1);
    const double p[3] = {0, 0, centers_z[k]}, tu[3] = {0.4, 0, 0},
                 tv[3] = {0, 0, -0.4}; /* reaches 0.6 to either side */
    fixture_set(&f, 0, p, tu, tv, 1, 1, 1);
    fixture_render(&f);
    CHECK(f.statistics.splats_drawn == 1);
    CHECK(f.statistics.pixels_covered > 30);
    for (int y = 0; y < 100; y++)
      for (int x = 0; x < 100; x++)
        if (fixture_index(&f, CONIC_PLANE_ID, x, y) != CONIC_NO_ID) {
          float z = *fixture_pixel(&f, CONIC_PLANE_Z, x, y);
          CHECK(fabs(y + 0.5 - 50.0) < 1.51);
          CHECK((double)z <= centers_z[k] + 0.61 && (double)z >= fmax(0.0099, centers_z[k] - 0.61));
        }
    fixture_close(&f);
  }
}

/* Wider than float can square, frontal: it fills the picture. Wider than float can hold, edge-on through the eye: it
 * is left out and counted, and nothing else happens. */
static void test_giants(void) {
  for (int k = 0; k < 2; k++) {
    fixture f = fixture_open(1);
    fixture_camera(&f, 64, 64, k ? 1e9 : 100.0);
    f.options.near_z = k ? 1e-25 : 1e-2;
    fixture_splats(&f, 1);
    const double p[3] = {0, 0, 1}, tu[3] = {0, 1e13, 0}, tv[2][3] = {{1e13, 0, 0}, {0, 0, 1e13}};
    fixture_set(&f, 0, p, tu, tv[k], 1, 1, 1);
    fixture_render(&f);
    CHECK(f.statistics.pixels_covered == (k ? 0 : 64 * 64));
    CHECK(f.statistics.splats_skipped == (uint64_t)k);
    fixture_close(&f);
  }
}

int main(void) {
  test_floors();
  test_single_disc();
  test_edge_on();
  test_giants();
  return check_result();
}
