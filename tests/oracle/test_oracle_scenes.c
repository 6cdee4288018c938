/* The renderer against the oracle on scenes that are hard on it. */
#include "tests/support/examine.h"
#include "tests/support/sanitized.h"

static void print_outcome(const char *name, const outcome *o) {
  printf("%s:", name);
  for (int i = 0; i < CONIC_N_DRAWN_PLANES; i++)
    printf(" %s %.2g", conic_plane_describe((conic_plane)i)->name, o->verdict.planes[i].max_abs);
  printf("; unstable %zu of %zu:", o->verdict.unstable_pixels, o->verdict.covered_pixels);
  for (int i = 0; i < CONIC_N_UNSTABLE_REASONS; i++)
    printf(" %s %zu", conic_unstable_reason_name((conic_unstable_reason)i), o->reference.unstable_by_reason[i]);
  putchar('\n');
}

/* The renderer keeps every bound, as a third of the pixels show; so many of the covered pixels may be unstable. */
static void check_method(fixture *f, const char *name, double unstable_share, conic_method method) {
  f->options.method = method;
  outcome o = examine_some(f, 3);
  print_outcome(name, &o);
  for (int i = 0; i < CONIC_N_DRAWN_PLANES; i++) {
    CHECK(o.verdict.planes[i].is_compared);
    CHECK_NEAR(o.verdict.planes[i].max_abs, 0.0, o.verdict.planes[i].bound);
  }
  CHECK(o.verdict.covered_pixels > 100);
  CHECK((double)o.verdict.unstable_pixels <= unstable_share * (double)o.verdict.covered_pixels);
  CHECK(o.verdict.pass);
  conic_reference_release(f->context, &o.reference);
}

static void check_agreement(fixture *f, const char *name, double unstable_share) {
  for (int method = 0; method < CONIC_N_METHODS; method++)
    check_method(f, name, unstable_share, (conic_method)method);
}

/* Splats of random place, direction, shape and colour in a box before (or, with low_z below 0, around) the camera. */
static void fill_random(fixture *f, size_t count, double low_z, double high_z, double least_sigma, double most_sigma,
                        double thinness) {
  uint64_t state = 7;
  fixture_splats(f, count);
  for (size_t i = 0; i < count; i++) {
    double z = low_z + (high_z - low_z) * fixture_random(&state), width = fabs(z) + 0.2;
    double p[3] = {width * (fixture_random(&state) - 0.5), width * (fixture_random(&state) - 0.5), z};
    double sigma = least_sigma * pow(most_sigma / least_sigma, fixture_random(&state));
    double a[3], b[3], n[3], tu[3], tv[3], aa = 0.0, nn = 0.0;
    for (int c = 0; c < 3; c++) {
      a[c] = fixture_random(&state) - 0.5;
      b[c] = fixture_random(&state) - 0.5;
      aa += a[c] * a[c];
    }
    for (int c = 0; c < 3; c++)
      n[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
    for (int c = 0; c < 3; c++)
      nn += n[c] * n[c];
    for (int c = 0; c < 3; c++) {
      tu[c] = sigma * a[c] / sqrt(aa);
      tv[c] = sigma * pow(thinness, fixture_random(&state)) * n[c] / sqrt(nn);
    }
    fixture_set(f, i, p, tu, tv, (float)fixture_random(&state), (float)fixture_random(&state),
                (float)fixture_random(&state));
  }
}

static void test_hard_scenes(fixture *f) {
  fixture_camera(f, 128, 96, 115.0);
  fill_random(f, 3000, 1.0, 4.0, 0.002, 0.05, 1.0);
  check_agreement(f, "round", 0.005);
  fill_random(f, 3000, 1.0, 4.0, 0.01, 0.1, 1e-4);
  check_agreement(f, "needles", 0.01);
  fill_random(f, 20000, 1.0, 4.0, 1e-7, 1e-3, 1.0);
  check_agreement(f, "tiny", 0.005);
  fill_random(f, 60, 0.5, 4.0, 1.0, 30.0, 1.0);
  check_agreement(f, "huge", 0.02);
  fixture_camera(f, 72, 54, 65.0); /* hundreds of splats a pixel */
  fill_random(f, 600, -0.3, 0.6, 0.02, 0.5, 1.0);
  check_agreement(f, "near", 0.02);
}

/* Discs whose planes pass through the eye or nearly so. */
static void test_edge_on(fixture *f) {
  uint64_t state = 3;
  fixture_camera(f, 200, 150, 180.0);
  fill_random(f, 400, 1.0, 3.0, 0.01, 0.05, 1.0);
  for (size_t i = 0; i < f->splats.count; i++) {
    double lift = i % 3 ? pow(10.0, -1.0 - 5.0 * fixture_random(&state)) : 0.0;
    for (int c = 0; c < 3; c++)
      f->splats.tangent_v[c][i] =
          (float)(0.02 * (double)f->splats.position[c][i] + lift * 0.02 * (double)f->splats.tangent_v[c][i]);
  }
  check_agreement(f, "edge-on", 1.0);
}

/* Anything at all, special values among it. */
static void test_hostile(fixture *f) {
  static const float specials[] = {NAN, INFINITY, -INFINITY, 0.0f, -0.0f, 1e-42f, 1e-20f, 1e5f};
  uint64_t state = 42;
  fixture_camera(f, 160, 120, 110.0);
  fill_random(f, 1500, -0.5, 4.0, 1e-3, 1.0, 1e-3);
  for (size_t i = 0; i < f->splats.count; i += 3) {
    float *arrays[] = {f->splats.position[i % 3], f->splats.tangent_u[i % 3], f->splats.tangent_v[i % 3]};
    arrays[(i / 3) % 3][i] = specials[(int)(fixture_random(&state) * 8.0)];
  }
  for (int method = 0; method < CONIC_N_METHODS; method++)
    if (method != CONIC_METHOD_DISC)
      check_method(f, "hostile", 0.03, (conic_method)method);
  /* A circle that is as wide as a giant is long would cover all, and whether that giant reaches near is in doubt. */
  for (size_t i = 0; i < f->splats.count; i++)
    for (int c = 0; c < 3; c++)
      if (f->splats.tangent_u[c][i] == 1e5f || f->splats.tangent_v[c][i] == 1e5f)
        f->splats.position[c][i] = NAN;
  check_method(f, "hostile", 0.02, CONIC_METHOD_DISC);
}

/* The options that change what a pixel holds. */
static void test_options(fixture *f) {
  fixture_camera(f, 112, 84, 77.0);
  f->camera.cam_from_world[2][3] = 2.6;
  f->options.near_z = 0.0;
  fixture_scene(f, CONIC_SCENE_KNOT, 4000);
  const conic_render_options plain = f->options;
  check_agreement(f, "knot", 0.005);
  f->options.passes = 1;
  check_agreement(f, "one pass", 0.01);
  f->options = plain;
  f->options.cull_back = 1;
  f->options.has_background = 1;
  f->options.background[1] = 0.3f;
  f->options.exposure = 1.5;
  check_agreement(f, "culled, with a background", 0.005);
  f->options = plain;
  f->options.shading = CONIC_SHADE_LAMBERT;
  f->options.has_light = 1;
  f->options.light[0] = -1.0;
  f->options.light[2] = 2.0;
  f->options.prefilter = 0.0f;
  check_agreement(f, "without prefilter", 0.01);
  f->options = plain;
  f->options.has_light = 1;
  f->options.light[2] = -1.0;
  f->options.kernel.cutoff = 3.0f;
  f->options.kernel.type = CONIC_KERNEL_CONFETTI;
  f->options.kernel.b = 2.5f;
  const conic_camera camera = f->camera;
  fixture_camera(f, 64, 48, 44.0); /* its discs overlap four times as much */
  memcpy(f->camera.cam_from_world, camera.cam_from_world, sizeof camera.cam_from_world);
  check_agreement(f, "confetti, lit from behind", 0.02);
  fixture_camera(f, 112, 84, 77.0);
  memcpy(f->camera.cam_from_world, camera.cam_from_world, sizeof camera.cam_from_world);
  f->options = plain;
  f->options.lighting = (conic_lighting){
      .is_given = 1,
      .n_lights = 3,
      .lights = {{.frame = CONIC_LIGHT_CAMERA, .color = {0.7f, 0.5f, 0.4f}, .direction = {-2.0, 1.0, 1.5}},
                 {.frame = CONIC_LIGHT_WORLD, .color = {0.1f, 0.2f, 0.4f}, .direction = {1.0, -3.0, 0.5}},
                 {.frame = CONIC_LIGHT_HEAD, .color = {0.2f, 0.2f, 0.1f}}},
      .sky = {0.2f, 0.3f, 0.4f},
      .ground = {0.1f, 0.05f, 0.0f},
      .up = {0.3, -1.0, 0.2}};
  check_agreement(f, "three lights under a sky", 0.005);
  f->options = plain;
}

/* Discs almost across the line of sight: over them depth changes by no more than it is rounded, which once made the ray
 * formula drop pixels at random. */
static void test_frontal_wall(fixture *f) {
  fixture_camera(f, 112, 84, 77.0);
  f->camera.cam_from_world[2][3] = 1.3;
  fixture_scene(f, CONIC_SCENE_PLANE, 4000);
  for (int i = 0; i < 6; i += 2) {
    double tilt = i ? 3e-8 * (double)(1 << (2 * i)) : 0.0;
    f->camera.cam_from_world[1][2] = tilt;
    f->camera.cam_from_world[2][1] = -tilt;
    check_agreement(f, "wall", 0.005);
  }
}

int main(void) {
  fixture f = fixture_open(2);
  f.options.near_z = 0.05;
  f.options.shading = CONIC_SHADE_PHONG;
  test_edge_on(&f);
  test_hostile(&f);
  if (!IS_SANITIZED) { /* which takes ten times as long, and finds no more where all is sound */
    test_hard_scenes(&f);
    test_options(&f);
    test_frontal_wall(&f);
  }
  fixture_close(&f);
  return check_result();
}
