/* Long lists of Gaussians in few tiles: what lanes leave out, put off or sort otherwise, they draw as plain C does. */
#include <math.h>

#include "tests/support/gaussian_picture.h"

enum { SIDE = 34 };

static conic_context *crowd_context(void) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options); /* silent where an instruction set is not here */
  options.threads = 2;
  if (conic_context_create(&options, &context) != CONIC_OK)
    exit(1);
  return context;
}

static conic_camera camera_before(double distance) {
  return (conic_camera){.width = SIDE,
                        .height = SIDE,
                        .fx = SIDE,
                        .fy = SIDE,
                        .cx = 0.5 * SIDE,
                        .cy = 0.5 * SIDE,
                        .cam_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, distance}}};
}

static void compare_profile(conic_context *context, const conic_gaussians *scene, double distance,
                            conic_gaussian_profile profile) {
  const conic_camera camera = camera_before(distance);
  conic_gaussian_planes plain = picture_draw(context, scene, &camera, profile, CONIC_ISA_SCALAR);
  uint64_t n_skipped = 0;
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++) {
    conic_gaussian_planes planes = picture_planes(&camera);
    conic_gaussian_statistics statistics;
    conic_gaussian_options options;
    conic_gaussian_options_init(&options);
    options.profile = profile;
    options.isa = (conic_isa)isa;
    float *normal = planes.normal;
    for (int has_normals = 1; has_normals >= 0; has_normals--) { /* without them, lanes set ellipses up */
      planes.normal = has_normals ? normal : NULL;
      conic_status status = conic_gaussians_render(context, scene, &camera, &options, &planes, &statistics);
      planes.normal = normal;
      n_skipped = isa == CONIC_ISA_SCALAR ? statistics.gaussians_skipped : n_skipped;
      if (status == CONIC_OK) /* the instruction set is here */
        CHECK(picture_is_same(&plain, &planes) && statistics.gaussians_skipped == n_skipped);
    }
    picture_release(&planes);
  }
  picture_release(&plain);
}

static void compare_instruction_sets(conic_context *context, const conic_gaussians *scene, double distance) {
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++)
    compare_profile(context, scene, distance, (conic_gaussian_profile)profile);
}

/* So faint that many lie one behind the other in each pixel, in batches; every fourth as another one but for colour. */
static void test_faint(conic_context *context) {
  enum { N = 900 };
  conic_gaussians scene = gaussians_random(context, N, 0, 0);
  for (size_t i = 0; i < N; i++) {
    float squares = 0.0f;
    scene.opacity[i] *= 0.05f;
    for (int k = 0; k < 4; k++)
      squares += scene.rotation[k][i] * scene.rotation[k][i];
    for (int k = 0; k < 4 && i % 8 < 4; k++) /* of length 1 up to roundings, which some profiles take as it is */
      scene.rotation[k][i] /= sqrtf(squares);
    for (int k = 0; k < 4 && i % 4 == 3; k++) {
      scene.rotation[k][i] = scene.rotation[k][i - 1];
      if (k < 3) {
        scene.position[k][i] = scene.position[k][i - 1];
        scene.scale[k][i] = scene.scale[k][i - 1];
      }
    }
  }
  compare_instruction_sets(context, &scene, 5.0);
  conic_gaussians_release(context, &scene);
}

/* The eye among needles, sheets, dots and what is wider than the scene, some of them with a sky behind. */
static void test_shapes(conic_context *context) {
  enum { N = 400 };
  static const float extremes[] = {1e-4f, 3.0f, 1e-3f, 20.0f, 1e-6f, 0.02f, 0.0f};
  conic_gaussians scene = gaussians_random(context, N, 0, 0);
  for (size_t i = 0; i < N; i++) {
    scene.scale[i % 3][i] = extremes[i % (sizeof extremes / sizeof *extremes)];
    if (i % 11 == 0)
      scene.opacity[i] = i % 2 ? 1.0f : 1e37f; /* beyond what the exponential can make faint */
    if (i % 13 == 0)
      scene.position[2][i] = 1e3f;
    for (int k = 0; k < 4 && i % 17 == 0; k++)
      scene.rotation[k][i] = 0.0f;
    if (i % 19 == 0)
      scene.position[i % 3][i] = NAN;
  }
  compare_instruction_sets(context, &scene, 0.5);
  compare_instruction_sets(context, &scene, 6.0);
  conic_gaussians_release(context, &scene);
}

/* So many that are all over the picture that they are sorted in parts; some lie at one place. */
static void test_long(conic_context *context) {
  enum { N = 4000 };
  conic_gaussians scene = gaussians_random(context, N, 0, 0);
  for (size_t i = 0; i < N; i++) {
    scene.opacity[i] = 0.02f + 0.001f * (float)(i % 3);
    for (int k = 0; k < 3; k++) {
      scene.scale[k][i] = 2.0f;
      scene.position[k][i] = i % 5 == 4 ? scene.position[k][i - 1] : scene.position[k][i];
    }
  }
  compare_profile(context, &scene, 9.0, CONIC_PROFILE_EXACT);
  conic_gaussians_release(context, &scene);
}

/* Sheets one behind the other, none of whose rays wait for the next, before what may be nearer than all. */
static void test_sheets(conic_context *context) {
  enum { N = 1300 };
  conic_gaussians scene = gaussians_random(context, N, 0, 0);
  for (size_t i = 0; i < N; i++) {
    scene.opacity[i] = 0.01f;
    for (int k = 0; k < 4; k++)
      scene.rotation[k][i] = k == 0 ? 1.0f : 0.0f;
    for (int k = 0; k < 3; k++) {
      scene.scale[k][i] = i == N - 1 ? 40.0f : k == 2 ? 1e-5f : 3.0f;
      scene.position[k][i] = k == 2 ? 0.03f * (float)i : 0.0f;
    }
  }
  compare_profile(context, &scene, 5.0, CONIC_PROFILE_EXACT);
  conic_gaussians_release(context, &scene);
}

/* khr-2026 never ends, so that what lies behind opaque ones counts, too. */
static void test_endless(conic_context *context) {
  enum { N = 150 };
  conic_gaussians scene = gaussians_random(context, N, 0, 0);
  const conic_camera camera = camera_before(5.0);
  for (size_t i = 0; i < N; i++) {
    scene.opacity[i] = 1.0f;
    for (int k = 0; k < 3; k++)
      scene.scale[k][i] = 1e7f;
  }
  conic_gaussian_planes p = picture_draw(context, &scene, &camera, CONIC_PROFILE_KHR_2026, CONIC_ISA_AUTO);
  for (size_t i = 0; i < SIDE * SIDE; i++)
    CHECK(p.transparency[i] == 0.0f && p.count[i] == N);
  picture_release(&p);
  conic_gaussians_release(context, &scene);
}

int main(void) {
  conic_context *context = crowd_context();
  test_faint(context);
  test_shapes(context);
  test_long(context);
  test_sheets(context);
  test_endless(context);
  conic_context_destroy(context);
  return check_result();
}
