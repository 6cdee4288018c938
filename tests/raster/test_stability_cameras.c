/* Cameras that break other renderers: inside a model, close to it, far from it, narrow, wide, rolled, off-centre, of
 * odd shapes (docs/reference/accuracy.md). */
#include "tests/support/stability.h"

enum { N_SPHERE = 3000 };

static void options_of(fixture *f, int width, int height, double focal_px) {
  conic_render_options_init(&f->options);
  fixture_camera(f, width, height, focal_px);
}

/* Compares; no splat is left out as unfit; and where the picture must be full, there are no holes by any method. */
static void check_view(fixture *f, const char *name, double unstable_share, int is_full) {
  stability_agree(f, name, unstable_share);
  CHECK(f->statistics.splats_skipped == 0);
  for (int method = 0; is_full && method < CONIC_N_METHODS; method++) {
    if (!stability_fills(method))
      continue;
    f->options.method = (conic_method)method;
    fixture_render(f);
    size_t n_pixels = (size_t)f->camera.width * (size_t)f->camera.height, n_holes = n_pixels - stability_covered(f);
    if (n_holes) {
      fprintf(stderr, "%s, %s: %zu holes\n", name, conic_method_name((conic_method)method), n_holes);
      check_failures++;
    }
  }
}

/* From within the sphere, in its middle and by its wall, in all directions: no hole anywhere. */
static void test_inside(fixture *f) {
  static const double eyes[][3] = {{0, 0, 0}, {0.6, 0.2, -0.3}, {0.98, 0, 0}};
  static const double forwards[][3] = {{1, 0.1, 0.2}, {-1, 0.3, 0.1}, {0.1, 0.9, 0.5}};
  options_of(f, 112, 84, 60.0);
  fixture_scene(f, CONIC_SCENE_SPHERE, N_SPHERE);
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      char name[60];
      snprintf(name, sizeof name, "inside a sphere, at %g", eyes[i][0]);
      stability_look(f, eyes[i], forwards[k], 0.3 * k);
      check_view(f, name, 0.02, 1);
    }
}

/* 0.02 outside the sphere's surface, where a disc is four times wider than that: looking down all is covered, looking
 * along it the horizon is closed. */
static void test_close(fixture *f) {
  static const double forwards[][3] = {{-1, 0, 0}, {-1, 0.3, 0.4}, {-0.2, 0, 1}};
  const double eye[3] = {1.02, 0, 0};
  options_of(f, 112, 84, 70.0);
  fixture_scene(f, CONIC_SCENE_SPHERE, N_SPHERE);
  for (int k = 0; k < 3; k++) {
    stability_look(f, eye, forwards[k], 0.0);
    check_view(f, "0.02 from a sphere", 0.02, k < 2);
    CHECK(stability_covered(f) > 2000);
  }
}

/* A field of view of 1 degree from 1e4 away: all rays are nearly parallel, and depth has few bits left of its range. */
static void test_narrow(fixture *f) {
  const double away = 1e4, eye[3] = {0.6 * away, 0.0, 0.8 * away}, forward[3] = {-0.6, 0.0, -0.8};
  options_of(f, 112, 96, 48.0 / tan(0.5 * stability_pi / 180.0));
  fixture_scene(f, CONIC_SCENE_SPHERE, N_SPHERE);
  for (int c = 0; c < 3; c++)
    for (size_t i = 0; i < f->splats.count; i++) { /* radius 70: four fifths of the picture's height */
      f->splats.position[c][i] *= 70.0f;
      f->splats.tangent_u[c][i] *= 70.0f;
      f->splats.tangent_v[c][i] *= 70.0f;
    }
  stability_look(f, eye, forward, 0.0);
  check_view(f, "1 degree, from 1e4 away", 0.02, 0);
  /* The disc of the silhouette, widened by the prefilter's 1.5 px at most. */
  double radius_px = f->camera.fx * 70.0 / sqrt(away * away - 4900.0);
  CHECK((double)stability_covered(f) > stability_pi * (radius_px - 0.5) * (radius_px - 0.5));
  CHECK((double)stability_covered(f) < stability_pi * (radius_px + 2.5) * (radius_px + 2.5));
}

/* 170 degrees across, in a room and before a sphere; the corners are 86 degrees off the axis. */
static void test_wide(fixture *f) {
  const double eye[3] = {0.2, 0.1, 0.0}, outside[3] = {0, 0, 1.3}, forward[3] = {0.3, 0.2, -1.0};
  options_of(f, 128, 96, 48.0 / tan(85.0 * stability_pi / 180.0));
  fixture_scene(f, CONIC_SCENE_SPHERE, N_SPHERE);
  stability_look(f, eye, forward, 0.0);
  check_view(f, "170 degrees, inside", 0.02, 1);
  stability_look(f, outside, forward, 0.0);
  check_view(f, "170 degrees, outside", 0.02, 0);
  CHECK(stability_covered(f) > 50);
}

/* A camera that is rolled a quarter sees the same picture, turned. */
static void test_rolled(fixture *f) {
  const double eye[3] = {1.0, 1.2, 2.4}, forward[3] = {-1.0, -1.2, -2.4};
  options_of(f, 96, 96, 100.0);
  fixture_scene(f, CONIC_SCENE_KNOT, 3000);
  stability_look(f, eye, forward, 1.0);
  check_view(f, "rolled by a radian", 0.02, 0);
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    if (!stability_fills(method))
      continue;
    f->options.method = (conic_method)method;
    stability_look(f, eye, forward, 0.0);
    conic_image upright = stability_draw(f), turned;
    stability_look(f, eye, forward, 0.5 * stability_pi);
    fixture_render(f);
    CHECK_OK(conic_image_allocate(f->context, 96, 96, ALL_PLANES, &turned));
    for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) {
      size_t bytes = 4 * (size_t)conic_plane_describe((conic_plane)plane)->n_channels;
      for (size_t y = 0; y < 96; y++)
        for (size_t x = 0; x < 96; x++)
          memcpy((char *)turned.planes[plane] + (96 * x + 95 - y) * bytes,
                 (char *)f->image.planes[plane] + (96 * y + x) * bytes, bytes);
    }
    stability_difference d = stability_compare(&upright, &turned);
    stability_print("rolled by a quarter turn, turned back", f, &d);
    CHECK(d.both > 2500 && d.coverage * 500 <= d.both);
    CHECK(d.color_p999 <= 1e-4);
    conic_image_release(f->context, &upright);
    conic_image_release(f->context, &turned);
  }
}

/* Pixels that are not square, and principal points far off the screen. */
static void test_intrinsics(fixture *f) {
  const double eye[3] = {0, 0, 3}, forward[3] = {0, 0, -1};
  fixture_scene(f, CONIC_SCENE_KNOT, 3000);
  options_of(f, 128, 64, 0.0);
  f->camera.fx = 150.0;
  f->camera.fy = 60.0;
  stability_look(f, eye, forward, 0.3);
  check_view(f, "fx 2.5 times fy", 0.02, 0);
  CHECK(stability_covered(f) > 1000);
  f->camera.fx = 1.0;
  f->camera.fy = 60.0;
  check_view(f, "fx a sixtieth of fy", 0.02, 0);
  /* The knot stands far aside of an eye that looks straight ahead; the screen is where it is seen. */
  const double aside[3] = {-30, 12, 3};
  options_of(f, 112, 96, 100.0);
  stability_look(f, aside, forward, 0.0);
  f->camera.cx = 56.0 - 100.0 * (f->camera.cam_from_world[0][3] / 3.0);
  f->camera.cy = 48.0 - 100.0 * (f->camera.cam_from_world[1][3] / 3.0);
  check_view(f, "a principal point 1000 px off the screen", 0.02, 0);
  CHECK(stability_covered(f) > 2000);
}

/* One pixel, one row, one column. */
static void test_shapes(fixture *f) {
  static const int sizes[][2] = {{1, 1}, {16384, 1}, {1, 4096}, {3, 2}};
  const double eye[3] = {0, 0, 2.5}, forward[3] = {0, 0, -1};
  fixture_scene(f, CONIC_SCENE_SPHERE, 800);
  for (int k = 0; k < 4; k++) {
    char name[60];
    int longest = sizes[k][0] > sizes[k][1] ? sizes[k][0] : sizes[k][1];
    options_of(f, sizes[k][0], sizes[k][1], 0.8 * longest);
    stability_look(f, eye, forward, 0.0);
    snprintf(name, sizeof name, "%d x %d pixels", sizes[k][0], sizes[k][1]);
    check_view(f, name, 0.02, longest < 4);
    CHECK(stability_covered(f) * 10 > 4 * (size_t)longest);
  }
}

/* A row of discs that slides through the camera plane, the eye exactly in the plane of every second. */
static void test_eye_in_plane(fixture *f) {
  options_of(f, 112, 84, 80.0);
  f->options.near_z = 1e-3;
  fixture_splats(f, 24);
  for (size_t i = 0; i < 24; i++) {
    double z = -0.3 + 0.1 * (double)(i / 2), side = i % 2 ? 0.0 : 0.4;
    const double p[3] = {side, 0.02 * (double)(i % 5), z}, tu[3] = {0, 0.15, 0}, tv[3] = {0, 0, 0.15};
    fixture_set(f, i, p, tu, tv, (float)i / 24.0f, 0.5f, 0.9f);
  }
  check_view(f, "the eye in the planes of discs", 1.0, 0);
  CHECK(stability_covered(f) > 84);
  for (int y = 0; y < 84; y++)
    for (int x = 0; x < 56 - 2; x++)
      CHECK(!stability_covers(&f->image, x, y)); /* all stand at x >= 0, but for the prefilter's 1.5 px */
}

int main(void) {
  fixture f = fixture_open(2);
  test_inside(&f);
  test_close(&f);
  test_narrow(&f);
  test_wide(&f);
  test_rolled(&f);
  test_intrinsics(&f);
  test_shapes(&f);
  test_eye_in_plane(&f);
  fixture_close(&f);
  return check_result();
}
