/* Pictures of surfaces that are known: a tilted plane's depth, a uniform colour, a sphere's silhouette, the weights of
 * a lone splat. */
#include "tests/support/fixture.h"

/* A square grid of splats in the plane through (0, 0, 2) that leans by `tilt` about x; true for pixels well inside. */
static void fill_plane(fixture *f, int n, double tilt, double half_size, double outline_in_spacings) {
  double spacing = 2.0 * half_size / n, sigma = outline_in_spacings * spacing / 1.5;
  double along[3] = {0.0, cos(tilt), sin(tilt)};
  fixture_splats(f, (size_t)n * (size_t)n);
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      double s = (i + 0.5) * spacing - half_size, t = (j + 0.5) * spacing - half_size;
      double p[3] = {s, t * along[1], 2.0 + t * along[2]};
      double tu[3] = {sigma, 0, 0}, tv[3] = {0, sigma * along[1], sigma * along[2]};
      fixture_set(f, (size_t)j * (size_t)n + (size_t)i, p, tu, tv, 0.3f, 0.5f, 0.7f);
    }
}

static void test_plane_depth(void) {
  fixture f = fixture_open(2);
  fixture_camera(&f, 400, 400, 500.0);
  const double tilts[] = {0.0, 0.5, 1.0, 1.3, 1.4};
  for (int k = 0; k < 5; k++) {
    double worst = 0.0, tilt = tilts[k], normal[3] = {0.0, -sin(tilt), cos(tilt)};
    int n_inside = 0;
    fill_plane(&f, 40, tilt, 0.5, 1.5);
    fixture_render(&f);
    for (int y = 0; y < 400; y++)
      for (int x = 0; x < 400; x++) {
        double d[3] = {(x + 0.5 - 200.0) / 500.0, (y + 0.5 - 200.0) / 500.0, 1.0};
        double z = 2.0 * normal[2] / (d[1] * normal[1] + normal[2]);
        double s = d[0] * z, t = d[1] * z * cos(tilt) + (z - 2.0) * sin(tilt);
        /* Inside the discs only: where a standard deviation spans less than a pixel, the prefilter's rim shows. */
        double below = 2.0 * normal[2] / ((d[1] + 1.0 / 500.0) * normal[1] + normal[2]);
        double t_below = (d[1] + 1.0 / 500.0) * below * cos(tilt) + (below - 2.0) * sin(tilt);
        if (z <= 0.0 || fabs(s) > 0.45 || fabs(t) > 0.45 || fabs(t_below - t) > 0.025)
          continue;
        n_inside++;
        double error = fabs((double)*fixture_pixel(&f, CONIC_PLANE_Z, x, y) / z - 1.0);
        worst = fmax(worst, error);
        const float *seen = fixture_pixel(&f, CONIC_PLANE_NORMAL, x, y);
        CHECK_NEAR((double)seen[0] * normal[0] + (double)seen[1] * normal[1] + (double)seen[2] * normal[2], -1.0, 1e-5);
      }
    printf("plane leaning %.2f rad: Z off by %.2g relative over %d pixels\n", tilt, worst, n_inside);
    CHECK(n_inside > 1000);
    CHECK(worst <= 1e-5);
  }
  fixture_close(&f);
}

static void test_uniform_color(void) {
  fixture f = fixture_open(2);
  fixture_camera(&f, 200, 200, 300.0);
  double worst = 0.0;
  uint32_t most = 0;
  fill_plane(&f, 60, 0.7, 0.3, 5.8);
  fixture_render(&f);
  const float color[3] = {0.3f, 0.5f, 0.7f};
  for (int y = 0; y < 200; y++)
    for (int x = 0; x < 200; x++) {
      uint32_t count = fixture_index(&f, CONIC_PLANE_COUNT, x, y);
      if (count == 0 || count > 100)
        continue;
      most = count > most ? count : most;
      for (int c = 0; c < 3; c++)
        worst = fmax(worst, fabs((double)fixture_pixel(&f, CONIC_PLANE_RGBA, x, y)[c] - (double)color[c]));
    }
  printf("uniform colour off by %.2g with up to %u overlaps\n", worst, most);
  CHECK(most >= 90);
  CHECK(worst <= 1e-6);
  fixture_close(&f);
}

/* Seen from outside, discs that touch a sphere reach out of its silhouette by next to nothing, and the prefilter adds
 * F_g·√h pixels. */
static void test_sphere_silhouette(void) {
  fixture f = fixture_open(2);
  fixture_camera(&f, 600, 600, 700.0);
  f.camera.cam_from_world[2][3] = 3.0;
  fixture_scene(&f, CONIC_SCENE_SPHERE, 100000);
  const double prefilters[] = {0.25, 1.0, 4.0};
  for (int k = 0; k < 3; k++) {
    f.options.prefilter = (float)prefilters[k];
    fixture_render(&f);
    double radius = 700.0 / sqrt(3.0 * 3.0 - 1.0) + 1.5 * sqrt(prefilters[k]);
    double seen = sqrt((double)f.statistics.pixels_covered / 3.14159265358979);
    printf("silhouette with prefilter %g: radius %.3f px, as defined %.3f px\n", prefilters[k], seen, radius);
    CHECK_NEAR(seen, radius, 0.1);
  }
  /* No pinhole inside, and the depth is the sphere's. */
  int n_holes = 0;
  double worst = 0.0;
  for (int y = 0; y < 600; y++)
    for (int x = 0; x < 600; x++) {
      double dx = (x + 0.5 - 300.0) / 700.0, dy = (y + 0.5 - 300.0) / 700.0, dd = dx * dx + dy * dy + 1.0;
      double rest = 9.0 - 8.0 * dd;
      if (rest < 0.5)
        continue;
      double z = (3.0 - sqrt(rest)) / dd;
      n_holes += fixture_index(&f, CONIC_PLANE_ID, x, y) == CONIC_NO_ID;
      worst = fmax(worst, fabs((double)*fixture_pixel(&f, CONIC_PLANE_Z, x, y) - z));
    }
  printf("sphere: %d holes, depth off by %.2g\n", n_holes, worst);
  CHECK(n_holes == 0);
  CHECK(worst < 2e-3);
  fixture_close(&f);
}

/* One frontal splat: its weight is the Gaussian of variance R' + h with the amplitude sqrt(|R'|/|V|), exactly
 * computable. */
static void test_lone_splat(void) {
  fixture f = fixture_open(1);
  fixture_camera(&f, 64, 64, 100.0);
  fixture_splats(&f, 1);
  const double p[3] = {0.013, -0.02, 1.0}, tu[3] = {0.06, 0, 0}, tv[3] = {0, 0.03, 0};
  fixture_set(&f, 0, p, tu, tv, 1, 1, 1);
  fixture_render(&f);
  double x_t = 32.0 + 1.3, y_t = 32.0 - 2.0, worst = 0.0;
  double amplitude = sqrt(36.0 * 9.0 / (37.0 * 10.0));
  for (int y = 0; y < 64; y++)
    for (int x = 0; x < 64; x++) {
      double dx = x + 0.5 - x_t, dy = y + 0.5 - y_t, q = dx * dx / 37.0 + dy * dy / 10.0;
      double expected = q < 2.25 ? amplitude * exp(-0.5 * q) : 0.0;
      worst = fmax(worst, fabs(expected - (double)*fixture_pixel(&f, CONIC_PLANE_WEIGHT, x, y)));
    }
  CHECK(worst < 2e-6);
  CHECK(f.statistics.splats_drawn == 1 && f.statistics.splats_fallback == 0);
  fixture_close(&f);
}

int main(void) {
  test_plane_depth();
  test_uniform_color();
  test_sphere_silhouette();
  test_lone_splat();
  return check_result();
}
