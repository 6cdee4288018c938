/* Bounds of what floats make of Gaussian scenes are never violated: by the renderer, by the double run, and by an
 * evaluator of this test's own, which rounds, fuses and orders at random. They are tight enough to see what is wrong.
 */
#include "conic/gaussian_judge.h"
#include "core/base/memory.h"
#include "core/splats/gaussian_profile.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_picture.h"
#include "tests/support/random_floats.h"

static conic_camera camera_from(double distance, int width, int height) {
  conic_camera camera = {
      .width = width, .height = height, .fx = 1.1 * width, .fy = 1.15 * width, .cx = 0.5 * width, .cy = 0.5 * height};
  for (int axis = 0; axis < 3; axis++)
    camera.cam_from_world[axis][axis] = 1.0;
  camera.cam_from_world[2][3] = distance;
  return camera;
}

/* The picture that the library draws, as an image with every plane of Gaussian scenes. */
static conic_image image_of(conic_context *context, const conic_gaussian_planes *p) {
  const unsigned planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL |
                          1u << CONIC_PLANE_COUNT | 1u << CONIC_PLANE_ID | CONIC_GAUSSIAN_PLANES;
  const size_t n = (size_t)p->width * (size_t)p->height;
  conic_image image;
  CHECK_OK(conic_image_allocate(context, p->width, p->height, planes, &image));
  for (size_t i = 0; i < n; i++) {
    float *rgba = (float *)image.planes[CONIC_PLANE_RGBA] + 4 * i, *normal = (float *)image.planes[CONIC_PLANE_NORMAL];
    double length = 0.0;
    for (size_t c = 0; c < 3; c++) {
      rgba[c] = p->rgb[3 * i + c];
      length += (double)p->normal[3 * i + c] * (double)p->normal[3 * i + c];
    }
    rgba[3] = 1.0f - p->transparency[i];
    for (size_t c = 0; c < 3 && length > 0.0; c++)
      normal[3 * i + c] = (float)((double)p->normal[3 * i + c] / sqrt(length));
  }
  memcpy(image.planes[CONIC_PLANE_Z], p->z, n * sizeof(float));
  memcpy(image.planes[CONIC_PLANE_COUNT], p->count, n * sizeof(float));
  memcpy(image.planes[CONIC_PLANE_ID], p->id, n * sizeof(float));
  memcpy(image.planes[CONIC_PLANE_TRANSPARENCY], p->transparency, n * sizeof(float));
  memcpy(image.planes[CONIC_PLANE_MEDIAN_Z], p->median_z, n * sizeof(float));
  memcpy(image.planes[CONIC_PLANE_INVERSE_Z], p->inverse_z, n * sizeof(float));
  memcpy(image.planes[CONIC_PLANE_LAST], p->last, n * sizeof(float));
  return image;
}

static conic_gaussian_verdict judge_image(conic_context *context, const conic_gaussians *scene,
                                          const conic_camera *camera, int profile, const conic_image *image) {
  conic_gaussian_options options;
  conic_gaussian_verdict verdict;
  conic_gaussian_options_init(&options);
  options.profile = (conic_gaussian_profile)profile;
  options.ignores_center = 1;
  CHECK_OK(conic_gaussian_judge(context, scene, camera, &options, NULL, image, NULL, &verdict));
  return verdict;
}

static void tell_verdict(const char *scene, int profile, const conic_gaussian_verdict *v) {
  printf("%-9s %-14s rgb ±%.2g (off %.2g), Z ±%.2g, N ±%.2g; doubtful %zu, explained %zu, wide %zu, wrong %zu of %zu\n",
         scene, conic_gaussian_profile_name((conic_gaussian_profile)profile), v->planes[CONIC_PLANE_RGBA].bound,
         v->planes[CONIC_PLANE_RGBA].max_abs, v->planes[CONIC_PLANE_Z].bound, v->planes[CONIC_PLANE_NORMAL].bound,
         v->doubtful_pixels, v->pixels[CONIC_PIXEL_EXPLAINED], v->wide_pixels, v->pixels[CONIC_PIXEL_WRONG],
         v->judged_pixels);
  for (int k = 0; k < v->n_worst; k++)
    printf("  worst %d,%d %s[%d]: %.9g not in %.9g to %.9g\n", v->worst[k].x, v->worst[k].y,
           conic_plane_describe((conic_plane)v->worst[k].plane)->name, v->worst[k].channel, v->worst[k].found,
           v->worst[k].low, v->worst[k].high);
}

/* The renderer's picture lies within the bounds, and the double run's. */
static void judge_renderer(conic_context *context, const char *name, const conic_gaussians *scene,
                           const conic_camera *given) {
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_camera own = *given, *camera = &own;
    if (conic_profile_row_of((conic_gaussian_profile)profile)->takes_middle) /* which take the middle */
      own.cx = 0.5 * own.width;
    conic_gaussian_planes p = picture_draw(context, scene, camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
    conic_image image = image_of(context, &p);
    conic_gaussian_verdict verdict = judge_image(context, scene, camera, profile, &image);
    tell_verdict(name, profile, &verdict);
    CHECK(verdict.pass && verdict.judged_pixels == (size_t)camera->width * (size_t)camera->height);
    conic_image_release(context, &image);
    picture_release(&p);
  }
}

/* What breaks others: at the eye, behind it, tiny, huge, needles, plates, NaN, no rotation, equal depths. */
static void test_hostile(conic_context *context) {
  for (uint64_t seed = 1; seed <= 3; seed++) {
    conic_gaussians scene = gaussians_random(context, 60, 1, 0);
    const conic_camera camera = camera_from(seed == 1 ? 4.0 : 1.5, 40, 30);
    uint64_t state = seed;
    for (size_t i = 0; i < scene.count; i++) {
      for (int k = 0; k < 3; k++)
        scene.scale[k][i] = (float)exp(-9.0 + 9.0 * random_unit(&state));
      scene.opacity[i] = i % 3 == 0 ? 1.0f : (float)random_unit(&state);
      if (i % 6 == 1)
        scene.position[2][i] = scene.position[2][i - 1];
    }
    scene.scale[0][0] = scene.scale[1][0] = scene.scale[2][0] = 1e-9f;
    scene.scale[0][1] = scene.scale[1][1] = scene.scale[2][1] = 1e9f;
    scene.opacity[1] = 0.1f;
    scene.scale[2][2] = 0.0f;
    scene.scale[1][3] = -1.0f;
    scene.position[1][4] = NAN;
    for (int k = 0; k < 4; k++)
      scene.rotation[k][5] = 0.0f;
    scene.position[0][6] = scene.position[1][6] = 0.0f;
    scene.position[2][6] = -(float)camera.cam_from_world[2][3]; /* at the eye */
    scene.position[2][7] = -10.0f;
    for (int k = 0; k < 4; k++)
      scene.rotation[k][8] *= 3.0f;
    judge_renderer(context, "hostile", &scene, &camera);
    conic_gaussians_release(context, &scene);
  }
}

static void test_renderer(conic_context *context) {
  for (int degree = 0; degree <= 4; degree += 2) {
    conic_gaussians scene = gaussians_random(context, 300, degree, degree == 2 ? CONIC_GAUSSIANS_HALF : 0);
    conic_camera camera = camera_from(degree ? 5.0 : 1.0, 70, 50);
    camera.cx += degree;
    judge_renderer(context, degree ? "random" : "inside", &scene, &camera);
    conic_gaussians_release(context, &scene);
  }
  conic_gaussians flat = gaussians_random(context, 200, 1, CONIC_GAUSSIANS_2D);
  conic_camera camera = camera_from(4.0, 50, 60);
  judge_renderer(context, "flat", &flat, &camera);
  conic_gaussians_release(context, &flat);
}

/* Some thirty Gaussians before the eye, many of which meet any pixel: round, flat and needles, faint and opaque, and
 * some in pairs of equal depth. */
static conic_gaussians random_crowd(conic_context *context, uint64_t seed) {
  conic_gaussians scene;
  uint64_t state = seed;
  CHECK_OK(conic_gaussians_allocate(context, 30, 1, 0, &scene));
  for (size_t i = 0; i < scene.count; i++) {
    for (int k = 0; k < 4; k++)
      scene.rotation[k][i] = (float)(2.0 * random_unit(&state) - 1.0);
    for (int k = 0; k < 3; k++) {
      scene.position[k][i] = (float)((k == 2 ? 2.0 : 0.8) * (2.0 * random_unit(&state) - 1.0));
      scene.scale[k][i] = (float)exp(-5.0 + 4.5 * random_unit(&state));
    }
    if (i % 5 == 1)
      scene.position[2][i] = scene.position[2][i - 1];
    scene.opacity[i] = i % 4 == 0 ? 1.0f : i % 7 == 0 ? 1.0f / 255.0f : (float)random_unit(&state);
    for (size_t k = 0; k < 12; k++)
      scene.sh[12 * i + k] = (float)(2.0 * random_unit(&state) - 1.0);
  }
  return scene;
}

/* How often something else than the least and the most was found, and how far apart these are. */
typedef struct random_tally {
  size_t n, n_outside;
  double widest, sum_of_widths, greatest_share; /* of the way from the value to a bound */
} random_tally;

static void hold_value(const conic_gaussian_bound *b, int channel, double found, random_tally *tally) {
  double room =
      found > b->value[channel] ? b->most[channel] - b->value[channel] : b->value[channel] - b->least[channel];
  tally->n_outside += !(found >= b->least[channel] && found <= b->most[channel]);
  if (room > 0.0 && b->doubts == 0 && channel < 3)
    tally->greatest_share = fmax(tally->greatest_share, fabs(found - b->value[channel]) / room);
}

static void hold_pixel(const conic_gaussian_bound *b, const random_pixel *p, random_tally *tally) {
  for (int c = 0; c < 3; c++) {
    hold_value(b, CONIC_BOUND_RGB + c, p->rgb[c], tally);
    tally->sum_of_widths += (b->most[c] - b->least[c]) / 3.0;
  }
  hold_value(b, CONIC_BOUND_T, p->T, tally);
  hold_value(b, CONIC_BOUND_Z, p->z, tally);
  hold_value(b, CONIC_BOUND_INVERSE_Z, p->inverse_z, tally);
  hold_value(b, CONIC_BOUND_COUNT, (double)p->count, tally);
  tally->n++;
}

/* Each scene's pixels, in every manner of rounding. */
static void hold_scene(conic_context *context, int kind, conic_gaussian_profile profile, uint64_t seed,
                       random_tally *tally) {
  enum { SIDE = 8 };
  static const double exp_off[3] = {1.1 * 0x1p-23, 2.0 * 0x1p-23, 0x1p-21}, by_argument[3] = {0.0, 0.0, 0x1p-23};
  const conic_camera camera = camera_from(3.5, SIDE, SIDE);
  conic_gaussians scene = random_crowd(context, seed);
  conic_gaussian_bound bounds[SIDE * SIDE];
  conic_gaussian_options options;
  conic_float_model model;
  conic_gaussian_options_init(&options);
  options.profile = profile;
  conic_float_model_init(&model, (conic_float_kind)kind);
  CHECK_OK(conic_gaussian_bound_pixels(context, &scene, &camera, &options, &model, NULL, SIDE * SIDE, bounds));
  for (int i = 0; i < 5 * SIDE * SIDE; i++) {
    random_floats floats = {.state = seed * 977 + (uint64_t)i,
                            .manner = i % 5,
                            .is_fused = i & 1,
                            .is_setup_in_float = kind != CONIC_FLOATS_OWN,
                            .exp_off = exp_off[kind],
                            .exp_by_argument = by_argument[kind]};
    int at = i / 5;
    random_pixel pixel = random_draw(&floats, &scene, &camera, profile, at % SIDE + 0.5, at / SIDE + 0.5);
    hold_pixel(&bounds[at], &pixel, tally);
  }
  conic_gaussians_release(context, &scene);
}

static void test_random_floats(conic_context *context) {
  static const conic_gaussian_profile profiles[] = {CONIC_PROFILE_GSPLAT_1_6, CONIC_PROFILE_GSPLAT_1_6_AA,
                                                    CONIC_PROFILE_KHR_2026, CONIC_PROFILE_EXACT};
  for (int kind = 0; kind < CONIC_N_FLOAT_KINDS; kind++)
    for (size_t k = 0; k < 4; k++) {
      random_tally tally = {.n = 0};
      if (profiles[k] == CONIC_PROFILE_EXACT && kind != CONIC_FLOATS_OWN)
        continue;
      for (uint64_t seed = 1; seed <= 4; seed++)
        hold_scene(context, kind, profiles[k], 100 * (uint64_t)kind + seed, &tally);
      printf("floats %d %-14s %zu evaluations, %zu outside; mean width %.2g, %.2g of the way\n", kind,
             conic_gaussian_profile_name(profiles[k]), tally.n, tally.n_outside, tally.sum_of_widths / (double)tally.n,
             tally.greatest_share);
      CHECK(tally.n_outside == 0);
    }
}

/* Round Gaussians of one scale on the axis of a camera that sees the middle pixel at 16.5, at these depths. */
static conic_gaussians on_the_axis(conic_context *context, size_t n, const float *z, const float *opacity) {
  conic_gaussians scene;
  CHECK_OK(conic_gaussians_allocate(context, n, 0, 0, &scene));
  for (size_t i = 0; i < n; i++) {
    for (int k = 0; k < 3; k++) {
      scene.position[k][i] = k == 2 ? z[i] : 0.0f;
      scene.scale[k][i] = 0.125f;
      scene.sh[3 * i + (size_t)k] = i % 2 ? 1.0f : -1.0f;
    }
    for (int k = 0; k < 4; k++)
      scene.rotation[k][i] = k == 0 ? 1.0f : 0.0f;
    scene.opacity[i] = opacity[i];
  }
  return scene;
}

/* What is in doubt of one or two such Gaussians at a pixel so far to the right of the middle. */
static conic_gaussian_bound bound_on_axis(conic_context *context, conic_gaussian_profile profile, conic_float_kind kind,
                                          size_t n, const float *z, const float *opacity, int right) {
  const conic_camera camera = {.width = 33,
                               .height = 33,
                               .fx = 32.0,
                               .fy = 32.0,
                               .cx = 16.5,
                               .cy = 16.5,
                               .cam_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  const uint32_t pixel = 16 * 33 + 16 + (uint32_t)right;
  conic_gaussians scene = on_the_axis(context, n, z, opacity);
  conic_gaussian_bound bound;
  conic_gaussian_options options;
  conic_float_model model;
  conic_gaussian_options_init(&options);
  options.profile = profile;
  conic_float_model_init(&model, kind);
  CHECK_OK(conic_gaussian_bound_pixels(context, &scene, &camera, &options, &model, &pixel, 1, &bound));
  conic_gaussians_release(context, &scene);
  return bound;
}

static int has_doubt(const conic_gaussian_bound *b, conic_gaussian_doubt doubt) {
  return b->kinds >> doubt & 1;
}

static double width_of_T(const conic_gaussian_bound *b) {
  return b->most[CONIC_BOUND_T] - b->least[CONIC_BOUND_T];
}

/* Each decision is in doubt where it is made at its edge, and not beside it. */
static void test_doubts(conic_context *context) {
  static const float at[2] = {4.0f, 4.0f}, apart[2] = {4.0f, 4.01f}, near[1] = {0.2f}, off_near[1] = {0.2001f};
  const float least = 1.0f / 255.0f, faint[1] = {least}, fainter[1] = {least * 0.999f}, half[2] = {0.5f, 0.5f};
  const float most[2] = {0.99f, 0.99f}, less[2] = {0.98f, 0.99f};
  const conic_gaussian_profile exact = CONIC_PROFILE_EXACT, gsplat = CONIC_PROFILE_GSPLAT_1_6;
  conic_gaussian_bound b = bound_on_axis(context, exact, CONIC_FLOATS_OWN, 1, at, faint, 0);
  CHECK(has_doubt(&b, CONIC_DOUBT_LEAST) && b.least[CONIC_BOUND_COUNT] == 0.0 && b.most[CONIC_BOUND_COUNT] == 1.0);
  CHECK(b.n_id == 2 && b.n_last == 2 && b.doubts == 1);
  b = bound_on_axis(context, exact, CONIC_FLOATS_OWN, 1, at, fainter, 0);
  CHECK(b.kinds == 0 && b.most[CONIC_BOUND_COUNT] == 0.0 && b.n_id == 1 && b.id[0] == CONIC_NO_ID);
  b = bound_on_axis(context, exact, CONIC_FLOATS_OWN, 2, at, half, 1);
  CHECK(has_doubt(&b, CONIC_DOUBT_ORDER) && b.doubts == 1 && b.most[0] - b.least[0] > 0.01);
  CHECK(b.high[0] - b.low[0] < 1e-5 && b.n_last == 2);
  b = bound_on_axis(context, exact, CONIC_FLOATS_OWN, 2, apart, half, 1);
  CHECK(b.kinds == 0 && b.n_last == 1 && b.most[0] - b.least[0] < 1e-5);
  b = bound_on_axis(context, gsplat, CONIC_FLOATS_OWN, 2, at, half, 1); /* the file's order decides */
  CHECK(b.kinds == 0);
  b = bound_on_axis(context, gsplat, CONIC_FLOATS_STRICT, 2, at, half, 1);
  CHECK(has_doubt(&b, CONIC_DOUBT_ORDER));
  b = bound_on_axis(context, exact, CONIC_FLOATS_OWN, 2, apart, most, 0);
  CHECK(has_doubt(&b, CONIC_DOUBT_END) && has_doubt(&b, CONIC_DOUBT_MOST) && b.n_last == 2);
  b = bound_on_axis(context, exact, CONIC_FLOATS_OWN, 2, apart, less, 0);
  CHECK(!has_doubt(&b, CONIC_DOUBT_END) && b.most[CONIC_BOUND_COUNT] == 2.0);
  CHECK(width_of_T(&b) < 1e-7);
  b = bound_on_axis(context, gsplat, CONIC_FLOATS_STRICT, 2, apart, less, 0);
  CHECK(width_of_T(&b) < 1e-7);
  b = bound_on_axis(context, CONIC_PROFILE_KHR_2026, CONIC_FLOATS_STRICT, 2, apart, less, 0); /* blended: 1 − A */
  CHECK(width_of_T(&b) > 4.0 * 0x1p-24 && width_of_T(&b) < 1e-6);
  b = bound_on_axis(context, CONIC_PROFILE_KHR_2026, CONIC_FLOATS_OWN, 2, apart, less, 0);
  CHECK(width_of_T(&b) < 1e-7);
  b = bound_on_axis(context, CONIC_PROFILE_INRIA_2023, CONIC_FLOATS_STRICT, 1, near, half, 0);
  CHECK(has_doubt(&b, CONIC_DOUBT_NEAR) && b.least[CONIC_BOUND_COUNT] == 0.0 && b.most[CONIC_BOUND_COUNT] == 1.0);
  b = bound_on_axis(context, CONIC_PROFILE_INRIA_2023, CONIC_FLOATS_STRICT, 1, off_near, half, 0);
  CHECK(b.kinds == 0 && b.least[CONIC_BOUND_COUNT] == 1.0);
  b = bound_on_axis(context, CONIC_PROFILE_KHR_2026, CONIC_FLOATS_OWN, 1, at, half, 3); /* 3 standard deviations */
  CHECK(has_doubt(&b, CONIC_DOUBT_EDGE) && b.least[CONIC_BOUND_COUNT] == 0.0);
  b = bound_on_axis(context, CONIC_PROFILE_KHR_2026, CONIC_FLOATS_OWN, 1, at, half, 4);
  CHECK(b.kinds == 0 && b.most[CONIC_BOUND_COUNT] == 0.0);
}

/* A needle that floats may make anything of is in doubt about it, not wherever its line leads to. */
static void test_needle(conic_context *context) {
  const conic_camera camera = {.width = 129,
                               .height = 129,
                               .fx = 32.0,
                               .fy = 32.0,
                               .cx = 64.5,
                               .cy = 64.5,
                               .cam_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  const uint32_t pixels[2] = {65 * 129 + 65, 124 * 129 + 124};
  const float z = 4.0f, opacity = 0.5f;
  conic_gaussians scene = on_the_axis(context, 1, &z, &opacity);
  conic_gaussian_bound bounds[2];
  conic_gaussian_options options;
  conic_float_model model;
  scene.scale[1][0] = scene.scale[2][0] = 1e-7f;
  scene.rotation[0][0] = 0.92388f;
  scene.rotation[3][0] = 0.38268f;
  conic_gaussian_options_init(&options);
  options.profile = CONIC_PROFILE_KHR_2026; /* which has no dilation */
  conic_float_model_init(&model, CONIC_FLOATS_STRICT);
  CHECK_OK(conic_gaussian_bound_pixels(context, &scene, &camera, &options, &model, pixels, 2, bounds));
  CHECK(bounds[0].kinds != 0 && bounds[0].least[CONIC_BOUND_COUNT] == 0.0);
  CHECK(bounds[1].kinds == 0 && bounds[1].most[CONIC_BOUND_COUNT] == 0.0);
  conic_gaussians_release(context, &scene);
}

/* Mistakes are wrong, however small, and the worst is named; some of the pixels are always the same ones. */
static void test_mistakes(conic_context *context) {
  conic_gaussians scene = gaussians_random(context, 300, 1, 0);
  const conic_camera camera = camera_from(5.0, 64, 48);
  const size_t middle = 24 * 64 + 32;
  conic_gaussian_planes p = picture_draw(context, &scene, &camera, CONIC_PROFILE_GSPLAT_1_6, CONIC_ISA_AUTO);
  conic_image image = image_of(context, &p);
  float *rgba = image.planes[CONIC_PLANE_RGBA], kept = rgba[4 * middle + 1];
  uint32_t *last = image.planes[CONIC_PLANE_LAST];
  rgba[4 * middle + 1] += 1e-4f;
  conic_gaussian_verdict v = judge_image(context, &scene, &camera, CONIC_PROFILE_GSPLAT_1_6, &image);
  CHECK(!v.pass && v.pixels[CONIC_PIXEL_WRONG] == 1 && v.n_worst == 1);
  CHECK(v.worst[0].x == 32 && v.worst[0].y == 24 && v.worst[0].plane == CONIC_PLANE_RGBA && v.worst[0].channel == 1);
  rgba[4 * middle + 1] = NAN;
  last[middle + 1]++;
  v = judge_image(context, &scene, &camera, CONIC_PROFILE_GSPLAT_1_6, &image);
  CHECK(v.pixels[CONIC_PIXEL_WRONG] == 2 && v.worst[0].x == 32 && v.worst[1].plane == CONIC_PLANE_LAST);
  rgba[4 * middle + 1] = kept;
  last[middle + 1]--;
  v = judge_image(context, &scene, &camera, CONIC_PROFILE_GSPLAT_1_6, &image);
  CHECK(v.pass && v.n_worst == 0);
  v = judge_image(context, &scene, &camera, CONIC_PROFILE_GSPLAT_1_6_AA, &image);
  CHECK(v.pixels[CONIC_PIXEL_WRONG] > 1000 && v.n_worst == CONIC_MAX_FAULTS);
  conic_gaussian_judging judging;
  conic_gaussian_judging_init(&judging);
  judging.n_pixels = 100;
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  options.profile = CONIC_PROFILE_GSPLAT_1_6;
  uint8_t *classes = calloc(64 * 48, 1);
  memset(classes, 255, 64 * 48);
  CHECK_OK(conic_gaussian_judge(context, &scene, &camera, &options, &judging, &image, classes, &v));
  size_t n_judged = 0;
  for (size_t i = 0; i < 64 * 48; i++)
    n_judged += classes[i] != 255;
  CHECK(v.pass && v.judged_pixels == 100 && n_judged == 100);
  free(classes);
  conic_image_release(context, &image);
  picture_release(&p);
  conic_gaussians_release(context, &scene);
}

/* What is listed of a pixel adds up to it. */
static void test_listing(conic_context *context) {
  conic_gaussians scene = gaussians_random(context, 300, 1, 0);
  const conic_camera camera = camera_from(5.0, 64, 48);
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_gaussian_options options;
    conic_gaussian_listing listing;
    conic_gaussian_options_init(&options);
    options.profile = (conic_gaussian_profile)profile;
    options.background[1] = 0.5f;
    CHECK_OK(conic_gaussian_explain(context, &scene, &camera, &options, NULL, NULL, 30, 22, &listing));
    double sum = 0.0, T = 1.0, key = -INFINITY;
    size_t n = 0;
    for (size_t i = 0; i < listing.n; i++) {
      const conic_gaussian_entry *e = &listing.entries[i];
      CHECK(e->key >= key && e->alpha_low <= e->alpha_high);
      key = e->key;
      if (e->part != CONIC_PART_COMPOSITED)
        continue;
      CHECK(e->before == T && e->after < T);
      T = e->after;
      sum += e->weight * e->color[1];
      n++;
    }
    CHECK(n >= (conic_profile_limits_axes(conic_profile_row_of(options.profile)) ? 1 : 3) &&
          (double)n == listing.bound.value[CONIC_BOUND_COUNT]);
    CHECK_NEAR(sum + 0.5 * T, listing.bound.value[1], 1e-12);
    CHECK_NEAR(T, listing.bound.value[CONIC_BOUND_T], 1e-12);
    conic_gaussian_listing_release(context, &listing);
  }
  conic_gaussians_release(context, &scene);
}

/* The double run that knows nothing of bounds is another program, and within them. */
static void test_double_run(conic_context *context) {
  conic_gaussians scene = gaussians_random(context, 200, 3, 0);
  const conic_camera camera = camera_from(4.0, 40, 30);
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    static conic_gaussian_bound bounds[40 * 30];
    conic_gaussian_reference r =
        picture_reference(context, &scene, &camera, (conic_gaussian_profile)profile, CONIC_GAUSSIAN_PROFILE);
    conic_gaussian_options options;
    double off = 0.0;
    size_t n_outside = 0;
    conic_gaussian_options_init(&options);
    options.profile = (conic_gaussian_profile)profile;
    CHECK_OK(conic_gaussian_bound_pixels(context, &scene, &camera, &options, NULL, NULL, 40 * 30, bounds));
    for (size_t i = 0; i < 40 * 30; i++) {
      for (size_t c = 0; c < 3; c++) {
        n_outside += !(r.rgb[3 * i + c] >= bounds[i].least[c] && r.rgb[3 * i + c] <= bounds[i].most[c]);
        if (!bounds[i].doubts)
          off = fmax(off, fabs(r.rgb[3 * i + c] - bounds[i].value[c]));
      }
      n_outside += !((double)r.count[i] >= bounds[i].least[CONIC_BOUND_COUNT] &&
                     (double)r.count[i] <= bounds[i].most[CONIC_BOUND_COUNT]);
    }
    /* Of a quaternion as it is, which float rounds to another length than 1, S⁻¹Rᵀ is not quite the inverse of R·S. */
    CHECK(n_outside == 0 && off < (profile == CONIC_PROFILE_2DGS_2024 ? 2e-6 : 1e-12));
    conic_gaussian_reference_release(context, &r);
  }
  conic_gaussians_release(context, &scene);
}

int main(void) {
  conic_context *context = check_context(2);
  test_renderer(context);
  test_hostile(context);
  test_random_floats(context);
  test_doubts(context);
  test_needle(context);
  test_mistakes(context);
  test_listing(context);
  test_double_run(context);
  conic_context_destroy(context);
  return check_result();
}
