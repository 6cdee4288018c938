/* Sets of Gaussians: activation, half floats, frames, order. */
#include "core/base/gaussian.h"
#include "gaussians/scene/activation.h"
#include "gaussians/scene/harmonics.h"
#include "tests/support/gaussian_fixture.h"

/* As the C library has them in double, but for the last bit of a float. */
static void test_activation(void) {
  for (double x = -20.0; x < 20.0; x += 0.00137) {
    float of = (float)x;
    CHECK_NEAR((double)conic_scale_of_log(of), exp((double)of), 6e-8 * exp((double)of));
    double opacity = 1.0 / (1.0 + exp(-(double)of));
    CHECK_NEAR((double)conic_opacity_of_logit(of), opacity, 6e-8 * opacity);
    CHECK_NEAR((double)conic_log_of_scale((float)exp(x)), x, 2e-6);
  }
  CHECK(conic_scale_of_log(conic_log_of_scale(0.0f)) == 0.0f && conic_scale_of_log(100.0f) > 1e38f);
  CHECK(conic_opacity_of_logit(conic_logit_of_opacity(0.0f)) == 0.0f);
  CHECK(conic_opacity_of_logit(conic_logit_of_opacity(1.0f)) == 1.0f);
  float none = conic_logit_of_opacity(1.5f), negative = conic_log_of_scale(-1.0f), nan = conic_scale_of_log((float)NAN);
  CHECK(none != none && negative != negative && nan != nan);
}

/* Every half comes back, and floats go to the nearest, ties to even. */
static void test_halfs(void) {
  for (uint32_t half = 0; half < 65536; half++) {
    float value = conic_float_of_half((uint16_t)half);
    CHECK(value != value ? (half & 0x7fff) > 0x7c00 : conic_half_of_float(value) == half);
    if ((half & 0x7fff) >= 0x7bff)
      continue;
    float next = conic_float_of_half((uint16_t)(half + 1)), middle = 0.5f * (value + next);
    CHECK(conic_half_of_float(middle) == half + (half & 1));
    CHECK(conic_half_of_float(middle * 0.99f + next * 0.01f) == half + 1);
  }
  CHECK(conic_half_of_float(65519.0f) == 0x7bff && conic_half_of_float(65520.0f) == 0x7c00);
}

static double evaluate(const conic_gaussians *scene, size_t i, int channel, const double direction[3]) {
  double y[25], sum = 0.0;
  conic_harmonics_evaluate(direction, scene->sh_degree, y);
  for (int k = 0; k < (scene->sh_degree + 1) * (scene->sh_degree + 1); k++)
    sum += y[k] * (double)scene->sh[i * conic_harmonics_of_degree(scene->sh_degree) + (size_t)(3 * k + channel)];
  return sum;
}

/* The covariance of Gaussian i along an axis: |S Rᵀ a|². */
static double variance(const conic_gaussians *scene, size_t i, const double axis[3]) {
  double q[4], length = 0.0, sum = 0.0;
  for (int k = 0; k < 4; k++) {
    q[k] = (double)scene->rotation[k][i];
    length += q[k] * q[k];
  }
  for (int k = 0; k < 4; k++)
    q[k] /= sqrt(length);
  double w = q[0], x = q[1], y = q[2], z = q[3];
  const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                          {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                          {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  for (int k = 0; k < 3; k++) {
    double along = (r[0][k] * axis[0] + r[1][k] * axis[1] + r[2][k] * axis[2]) * (double)scene->scale[k][i];
    sum += along * along;
  }
  return sum;
}

/* What a turned scene shows in a turned direction is what the scene showed. */
static void test_turns(conic_context *context) {
  static const struct {
    const char *frame;
    int from[3], sign[3]; /* axis i of the frame is axis from[i] of rdf, with that sign */
  } frames[] = {{"rub", {0, 1, 2}, {1, -1, -1}},
                {"luf", {0, 1, 2}, {-1, -1, 1}},
                {"rfu", {0, 2, 1}, {1, 1, -1}},
                {"fru", {2, 0, 1}, {1, 1, -1}},
                {"rdf", {0, 1, 2}, {1, 1, 1}}};
  for (size_t f = 0; f < sizeof frames / sizeof *frames; f++) {
    conic_gaussians scene = gaussians_random(context, 20, 4, 0), turned = gaussians_random(context, 20, 4, 0);
    conic_status status = conic_gaussians_turn(context, &turned, frames[f].frame);
    if (strcmp(frames[f].frame, "fru") == 0) { /* a mirror image */
      CHECK(status == CONIC_ERROR_ARGUMENT);
      conic_gaussians_release(context, &scene);
      conic_gaussians_release(context, &turned);
      continue;
    }
    CHECK_OK(status);
    CHECK(strcmp(turned.frame, frames[f].frame) == 0);
    const double before[3] = {0.36, 0.48, -0.8};
    double after[3];
    for (int axis = 0; axis < 3; axis++)
      after[axis] = frames[f].sign[axis] * before[frames[f].from[axis]];
    for (size_t i = 0; i < scene.count; i++) {
      for (int axis = 0; axis < 3; axis++)
        CHECK((double)turned.position[axis][i] ==
              frames[f].sign[axis] * (double)scene.position[frames[f].from[axis]][i]);
      for (int channel = 0; channel < 3; channel++)
        CHECK_NEAR(evaluate(&turned, i, channel, after), evaluate(&scene, i, channel, before), 2e-6);
      CHECK_NEAR(variance(&turned, i, after), variance(&scene, i, before), 1e-7);
    }
    conic_gaussians_differences apart;
    CHECK_OK(conic_gaussians_turn(context, &turned, "rdf"));
    CHECK_OK(conic_gaussians_compare(context, &scene, &turned, &apart));
    CHECK(apart.is_same || (f == 2 && apart.harmonics < 1e-6 && apart.position == 0.0));
    conic_gaussians_release(context, &scene);
    conic_gaussians_release(context, &turned);
  }
}

/* The same Gaussians, and neighbours nearer to each other than by chance. */
static void test_order(conic_context *context) {
  const unsigned fields[] = {0, CONIC_GAUSSIANS_HALF | CONIC_GAUSSIANS_2D};
  for (int k = 0; k < 2; k++) {
    conic_gaussians scene = gaussians_random(context, 3000, 1, fields[k]);
    double length = 0.0, sum = 0.0;
    for (size_t i = 0; i < scene.count; i++) { /* whose harmonic tells which it is */
      conic_gaussians_put_harmonic(&scene, i, 5, scene.position[0][i]);
      scene.opacity[i] = scene.position[0][i];
    }
    scene.position[1][7] = (float)NAN;
    CHECK_OK(conic_gaussians_sort(context, &scene));
    for (size_t i = 0; i < scene.count; i++) {
      float room[CONIC_MOST_HARMONICS];
      CHECK(scene.opacity[i] == scene.position[0][i]);
      CHECK_NEAR((double)conic_gaussians_harmonics(&scene, i, room)[5], (double)scene.position[0][i], 1e-3);
      sum += (double)scene.position[0][i];
      if (i > 0 && i + 1 < scene.count)
        for (int axis = 0; axis < 3; axis++)
          length += fabs((double)scene.position[axis][i] - (double)scene.position[axis][i - 1]);
    }
    CHECK(scene.position[1][2999] != scene.position[1][2999]);
    CHECK(length < 0.2 * 4.0 * 3000); /* 4 a step by chance */
    conic_gaussians unsorted = gaussians_random(context, 3000, 1, fields[k]);
    for (size_t i = 0; i < unsorted.count; i++)
      sum -= (double)unsorted.position[0][i];
    CHECK_NEAR(sum, 0.0, 1e-9);
    conic_gaussians_release(context, &scene);
    conic_gaussians_release(context, &unsorted);
  }
}

static void test_refusals(conic_context *context) {
  conic_gaussians scene;
  conic_gaussians_write_options options;
  CHECK(conic_gaussians_allocate(context, 1, 5, 0, &scene) == CONIC_ERROR_ARGUMENT && scene.count == 0);
  scene = gaussians_random(context, 2, 0, 0);
  conic_gaussians_write_options_init(&options);
  options.spz_version = 2;
  CHECK(conic_gaussians_write(context, files_path("no.spz"), &scene, &options) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_gaussians_turn(context, &scene, "rdr") == CONIC_ERROR_ARGUMENT);
  conic_gaussians_release(context, &scene);
}

int main(void) {
  conic_context *context = files_context();
  test_activation();
  test_halfs();
  test_turns(context);
  test_order(context);
  test_refusals(context);
  files_end(context);
  return check_result();
}
