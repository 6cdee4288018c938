/* Gradients are judged: what is right, right but for rounding, right but for a decision in doubt, and wrong. */
#include "conic/gaussian_gradient.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_fixture.h"

enum { SIDE = 40, N_GAUSSIANS = 150 };

static double weight_numbers[3 * SIDE * SIDE], alpha_numbers[SIDE * SIDE];
static const conic_gaussian_weights weights = {
    .width = SIDE, .height = SIDE, .rgb = weight_numbers, .alpha = alpha_numbers};
static const conic_camera camera = {.width = SIDE,
                                    .height = SIDE,
                                    .fx = 45.0,
                                    .fy = 45.0,
                                    .cx = 20.0,
                                    .cy = 20.0,
                                    .cam_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 4}}};

static conic_gaussian_options gradient_test_options(conic_gaussian_profile profile) {
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  options.profile = profile;
  return options;
}

static conic_gaussian_gradient own_gradient(conic_context *context, const conic_gaussians *scene,
                                            conic_gaussian_profile profile, int is_raw) {
  const conic_gaussian_options options = gradient_test_options(profile);
  conic_gradient_options how;
  conic_gaussian_gradient g;
  conic_gradient_options_init(&how);
  how.leaves_doubts = 1;
  how.is_raw = (uint32_t)is_raw;
  CHECK_OK(conic_gaussian_gradient_find(context, scene, &camera, &options, &weights, &how, &g));
  return g;
}

static conic_gradient_verdict judged(conic_context *context, const conic_gaussians *scene,
                                     conic_gaussian_profile profile, int is_raw, const conic_gaussian_gradient *theirs,
                                     uint8_t *classes) {
  const conic_gaussian_options options = gradient_test_options(profile);
  conic_gradient_options how;
  conic_gradient_verdict v;
  conic_gradient_options_init(&how);
  how.is_raw = (uint32_t)is_raw;
  CHECK_OK(conic_gaussian_gradient_judge(context, scene, &camera, &options, &weights, &how, theirs, classes, &v));
  return v;
}

/* Equal; a little off; much off, one number at a time, and named. */
static void test_gradient_classes(conic_context *context, conic_gaussian_profile profile, int is_raw) {
  uint8_t classes[N_GAUSSIANS];
  conic_gaussians scene = gaussians_random(context, N_GAUSSIANS, 1, 0);
  conic_gaussian_gradient g = own_gradient(context, &scene, profile, is_raw);
  conic_gradient_verdict v = judged(context, &scene, profile, is_raw, &g, classes);
  size_t at = 0;
  CHECK(v.pass && v.gaussians[CONIC_PIXEL_EQUAL] == N_GAUSSIANS && v.max_abs[CONIC_GRADIENT_SH] == 0.0);
  for (size_t i = 0; i < N_GAUSSIANS; i++) /* the largest derivative by an opacity */
    at = fabs(g.opacity[i]) > fabs(g.opacity[at]) ? i : at;
  double *const numbers[CONIC_N_GRADIENT_KINDS] = {&g.mean[2][at], &g.scale[1][at],    &g.rotation[3][at],
                                                   &g.opacity[at], &g.sh[12 * at + 4], &g.place[1][at]};
  const int places[CONIC_N_GRADIENT_KINDS] = {2, 1, 3, 0, 4, 1};
  for (int kind = 0; kind < CONIC_N_GRADIENT_KINDS; kind++) {
    const double kept = *numbers[kind];
    *numbers[kind] = kept * (1.0 + 3e-7);
    v = judged(context, &scene, profile, is_raw, &g, classes);
    CHECK(v.pass && v.gaussians[CONIC_PIXEL_ROUNDED] == 1 && classes[at] == CONIC_PIXEL_ROUNDED);
    CHECK(v.share_of_bound[kind] > 0.0 && v.share_of_bound[kind] < 0.5);
    *numbers[kind] = kept + v.greatest[kind];
    v = judged(context, &scene, profile, is_raw, &g, classes);
    CHECK(!v.pass && v.gaussians[CONIC_PIXEL_WRONG] == 1 && classes[at] == CONIC_PIXEL_WRONG && v.n_worst == 1);
    CHECK(v.worst[0].gaussian == at && v.worst[0].kind == kind && v.worst[0].number == places[kind]);
    CHECK(v.worst[0].low < kept && v.worst[0].high > kept && v.worst[0].high < *numbers[kind] && v.wrong[kind] == 1);
    g.lacks = (uint64_t)1 << kind; /* what is not there is not judged */
    CHECK(judged(context, &scene, profile, is_raw, &g, NULL).pass);
    g.lacks = 0;
    *numbers[kind] = NAN;
    CHECK(judged(context, &scene, profile, is_raw, &g, NULL).gaussians[CONIC_PIXEL_WRONG] == 1);
    *numbers[kind] = kept;
  }
  for (size_t i = 0; i < N_GAUSSIANS; i++)
    g.opacity[i] *= 0.5;
  v = judged(context, &scene, profile, is_raw, &g, NULL);
  CHECK(!v.pass && v.n_worst == CONIC_MAX_FAULTS && v.wrong[CONIC_GRADIENT_OPACITY] > 20);
  conic_gaussian_gradient_release(context, &g);
  conic_gaussians_release(context, &scene);
}

/* Another program's decision at the edge: Gaussian 0, which is nearest to the eye and faint, has α of 1/255 but for a
 * rounding at the middle pixel, and the other program leaves it out, or two of equal depth come the other way round. */
static void test_explained(conic_context *context, int is_order) {
  const conic_gaussian_profile profile = CONIC_PROFILE_GSPLAT_1_6;
  conic_gaussians scene = gaussians_random(context, 12, 0, 0);
  for (size_t i = 0; i < scene.count; i++) {
    for (int k = 0; k < 3; k++) {
      scene.position[k][i] = k == 2 ? 0.25f * (float)i : 0.02f * (float)i;
      scene.scale[k][i] = 0.2f;
    }
    scene.opacity[i] = 0.5f;
  }
  conic_camera centered = camera;
  centered.cx = centered.cy = 20.5; /* of the middle pixel */
  const float least = is_order ? 0.5f : (float)(1.0 / 255.0);
  scene.opacity[0] = least * (1.0f + 0x1p-23f);
  if (is_order)
    scene.position[2][1] = 0x1p-24f;
  const conic_gaussian_options options = gradient_test_options(profile);
  conic_gaussian_gradient g;
  CHECK_OK(conic_gaussian_gradient_find(context, &scene, &centered, &options, &weights, NULL, &g));
  scene.opacity[0] = is_order ? scene.opacity[0] : least * (1.0f - 0x1p-22f);
  scene.position[2][0] = is_order ? 0x1p-20f : scene.position[2][0];
  conic_gradient_verdict v;
  CHECK_OK(conic_gaussian_gradient_judge(context, &scene, &centered, &options, &weights, NULL, &g, NULL, &v));
  CHECK(v.pass && v.gaussians[CONIC_PIXEL_EXPLAINED] >= 1);
  CHECK(v.gaussians[CONIC_PIXEL_EXPLAINED] + v.gaussians[CONIC_PIXEL_ROUNDED] <= scene.count);
  conic_float_model own; /* floats that decide as the double run does have no such excuse */
  conic_gradient_options how;
  conic_gradient_options_init(&how);
  conic_float_model_init(&own, CONIC_FLOATS_OWN);
  how.model = &own;
  scene.opacity[0] = is_order ? scene.opacity[0] : least * 0.999f;
  scene.position[2][0] = is_order ? 0x1p-8f : scene.position[2][0];
  CHECK_OK(conic_gaussian_gradient_judge(context, &scene, &centered, &options, &weights, &how, &g, NULL, &v));
  CHECK(!v.pass);
  conic_gaussian_gradient_release(context, &g);
  conic_gaussians_release(context, &scene);
}

/* What was written is read as it was, and files that are none are refused. */
static void test_gradient_files(conic_context *context) {
  conic_gaussians scene = gaussians_random(context, 30, 2, 0);
  conic_gaussian_gradient g = own_gradient(context, &scene, CONIC_PROFILE_GSPLAT_1_5, 0), read;
  const char *path = files_path("gradient.ply");
  CHECK_OK(conic_gaussian_gradient_write(context, path, &g));
  CHECK_OK(conic_gaussian_gradient_read(context, path, &read));
  CHECK(read.count == 30 && read.sh_degree == 2 && read.lacks == 0);
  CHECK(memcmp(read.sh, g.sh, 30 * 27 * sizeof *g.sh) == 0 &&
        memcmp(read.opacity, g.opacity, 30 * sizeof(double)) == 0);
  for (int k = 0; k < 4; k++) {
    CHECK(memcmp(read.rotation[k], g.rotation[k], 30 * sizeof(double)) == 0);
    CHECK(k == 3 || memcmp(read.mean[k], g.mean[k], 30 * sizeof(double)) == 0);
    CHECK(k == 3 || memcmp(read.scale[k], g.scale[k], 30 * sizeof(double)) == 0);
  }
  conic_gaussian_gradient_release(context, &read);
  CHECK(remove(path) == 0);
  path = files_write("other.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float opacity\n"
                                  "property list uchar int q\nend_header\n1 0\n");
  CHECK(conic_gaussian_gradient_read(context, path, &read) == CONIC_ERROR_INPUT);
  CHECK(remove(path) == 0);
  path =
      files_write("short.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float opacity\nend_header\n1\n2\n");
  CHECK(conic_gaussian_gradient_read(context, path, &read) == CONIC_ERROR_INPUT && read.count == 0);
  CHECK(remove(path) == 0);
  path =
      files_write("some.ply", "ply\nformat ascii 1.0\nelement vertex 2\nproperty float opacity\nend_header\n1.5\n2\n");
  CHECK_OK(conic_gaussian_gradient_read(context, path, &read));
  CHECK(read.count == 2 && read.opacity[0] == 1.5 && read.lacks == 55 && remove(path) == 0);
  conic_gaussian_gradient_release(context, &read);
  conic_gaussian_gradient_release(context, &g);
  conic_gaussians_release(context, &scene);
}

static void test_judge_refusals(conic_context *context) {
  conic_gaussians scene = gaussians_random(context, 20, 1, 0), fewer = gaussians_random(context, 19, 1, 0);
  conic_gaussian_gradient g = own_gradient(context, &scene, CONIC_PROFILE_GSPLAT_1_6, 0);
  conic_gradient_verdict v;
  conic_gaussian_options options = gradient_test_options(CONIC_PROFILE_EXACT);
  CHECK(conic_gaussian_gradient_judge(context, &scene, &camera, &options, &weights, NULL, &g, NULL, &v) ==
        CONIC_ERROR_UNSUPPORTED);
  options = gradient_test_options(CONIC_PROFILE_GSPLAT_1_6);
  CHECK(conic_gaussian_gradient_judge(context, &fewer, &camera, &options, &weights, NULL, &g, NULL, &v) ==
        CONIC_ERROR_ARGUMENT);
  g.sh_degree = 0;
  CHECK(conic_gaussian_gradient_judge(context, &scene, &camera, &options, &weights, NULL, &g, NULL, &v) ==
        CONIC_ERROR_ARGUMENT);
  g.sh_degree = 1;
  CHECK(strcmp(conic_gradient_kind_name(CONIC_GRADIENT_SH), "sh") == 0 &&
        !conic_gradient_kind_name((conic_gradient_kind)CONIC_N_GRADIENT_KINDS));
  conic_gaussian_gradient_release(context, &g);
  conic_gaussians_release(context, &scene);
  conic_gaussians_release(context, &fewer);
}

int main(void) {
  conic_context *context = files_context();
  uint64_t state = 17;
  for (int i = 0; i < 3 * SIDE * SIDE; i++)
    weight_numbers[i] = 2.0 * random_unit(&state) - 1.0;
  for (int i = 0; i < SIDE * SIDE; i++)
    alpha_numbers[i] = 2.0 * random_unit(&state) - 1.0;
  test_gradient_classes(context, CONIC_PROFILE_GSPLAT_1_6_AA, 0);
  test_gradient_classes(context, CONIC_PROFILE_INRIA_2023, 1);
  test_explained(context, 0);
  test_explained(context, 1);
  test_gradient_files(context);
  test_judge_refusals(context);
  files_end(context);
  return check_result();
}
