/* The oracle against what can be worked out by hand, and the comparison against errors that it must see. */
#include "oracle/oracle_splat.h"
#include "tests/support/examine.h"

static const double pi = 3.14159265358979323846;

static conic_camera pinhole(int width, int height, double focal_px) {
  conic_camera camera;
  memset(&camera, 0, sizeof camera);
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal_px;
  camera.cx = 0.5 * width;
  camera.cy = 0.5 * height;
  for (int i = 0; i < 3; i++)
    camera.cam_from_world[i][i] = 1.0;
  return camera;
}

/* Circles and pixels about the centre know nothing of tilts and filters. */
static int is_dot(int method) {
  return method == CONIC_METHOD_DISC || method == CONIC_METHOD_POINT;
}

/* Frontal and on the axis, a splat projects to a Gaussian of s pixels, and Gaussians convolve to Gaussians: all other
 * methods are exact there. */
static void test_frontal(conic_context *context) {
  const conic_camera camera = pinhole(64, 64, 500.0);
  const double places[4][2] = {{32.0, 32.0}, {33.5, 32.0}, {30.0, 34.0}, {32.0, 39.0}};
  conic_render_options options;
  conic_render_options_init(&options);
  options.near_z = 0.01;
  for (int i = 0; i < 4; i++) {
    double s_px = 0.1 * (1 << (2 * i)), sigma = s_px * 2.0 / 500.0;
    conic_oracle_splat splat = {{0, 0, 2}, {sigma, 0, 0}, {0, sigma, 0}};
    for (int method = 0; method < CONIC_N_METHODS; method++) {
      conic_oracle_sample samples[4];
      if (is_dot(method))
        continue;
      options.method = (conic_method)method;
      CHECK_OK(conic_oracle_probe(context, &splat, &camera, &options, places, 4, samples));
      for (int j = 0; j < 4; j++) {
        double dx = places[j][0] - 32.0, dy = places[j][1] - 32.0, variance = s_px * s_px + 1.0;
        double expected = s_px * s_px / variance * exp(-0.5 * (dx * dx + dy * dy) / variance);
        CHECK_NEAR(samples[j].weight, expected, 1e-13);
        CHECK_NEAR(samples[j].exact, expected, 1e-10);
        CHECK_NEAR(samples[j].q, (dx * dx + dy * dy) / variance, 1e-11);
        CHECK(samples[j].covers == (samples[j].q < 2.25));
        CHECK_NEAR(samples[j].inverse_depth, 0.5, 1e-15);
      }
    }
  }
}

/* A tilted splat off the axis. */
static conic_oracle_splat tilted(double sigma) {
  conic_oracle_splat splat = {{0.4, -0.3, 1.5}, {sigma, 0, 0.9 * sigma}, {0, sigma, 0}};
  splat.tangent_v[0] = -0.3 * sigma;
  splat.tangent_v[2] = 0.3 / 0.9 * sigma;
  return splat;
}

/* The plane of the splat, met by the ray of the place. */
static void test_depth(conic_context *context) {
  const conic_camera camera = pinhole(400, 300, 300.0);
  const double places[2][2] = {{280.0, 90.0}, {285.0, 84.0}};
  conic_oracle_splat s = tilted(0.05);
  conic_render_options options;
  conic_oracle_sample samples[2];
  conic_render_options_init(&options);
  options.near_z = 0.01;
  double n[3] = {s.tangent_u[1] * s.tangent_v[2] - s.tangent_u[2] * s.tangent_v[1],
                 s.tangent_u[2] * s.tangent_v[0] - s.tangent_u[0] * s.tangent_v[2],
                 s.tangent_u[0] * s.tangent_v[1] - s.tangent_u[1] * s.tangent_v[0]};
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    if (is_dot(method))
      continue;
    options.method = (conic_method)method;
    CHECK_OK(conic_oracle_probe(context, &s, &camera, &options, places, 2, samples));
    for (int i = 0; i < 2; i++) {
      double d[3] = {(places[i][0] - 200.0) / 300.0, (places[i][1] - 150.0) / 300.0, 1.0};
      double along = n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
      double distance = n[0] * s.center[0] + n[1] * s.center[1] + n[2] * s.center[2];
      CHECK_NEAR(samples[i].plane_inverse_depth, along / distance, 1e-13);
    }
  }
}

/* Method `conic` is the ray's where a disc reaches over a quarter of its distance, and its own before. */
static void test_choice(void) {
  const conic_camera camera = pinhole(400, 300, 300.0);
  const double sigmas[2] = {0.25, 0.27};
  conic_render_options options;
  conic_render_options_init(&options);
  options.method = CONIC_METHOD_CONIC;
  oracle_view view = conic_oracle_view(&camera, &options, 0.01, CONIC_FLOATS_OWN);
  for (int i = 0; i < 2; i++) {
    conic_oracle_splat s = tilted(sigmas[i]);
    oracle_placed placed;
    double answers[ORACLE_N_QUESTIONS];
    int is_so[ORACLE_N_QUESTIONS];
    memcpy(placed.p, s.center, sizeof placed.p);
    memcpy(placed.tu, s.tangent_u, sizeof placed.tu);
    memcpy(placed.tv, s.tangent_v, sizeof placed.tv);
    double reach = 1.5 * sqrt(placed.tu[2] * placed.tu[2] + placed.tv[2] * placed.tv[2]) / placed.p[2];
    conic_oracle_ask(&view, &placed, answers);
    conic_oracle_answer(answers, is_so);
    CHECK((reach > 0.25) == i);
    CHECK(conic_oracle_choose(&view, is_so) == (i ? ORACLE_RAY : ORACLE_CONIC));
  }
}

/* A circle of F_g standard deviations of its longer axis, half a pixel at least; the pixel that holds the centre. */
static void test_dots(conic_context *context) {
  const conic_camera camera = pinhole(400, 300, 300.0);
  const double center[2] = {280.0, 90.0}, sigmas[2] = {0.02, 1e-5}, steps[6] = {0.0, 0.3, 0.49, 0.51, 7.0, 30.0};
  for (int i = 0; i < 12; i++) {
    conic_oracle_splat s = tilted(sigmas[i / 6]);
    conic_oracle_sample sample;
    conic_render_options options;
    conic_render_options_init(&options);
    options.near_z = 0.01;
    options.method = CONIC_METHOD_DISC;
    double longer = 0.0, step = steps[i % 6], place[1][2] = {{center[0] + 0.6 * step, center[1] - 0.8 * step}};
    for (int c = 0; c < 3; c++)
      longer += s.tangent_u[c] * s.tangent_u[c];
    double radius = fmax(0.5, 1.5 * sqrt(longer) * 300.0 / 1.5);
    CHECK_OK(conic_oracle_probe(context, &s, &camera, &options, (const double(*)[2])place, 1, &sample));
    CHECK_NEAR(sample.q, 2.25 * step * step / (radius * radius), 1e-9 * sample.q + 1e-12);
    CHECK_NEAR(sample.weight, exp(-0.5 * sample.q), 1e-12);
    CHECK(sample.covers == (step < radius));
    CHECK_NEAR(sample.inverse_depth, 1.0 / 1.5, 1e-15);
    options.method = CONIC_METHOD_POINT;
    place[0][0] = center[0] + step;
    CHECK_OK(conic_oracle_probe(context, &s, &camera, &options, (const double(*)[2])place, 1, &sample));
    CHECK(sample.covers == (step < 0.5) && sample.weight == 1.0);
    CHECK_NEAR(sample.inverse_depth, 1.0 / 1.5, 1e-15);
  }
}

/* The convolution once more, as a plain sum over the splat's own plane. */
static double sum_over_plane(const conic_oracle_splat *s, const conic_camera *c, const double place[2], double h) {
  const double step = 0.02;
  double sum = 0.0;
  for (double u = -7.0; u <= 7.0; u += step)
    for (double v = -7.0; v <= 7.0; v += step) {
      double x[3];
      for (int i = 0; i < 3; i++)
        x[i] = s->center[i] + u * s->tangent_u[i] + v * s->tangent_v[i];
      double dx = c->fx * x[0] / x[2] + c->cx - place[0], dy = c->fy * x[1] / x[2] + c->cy - place[1];
      sum += exp(-0.5 * (u * u + v * v) - 0.5 * (dx * dx + dy * dy) / h) / (x[2] * x[2] * x[2]);
    }
  const double *p = s->center, *t = s->tangent_u, *w = s->tangent_v;
  double volume =
      p[0] * (t[1] * w[2] - t[2] * w[1]) + p[1] * (t[2] * w[0] - t[0] * w[2]) + p[2] * (t[0] * w[1] - t[1] * w[0]);
  return sum * step * step * c->fx * c->fy * fabs(volume) / (2.0 * pi * h);
}

static void test_exact(conic_context *context) {
  const conic_camera camera = pinhole(400, 300, 300.0);
  const double places[3][2] = {{280.0, 90.0}, {281.5, 89.0}, {276.0, 93.0}};
  conic_render_options options;
  conic_render_options_init(&options);
  options.near_z = 0.01;
  options.method = CONIC_METHOD_RAY;
  for (int i = 0; i < 3; i++) {
    static const double sigmas[3] = {0.002, 0.02, 0.1}, prefilters[3] = {1.0, 1.0, 9.0};
    conic_oracle_splat splat = tilted(sigmas[i]);
    conic_oracle_sample samples[3];
    options.prefilter = (float)prefilters[i];
    CHECK_OK(conic_oracle_probe(context, &splat, &camera, &options, (const double(*)[2])places, 3, samples));
    for (int j = 0; j < 3; j++) {
      double expected = sum_over_plane(&splat, &camera, places[j], prefilters[i]);
      CHECK_NEAR(samples[j].exact, expected, 1e-8);
      CHECK(samples[j].quadrature < 1e-7);
      CHECK_NEAR(samples[j].weight, expected, 0.02);
    }
  }
  /* Other kernels have edges, and converge as far as the header says. */
  options.kernel.type = CONIC_KERNEL_BOX;
  options.prefilter = 1.0f;
  conic_oracle_splat splat = {{0, 0, 2}, {0.01, 0, 0}, {0, 0.01, 0}};
  const double middle[1][2] = {{200.0, 150.0}};
  conic_oracle_sample sample;
  CHECK_OK(conic_oracle_probe(context, &splat, &camera, &options, middle, 1, &sample));
  CHECK_NEAR(sample.exact, 1.0 - exp(-0.5 * 2.25 * 2.25), 2e-3); /* a disc of 1.5 · 1.5 px under a Gaussian */
}

/* What the comparison must see: a weight, a depth, a colour, an id, a count that is a little wrong; and NaN. */
static void test_planted(fixture *f) {
  static const double tilts[CONIC_N_DRAWN_PLANES] = {3e-4, 3e-5, 3e-4, 3e-4, 1e-3, 0.0, 0.0};
  fixture_camera(f, 160, 120, 110.0);
  f->camera.cam_from_world[2][3] = 2.6;
  fixture_scene(f, CONIC_SCENE_SPHERE, 3000);
  f->options.method = CONIC_METHOD_CONIC;
  outcome o = examine(f);
  CHECK(o.verdict.pass);
  size_t at = 0;
  while (o.reference.unstable[at] || !(o.reference.planes[CONIC_PLANE_COUNT][at] > 2.0))
    at++;
  for (int i = 0; i < CONIC_N_DRAWN_PLANES; i++) {
    const conic_plane_description *about = conic_plane_describe((conic_plane)i);
    size_t where = at * (size_t)about->n_channels;
    uint32_t kept;
    memcpy(&kept, (uint32_t *)f->image.planes[i] + where, sizeof kept);
    if (about->is_uint)
      ((uint32_t *)f->image.planes[i])[where] ^= 1u << 20;
    else
      ((float *)f->image.planes[i])[where] *= (float)(1.0 + tilts[i]),
          ((float *)f->image.planes[i])[where] += (float)tilts[i] * 0.5f;
    CHECK_OK(conic_oracle_compare(f->context, &o.reference, &f->image, &o.verdict));
    CHECK(!o.verdict.pass);
    CHECK(o.verdict.planes[i].max_abs > o.verdict.planes[i].bound);
    if (!about->is_uint) {
      ((float *)f->image.planes[i])[where] = NAN;
      CHECK_OK(conic_oracle_compare(f->context, &o.reference, &f->image, &o.verdict));
      CHECK(!o.verdict.pass && o.verdict.planes[i].max_abs > 1e30);
    }
    memcpy((uint32_t *)f->image.planes[i] + where, &kept, sizeof kept);
    CHECK_OK(conic_oracle_compare(f->context, &o.reference, &f->image, &o.verdict));
    CHECK(o.verdict.pass);
  }
  /* A renderer whose weights are off by a thousandth: of one splat in ten, then of all. */
  conic_splats wrong = f->splats;
  for (int step = 10; step >= 1; step -= 9) {
    float *opacity = malloc(wrong.count * sizeof *opacity);
    for (size_t i = 0; i < wrong.count; i++)
      opacity[i] = i % (size_t)step ? 1.0f : 1.001f;
    wrong.opacity = opacity;
    CHECK_OK(conic_render(f->renderer, &wrong, &f->camera, &f->options, &f->image, NULL));
    CHECK_OK(conic_oracle_compare(f->context, &o.reference, &f->image, &o.verdict));
    CHECK(!o.verdict.pass);
    CHECK(o.verdict.planes[CONIC_PLANE_WEIGHT].max_abs > 1e-4 && o.verdict.planes[CONIC_PLANE_WEIGHT].max_abs < 2e-3);
    free(opacity);
  }
  conic_reference_release(f->context, &o.reference);
}

/* Too many pixels of which nothing can be said are a failure. */
static void test_limit(fixture *f) {
  outcome o = examine(f);
  size_t limit = (size_t)(o.verdict.unbounded_limit * (double)o.reference.n_pixels);
  CHECK(o.reference.unbounded_pixels == 0 && limit > 0);
  o.reference.unbounded_pixels = limit;
  CHECK_OK(conic_oracle_compare(f->context, &o.reference, &f->image, &o.verdict));
  CHECK(o.verdict.pass);
  o.reference.unbounded_pixels = limit + 1;
  CHECK_OK(conic_oracle_compare(f->context, &o.reference, &f->image, &o.verdict));
  CHECK(!o.verdict.pass);
  conic_reference_release(f->context, &o.reference);
}

/* The reference doesn't depend on the threads, and what can't be is refused. */
static void test_contract(fixture *f) {
  conic_context *alone = check_context(1);
  conic_reference a, b;
  for (int question = 0; question < 2; question++) {
    fixture_camera(f, 40, 30, 30.0);
    f->camera.cam_from_world[2][3] = 2.6;
    CHECK_OK(conic_oracle_render(alone, &f->splats, &f->camera, &f->options, (conic_oracle_question)question, &a));
    CHECK_OK(conic_oracle_render(f->context, &f->splats, &f->camera, &f->options, (conic_oracle_question)question, &b));
    for (int i = 0; i < CONIC_N_DRAWN_PLANES; i++)
      CHECK(memcmp(a.planes[i], b.planes[i],
                   1200 * sizeof(double) * (size_t)conic_plane_describe((conic_plane)i)->n_channels) == 0);
    CHECK(memcmp(a.unstable, b.unstable, 1200) == 0);
    CHECK(memcmp(&a.weight_error, &b.weight_error, sizeof a.weight_error) == 0);
    CHECK((a.weight_error.n_weights > 1000) == (question == CONIC_ORACLE_EXACT));
    CHECK(a.weight_error.max_abs >= a.weight_error.p999);
    CHECK(question == CONIC_ORACLE_METHOD || (a.weight_error.max_abs > 1e-6 && a.weight_error.quadrature < 1e-6));
    conic_reference_release(alone, &a);
    conic_reference_release(f->context, &b);
  }
  conic_splats raw = f->splats;
  raw.tangent_u[0] = NULL;
  CHECK(conic_oracle_render(f->context, &raw, &f->camera, &f->options, CONIC_ORACLE_METHOD, &a) ==
        CONIC_ERROR_ARGUMENT);
  CHECK(!a.planes[0] && !a.unstable);
  conic_context_destroy(alone);
}
int main(void) {
  fixture f = fixture_open(2);
  test_frontal(f.context);
  test_depth(f.context);
  test_choice();
  test_dots(f.context);
  test_exact(f.context);
  test_planted(&f);
  test_limit(&f);
  test_contract(&f);
  fixture_close(&f);
  return check_result();
}
