/* Supersampling: against the fine picture reduced by hand, against the oracle, and that edges have no fringes. */
#include "tests/support/fixture.h"
#include "tests/support/sanitized.h"

static void render_samples(fixture *f, int samples) {
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &f->image));
  CHECK_OK(conic_render_samples(f->context, f->renderer, &f->splats, &f->camera, &f->options, samples, &f->image,
                                &f->statistics));
}

static conic_camera times(const conic_camera *camera, int n) {
  conic_camera fine = *camera;
  fine.width *= n;
  fine.height *= n;
  fine.fx *= n;
  fine.fy *= n;
  fine.cx *= n;
  fine.cy *= n;
  return fine;
}

static conic_image render_fine(fixture *f, int samples, conic_render_statistics *statistics) {
  conic_image fine;
  conic_camera camera = times(&f->camera, samples);
  CHECK_OK(conic_image_allocate(f->context, camera.width, camera.height, ALL_PLANES, &fine));
  CHECK_OK(conic_render(f->renderer, &f->splats, &camera, &f->options, &fine, statistics));
  return fine;
}

static void fill_scene(fixture *f) {
  fixture_camera(f, 61, 47, 60.0);
  f->camera.cam_from_world[2][3] = 4.0;
  fixture_scene(f, CONIC_SCENE_KNOT, 4000);
  f->options.shading = CONIC_SHADE_PHONG;
}

/* One is what there was without. */
static void test_one(fixture *f) {
  fill_scene(f);
  fixture_render(f);
  uint64_t hashes[CONIC_N_DRAWN_PLANES];
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    hashes[plane] = conic_image_hash(&f->image, (conic_plane)plane);
  render_samples(f, 1);
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    CHECK(hashes[plane] == conic_image_hash(&f->image, (conic_plane)plane));
}

static double fine_value(const conic_image *fine, conic_plane plane, int x, int y, int c) {
  const conic_plane_description *about = conic_plane_describe(plane);
  size_t at = ((size_t)y * (size_t)fine->width + (size_t)x) * (size_t)about->n_channels + (size_t)c;
  return about->is_uint ? (double)((const uint32_t *)fine->planes[plane])[at]
                        : (double)((const float *)fine->planes[plane])[at];
}

/* A plane's mean, or greatest value, over the samples of a pixel. */
static double reduced(const conic_image *fine, conic_plane plane, int n, int x, int y, int c) {
  double sum = 0.0, greatest = 0.0;
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      double value = fine_value(fine, plane, x * n + i, y * n + j, c);
      sum += value;
      greatest = value > greatest ? value : greatest;
    }
  return plane == CONIC_PLANE_COUNT ? greatest : (double)(float)(sum / (double)(n * n));
}

static void check_normal(const fixture *f, const conic_image *fine, int n, int x, int y) {
  double sum[3] = {0, 0, 0};
  const float *normal = fixture_pixel(f, CONIC_PLANE_NORMAL, x, y);
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++)
      for (int c = 0; c < 3; c++)
        sum[c] += fine_value(fine, CONIC_PLANE_NORMAL, x * n + i, y * n + j, c);
  double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  for (int c = 0; c < 3; c++)
    CHECK_NEAR((double)normal[c], length > 0.0 ? sum[c] / length : 0.0, 1e-7);
}

static void test_reduction(fixture *f, int n) {
  static const conic_plane plain[] = {CONIC_PLANE_RGBA, CONIC_PLANE_ALBEDO, CONIC_PLANE_WEIGHT, CONIC_PLANE_COUNT};
  conic_render_statistics statistics;
  int n_partly = 0, center = n % 2 ? n / 2 : n / 2 - 1;
  fill_scene(f);
  conic_image fine = render_fine(f, n, &statistics);
  render_samples(f, n);
  for (int y = 0; y < f->camera.height; y++)
    for (int x = 0; x < f->camera.width; x++) {
      for (size_t i = 0; i < sizeof plain / sizeof plain[0]; i++)
        for (int c = 0; c < conic_plane_describe(plain[i])->n_channels; c++)
          CHECK(fine_value(&f->image, plain[i], x, y, c) == reduced(&fine, plain[i], n, x, y, c));
      check_normal(f, &fine, n, x, y);
      int middle_x = x * n + center, middle_y = y * n + center;
      CHECK(fine_value(&f->image, CONIC_PLANE_Z, x, y, 0) == fine_value(&fine, CONIC_PLANE_Z, middle_x, middle_y, 0));
      CHECK(fine_value(&f->image, CONIC_PLANE_ID, x, y, 0) == fine_value(&fine, CONIC_PLANE_ID, middle_x, middle_y, 0));
      float alpha = fixture_pixel(f, CONIC_PLANE_RGBA, x, y)[3];
      n_partly += alpha > 0.0f && alpha < 1.0f;
    }
  CHECK(n_partly > 50);
  CHECK(statistics.fragments == f->statistics.fragments && statistics.splats_drawn == f->statistics.splats_drawn);
  conic_image_release(f->context, &fine);
}

/* A corridor in one pixel: the normals of its walls cancel, and the covered sample nearest to the centre decides; of
 * two that are as near, the first, which is on the left wall. */
static void test_opposite_normals(fixture *f) {
  static const double left[3] = {-1.0, 0.0, 0.4}, right[3] = {1.0, 0.0, 0.4};
  static const double u[3] = {0, 0, 0.1}, v[3] = {0, 1.0, 0};
  fixture_camera(f, 1, 1, 0.1);
  fixture_splats(f, 2);
  fixture_set(f, 0, left, u, v, 1, 1, 1);
  fixture_set(f, 1, right, u, v, 1, 1, 1);
  f->options.prefilter = 0.0f;
  render_samples(f, 16);
  const float *normal = fixture_pixel(f, CONIC_PLANE_NORMAL, 0, 0), *rgba = fixture_pixel(f, CONIC_PLANE_RGBA, 0, 0);
  CHECK(rgba[3] > 0.1f && rgba[3] < 0.9f);
  CHECK(normal[0] == 1.0f && normal[1] == 0.0f && normal[2] == 0.0f);
  f->options.prefilter = 1.0f;
}

/* A disc of one colour: what is in a pixel is that colour times its coverage, whatever is behind. */
static void test_fringes(fixture *f) {
  static const double p[3] = {0.1, -0.05, 2.0}, u[3] = {0.3, 0.1, 0.05}, v[3] = {-0.1, 0.25, 0.2};
  static const float color[3] = {0.9f, 0.3f, 0.07f};
  const int n = 3;
  int n_partly = 0;
  fixture_camera(f, 40, 40, 50.0);
  fixture_splats(f, 1);
  fixture_set(f, 0, p, u, v, color[0], color[1], color[2]);
  f->options.shading = CONIC_SHADE_NONE;
  render_samples(f, n);
  conic_image clear = f->image;
  memset(&f->image, 0, sizeof f->image);
  for (int background = 0; background < 2; background++) { /* black, white */
    f->options.has_background = 1;
    for (int c = 0; c < 3; c++)
      f->options.background[c] = (float)background;
    render_samples(f, n);
    for (int i = 0; i < 40 * 40; i++) {
      const float *over = fixture_pixel(f, CONIC_PLANE_RGBA, i % 40, i / 40);
      const float *pixel = (const float *)clear.planes[CONIC_PLANE_RGBA] + 4 * i;
      double samples = (double)pixel[3] * (double)(n * n);
      CHECK_NEAR(samples, floor(samples + 0.5), 1e-6);
      n_partly += pixel[3] > 0.0f && pixel[3] < 1.0f;
      for (int c = 0; c < 3; c++) {
        CHECK_NEAR((double)pixel[c], (double)color[c] * (double)pixel[3], 1e-7);
        CHECK_NEAR((double)over[c], (double)pixel[c] + (1.0 - (double)pixel[3]) * background, 1e-7);
      }
      CHECK(over[3] == 1.0f);
    }
  }
  CHECK(n_partly > 40);
  f->options.has_background = 0;
  conic_image_release(f->context, &clear);
}

/* Where memory asks for bands, they fit together: rows of 16 × 60 samples, 18 million in all. A band begins its own
 * count of rows, so that a footprint's fraction of a pixel may be rounded otherwise. */
static void test_bands(fixture *f) {
  conic_render_statistics whole;
  int n_differing = 0;
  fill_scene(f);
  fixture_camera(f, 60, 1160, 60.0);
  f->camera.cam_from_world[2][3] = 2.0;
  render_samples(f, 16);
  if (IS_SANITIZED)
    return;
  conic_image fine = render_fine(f, 16, &whole);
  for (int y = 0; y < f->camera.height; y++)
    for (int x = 0; x < f->camera.width; x++)
      for (int c = 0; c < 4; c++) {
        double a = fine_value(&f->image, CONIC_PLANE_RGBA, x, y, c), b = reduced(&fine, CONIC_PLANE_RGBA, 16, x, y, c);
        n_differing += a != b;
        CHECK_NEAR(a, b, 2e-3); /* one sample may be decided otherwise */
      }
  CHECK(n_differing < 60);
  CHECK(whole.splats_in == f->statistics.splats_in && whole.splats_drawn == f->statistics.splats_drawn);
  CHECK(whole.splats_culled == f->statistics.splats_culled && whole.splats_skipped == f->statistics.splats_skipped);
  CHECK(whole.splats_fallback == f->statistics.splats_fallback);
  for (int i = 0; i < CONIC_N_METHODS; i++)
    CHECK(whole.splats_by_method[i] == f->statistics.splats_by_method[i]);
  conic_image_release(f->context, &fine);
}

static void test_oracle(fixture *f, int n, conic_method method) {
  conic_reference reference;
  conic_oracle_verdict verdict;
  fill_scene(f);
  f->options.method = method;
  render_samples(f, n);
  CHECK_OK(
      conic_oracle_render_samples(f->context, &f->splats, &f->camera, &f->options, CONIC_ORACLE_METHOD, n, &reference));
  CHECK_OK(conic_oracle_compare(f->context, &reference, &f->image, &verdict));
  CHECK(verdict.pass && verdict.compared_pixels > 2000 && verdict.covered_pixels > 300);
  CHECK(reference.covered_samples > reference.covered_pixels * (size_t)n);
  /* A picture of one sample a pixel is another. */
  render_samples(f, 1);
  CHECK_OK(conic_oracle_compare(f->context, &reference, &f->image, &verdict));
  CHECK(!verdict.pass);
  conic_reference_release(f->context, &reference);
  f->options.method = CONIC_METHOD_AUTO;
}

static void test_threads(fixture *f) {
  fixture other = fixture_open(1);
  fill_scene(f);
  render_samples(f, 3);
  other.options.tile = 16;
  fill_scene(&other);
  render_samples(&other, 3);
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    CHECK(conic_image_hash(&f->image, (conic_plane)plane) == conic_image_hash(&other.image, (conic_plane)plane));
  fixture_close(&other);
}

static void test_refusals(fixture *f) {
  fill_scene(f);
  static const int bad[] = {0, -1, CONIC_MAX_SAMPLES + 1};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
    CHECK(conic_render_samples(f->context, f->renderer, &f->splats, &f->camera, &f->options, bad[i], &f->image, NULL) ==
          CONIC_ERROR_ARGUMENT);
  fixture_camera(f, 5000, 1, 100.0);
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, 5000, 1, ALL_PLANES, &f->image));
  CHECK(conic_render_samples(f->context, f->renderer, &f->splats, &f->camera, &f->options, 14, &f->image, NULL) ==
        CONIC_ERROR_ARGUMENT);
  CHECK_OK(conic_render_samples(f->context, f->renderer, &f->splats, &f->camera, &f->options, 13, &f->image, NULL));
}

int main(void) {
  fixture f = fixture_open(3);
  test_one(&f);
  test_reduction(&f, 2);
  test_reduction(&f, 3);
  test_opposite_normals(&f);
  test_fringes(&f);
  test_bands(&f);
  test_oracle(&f, 2, CONIC_METHOD_CONIC);
  test_oracle(&f, 3, CONIC_METHOD_RAY);
  test_threads(&f);
  test_refusals(&f);
  fixture_close(&f);
  return check_result();
}
