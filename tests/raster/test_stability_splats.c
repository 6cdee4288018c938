/* The splats that break other renderers (docs/reference/accuracy.md), each against the oracle and against what can be
 * said of it beforehand. */
#include "tests/support/stability.h"

static void straight(fixture *f, int width, int height, double focal_px) {
  conic_render_options_init(&f->options);
  f->options.shading = CONIC_SHADE_NONE;
  f->options.near_z = 1e-3;
  fixture_camera(f, width, height, focal_px);
}

/* A floor that runs on past the eye: its discs reach the camera plane. No hole up to the horizon, nothing above it. */
static void test_floor(fixture *f) {
  const double rolls[] = {0.0, 0.4, 1.2};
  straight(f, 120, 96, 80.0);
  for (int k = 0; k < 3; k++) {
    stability_sheet floor = stability_floor(0.5, rolls[k], 4.0, k ? 16 : 40);
    fixture_splats(f, (size_t)floor.n * (size_t)floor.n);
    stability_fill(f, 0, &floor);
    stability_agree(f, k ? "a rolled floor of large discs" : "a floor past the eye", 0.02);
    for (int method = 0; method < CONIC_N_METHODS; method++) {
      if (!stability_fills(method))
        continue;
      int n_holes = 0, n_above = 0;
      f->options.method = (conic_method)method;
      fixture_render(f);
      for (int y = 0; y < 96; y++)
        for (int x = 0; x < 120; x++) {
          double dx = (x + 0.5 - 60.0) / 80.0, dy = (y + 0.5 - 48.0) / 80.0;
          double across = cos(rolls[k]) * dx + sin(rolls[k]) * dy, down = cos(rolls[k]) * dy - sin(rolls[k]) * dx;
          if (down <= 0.0)
            n_above += stability_covers(&f->image, x, y) && -down * 80.0 > 3.0;
          else if (0.5 / down < 4.8 && fabs(across * 0.5 / down) < 3.6)
            n_holes += !stability_covers(&f->image, x, y);
        }
      /* Far from the eye `affine` may leave holes by itself; close up every method hands over to the ray formula. */
      CHECK(n_holes == 0);
      CHECK(n_above == 0);
    }
  }
}

/* One disc about the eye's foot, its centre behind the eye: all below the horizon, rolled or not. */
static void test_center_behind(fixture *f) {
  straight(f, 96, 96, 80.0);
  for (int k = 0; k < 2; k++) {
    double roll = 0.7 * k, c = cos(roll), s = sin(roll);
    const double p[3] = {-s, c, -0.5}, tu[3] = {40 * c, 40 * s, 0}, tv[3] = {0, 0, -40};
    fixture_splats(f, 1);
    fixture_set(f, 0, p, tu, tv, 1.0f, 0.5f, 0.25f);
    stability_agree(f, k ? "a rolled horizon through one disc" : "a centre behind the eye", 0.02);
    for (int y = 0; y < 96; y++)
      for (int x = 0; x < 96; x++) {
        double down_px = c * (y + 0.5 - 48.0) - s * (x + 0.5 - 48.0);
        if (down_px > 3.0)
          CHECK(stability_covers(&f->image, x, y));
        if (down_px < -4.0)
          CHECK(!stability_covers(&f->image, x, y));
      }
  }
}

/* Rows of discs whose planes pass through the eye, exactly or nearly: lines as wide as the prefilter. Of exact ones all
 * weights are the least there is and all normals undecided, so that the oracle is in doubt of every pixel's values; of
 * what is covered it never is. */
static void test_edge_on(fixture *f) {
  static const double lifts[] = {0.0, 1e-7, 1e-5, 1e-3, 1e-2};
  straight(f, 128, 96, 100.0);
  f->camera.cy = 48.2; /* else 1.5 px, where the band ends, falls on pixels' centres */
  for (int k = 0; k < 5; k++) {
    fixture_splats(f, 90);
    for (size_t i = 0; i < 90; i++) {
      /* Nine rows of ten, each in a plane through the eye but for its lift. */
      double slope = 0.1 * ((double)(i / 10) - 4.0), z = 1.0 + 0.15 * (double)(i % 10);
      const double p[3] = {-0.3 + 0.07 * (double)(i % 10), slope * z, z}, tu[3] = {0.08, 0, 0};
      const double tv[3] = {0, 0.08 * (slope + lifts[k]), 0.08};
      fixture_set(f, i, p, tu, tv, 0.8f, 0.7f, 0.2f);
    }
    stability_agree(f, k ? "rows almost edge-on" : "rows exactly edge-on", 1.0);
    for (int method = 0; method < CONIC_N_METHODS; method++) {
      if (!stability_fills(method))
        continue;
      size_t n_covered = 0;
      f->options.method = (conic_method)method;
      fixture_render(f);
      for (int y = 0; y < 96; y++)
        for (int x = 0; x < 128; x++)
          if (stability_covers(&f->image, x, y)) {
            double row = (y + 0.5 - 48.2) / 10.0;
            float z = *fixture_pixel(f, CONIC_PLANE_Z, x, y);
            n_covered++;
            CHECK(fabs(row - floor(row + 0.5)) * 10.0 < 1.51 + 100.0 * lifts[k]); /* no spike off its row */
            CHECK(z > 0.85f && z < 2.5f);
          }
      CHECK(n_covered > 9 * 2 * 30); /* and no row is lost */
    }
  }
}

/* A lone splat far smaller than a pixel, at every place between the pixels' centres: never nothing, never more than a
 * dot, and always in its colour. */
static void test_sub_pixel(fixture *f) {
  static const double sigmas_px[] = {1e-8, 1e-4, 0.05, 0.3};
  straight(f, 16, 16, 100.0);
  size_t least = 1000, most = 0;
  for (int k = 0; k < 4; k++)
    for (int phase = 0; phase < 256; phase++) {
      double sigma = sigmas_px[k] / 100.0;
      const double p[3] = {(phase % 16) / 1600.0, (phase / 16) / 1600.0, 1}, tu[3] = {sigma, 0, 0},
                   tv[3] = {0, sigma, 0};
      fixture_splats(f, 1);
      fixture_set(f, 0, p, tu, tv, 0.25f, 0.5f, 0.75f);
      if (phase == 37)
        stability_agree(f, "a lone splat under a pixel", 0.5);
      for (int method = 0; method < CONIC_N_METHODS; method++) {
        if (!stability_fills(method))
          continue;
        f->options.method = (conic_method)method;
        fixture_render(f);
        least = stability_covered(f) < least ? stability_covered(f) : least;
        most = stability_covered(f) > most ? stability_covered(f) : most;
        for (int i = 0; i < 256; i++)
          if (stability_covers(&f->image, i % 16, i / 16))
            CHECK_NEAR((double)fixture_pixel(f, CONIC_PLANE_RGBA, i % 16, i / 16)[2], 0.75, 1e-6);
      }
    }
  printf("%-44s %zu to %zu pixels at 256 places\n", "a lone splat under a pixel", least, most);
  CHECK(least >= 4 && most <= 9);
}

/* Discs that cover the screen many times over, and needles of axis ratio 1e6. Over a giant's middle its weight hardly
 * changes: two of them are as heavy as each other along wide bands, where Z may be either's. */
static void test_huge_and_needles(fixture *f) {
  uint64_t state = 5;
  for (int k = 0; k < 2; k++) {
    size_t count = k ? 300 : 40;
    straight(f, 112, 84, 100.0);
    f->options.near_z = 0.05;
    fixture_splats(f, count);
    for (size_t i = 0; i < count; i++) {
      double angle = stability_pi * fixture_random(&state), tilt = fixture_random(&state) - 0.5;
      double length = k ? 0.3 * fixture_random(&state) : 3.0 + 30.0 * fixture_random(&state);
      double width = k ? 1e-6 * length : length * (0.3 + fixture_random(&state)), c = cos(angle), s = sin(angle);
      const double p[3] = {1.5 * (fixture_random(&state) - 0.5), fixture_random(&state) - 0.5,
                           1.0 + 3.0 * fixture_random(&state)};
      const double tu[3] = {length * c, length * s, tilt * length};
      const double tv[3] = {-width * s, width * c, 0};
      fixture_set(f, i, p, tu, tv, (float)fixture_random(&state), (float)fixture_random(&state), 0.5f);
    }
    stability_agree(f, k ? "needles, 1e6 times as long as wide" : "discs wider than the screen", k ? 0.02 : 0.03);
  }
}

/* Thousands of discs over each pixel, copies among them: one colour stays one colour. Sums of n terms may be off by
 * n · 2^-23; of copies, which all round to the same side, they come nearer to that. */
static void test_overlaps(fixture *f) {
  static const size_t counts[] = {100, 4000};
  straight(f, 48, 36, 40.0);
  for (int k = 0; k < 4; k++) {
    size_t n = counts[k % 2];
    int is_copies = k / 2;
    uint64_t state = 11;
    fixture_splats(f, n);
    for (size_t i = 0; i < n; i++) {
      double jitter = is_copies ? 0.0 : 0.02 * fixture_random(&state);
      const double p[3] = {jitter, -jitter, 2.0 + 0.1 * jitter}, tu[3] = {1.5, 0, 0}, tv[3] = {0, 1.5, 0};
      fixture_set(f, i, p, tu, tv, 0.3f, 0.6f, 0.9f);
    }
    if (n == 100)
      stability_agree(f, is_copies ? "coincident copies" : "overlapping discs", 0.05);
    for (int method = 0; method < CONIC_N_METHODS; method++) {
      if (!stability_fills(method))
        continue;
      static const float color[3] = {0.3f, 0.6f, 0.9f};
      double worst = 0.0;
      f->options.method = (conic_method)method;
      fixture_render(f);
      CHECK(stability_covered(f) == 48 * 36);
      CHECK(fixture_index(f, CONIC_PLANE_COUNT, 24, 18) > n / 2);
      for (int i = 0; i < 48 * 36; i++)
        for (int c = 0; c < 3; c++)
          worst = fmax(worst, fabs((double)fixture_pixel(f, CONIC_PLANE_RGBA, i % 48, i / 48)[c] - (double)color[c]));
      printf("%-44s %-7s colour off by %.1e after %zu\n", is_copies ? "coincident copies" : "overlapping discs",
             conic_method_name((conic_method)method), worst, n);
      CHECK(worst <= (n <= 100 && !is_copies ? 1e-6 : (double)n * 0x1p-23));
    }
  }
}

/* What is not a splat is counted, and the others are drawn as if it were not there, to the bit. */
static void test_not_numbers(fixture *f) {
  static const float specials[] = {NAN, INFINITY, -INFINITY};
  straight(f, 96, 96, 80.0);
  f->camera.cam_from_world[2][3] = 3.6; /* all on the screen: what is off it is culled before its axes are looked at */
  fixture_scene(f, CONIC_SCENE_KNOT, 2000);
  size_t n_bad = 0;
  for (size_t i = 0; i < f->splats.count; i += 7, n_bad++) {
    float *arrays[] = {f->splats.position[i % 3], f->splats.tangent_u[i % 3], f->splats.tangent_v[i % 3],
                       f->splats.color[i % 3]};
    if (i / 7 % 5 == 4) /* axes without a plane */
      for (int c = 0; c < 3; c++)
        f->splats.tangent_v[c][i] = i % 2 ? 0.0f : f->splats.tangent_u[c][i];
    else
      arrays[i / 7 % 5][i] = specials[i % 3];
  }
  stability_agree(f, "not numbers, no planes", 0.02);
  CHECK(f->statistics.splats_skipped == n_bad && f->statistics.splats_culled == 0);
  f->options.method = CONIC_METHOD_CONIC;
  conic_image with = stability_draw(f);
  size_t kept = 0; /* the same without them */
  for (size_t i = 0; i < f->splats.count; i++) {
    if (i % 7 == 0)
      continue;
    for (int c = 0; c < 3; c++) {
      f->splats.position[c][kept] = f->splats.position[c][i];
      f->splats.tangent_u[c][kept] = f->splats.tangent_u[c][i];
      f->splats.tangent_v[c][kept] = f->splats.tangent_v[c][i];
      f->splats.color[c][kept] = f->splats.color[c][i];
    }
    kept++;
  }
  size_t count = f->splats.count;
  f->splats.count = kept;
  fixture_render(f);
  f->splats.count = count;
  CHECK(f->statistics.splats_skipped == 0);
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    if (plane != CONIC_PLANE_ID)
      CHECK(conic_image_hash(&with, (conic_plane)plane) == conic_image_hash(&f->image, (conic_plane)plane));
  conic_image_release(f->context, &with);
}

/* Where all weights are tiny, their sum still divides: a covered pixel is never black and never NaN. */
static void test_tiny_weights(fixture *f) {
  static float opacities[400];
  straight(f, 96, 72, 90.0);
  for (int k = 0; k < 3; k++) {
    stability_sheet wall = stability_wall(2.0, 20, 0.2f, 0.7f, 0.4f);
    fixture_splats(f, 400);
    stability_fill(f, 0, &wall);
    for (int i = 0; i < 400; i++)
      opacities[i] = k == 2 ? 0.0f : k == 1 ? 1e-38f : 1e-12f;
    f->splats.opacity = opacities;
    stability_agree(f, "tiny weights", 0.02);
    for (int method = 0; method < CONIC_N_METHODS; method++) {
      if (!stability_fills(method))
        continue;
      double worst = 0.0;
      f->options.method = (conic_method)method;
      fixture_render(f);
      CHECK(stability_covered(f) > 5000);
      for (int y = 0; y < 72; y++)
        for (int x = 0; x < 96; x++)
          if (stability_covers(&f->image, x, y))
            worst = fmax(worst, fabs((double)fixture_pixel(f, CONIC_PLANE_RGBA, x, y)[1] - (double)0.7f));
      CHECK(worst <= 1e-6);
    }
    f->splats.opacity = NULL;
  }
}

/* Points without axes, some of them copies, with normals of any length: the same splats as from unit normals. */
static void test_normals_and_copies(fixture *f) {
  enum { N = 1500, COPIES = 60 };
  conic_image pictures[2];
  straight(f, 96, 72, 80.0);
  f->camera.cam_from_world[2][3] = 3.0;
  for (int k = 0; k < 2; k++) {
    conic_model model;
    conic_estimate_options estimate;
    conic_repairs repairs;
    memset(&model, 0, sizeof model);
    conic_estimate_options_init(&estimate);
    fixture_scene(f, CONIC_SCENE_SPHERE, N);
    CHECK_OK(conic_splats_allocate(f->context, N + COPIES, CONIC_SPLATS_NORMALS | CONIC_SPLATS_COLORS, &model.points));
    for (size_t i = 0; i < N + COPIES; i++)
      for (int c = 0; c < 3; c++) {
        size_t from = i < N ? i : 5 * (i - N);
        float length = k ? (float)(1 << (from % 20)) * 0x1p-10f : 1.0f;
        model.points.position[c][i] = f->splats.position[c][from];
        model.points.normal[c][i] = f->splats.position[c][from] * length; /* radius 1: the place is the normal */
        model.points.color[c][i] = f->splats.color[c][from];
      }
    CHECK_OK(conic_model_to_splats(f->context, &estimate, &model, &repairs));
    CHECK(repairs.duplicate == COPIES);
    conic_splats_release(f->context, &f->splats);
    f->splats = model.points;
    memset(&model.points, 0, sizeof model.points);
    conic_model_release(f->context, &model);
    if (k)
      stability_agree(f, "copies, normals of any length", 0.02);
    f->options.method = CONIC_METHOD_CONIC;
    pictures[k] = stability_draw(f);
    CHECK(stability_covered(f) > 1500);
  }
  stability_difference d = stability_compare(&pictures[0], &pictures[1]);
  stability_print("normals of any length, against unit ones", f, &d);
  CHECK(d.color == 0.0 && d.depth == 0.0 && d.coverage == 0);
  for (int k = 0; k < 2; k++)
    conic_image_release(f->context, &pictures[k]);
}

/* The faces of the cube without an octant: convex and concave edges, and corners whose lines combine by OR. */
static void test_clipped_corner(fixture *f) {
  static const double forwards[3][3] = {{-1, -0.8, -0.6}, {1, 0.5, -0.7}, {-0.2, -0.1, -1}};
  straight(f, 112, 96, 110.0);
  fixture_scene(f, CONIC_SCENE_CORNER, 1200);
  for (int k = 0; k < 3; k++) {
    const double eye[3] = {-2.0 * forwards[k][0], -2.0 * forwards[k][1], -2.0 * forwards[k][2]};
    stability_look(f, eye, forwards[k], 0.2 * k);
    stability_agree(f, "a clipped concave corner", 0.02);
  }
}

int main(void) {
  fixture f = fixture_open(2);
  test_floor(&f);
  test_center_behind(&f);
  test_edge_on(&f);
  test_sub_pixel(&f);
  test_huge_and_needles(&f);
  test_overlaps(&f);
  test_not_numbers(&f);
  test_tiny_weights(&f);
  test_normals_and_copies(&f);
  test_clipped_corner(&f);
  fixture_close(&f);
  return check_result();
}
