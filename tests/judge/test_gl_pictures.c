/* What a GPU-style renderer draws, on whatever OpenGL there is (Mesa's llvmpipe), lies within the bounds of floats in
 * each profile; and outside of them with a mistake of those that people make. */
#include "conic/gaussian_judge.h"
#include "tests/judge/gl_device.h"
#include "tests/judge/gl_frame.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_fixture.h"

enum { WIDTH = 44, HEIGHT = 36 };

static const double from_world[3][4] = {{0.8, 0.0, 0.6, 0.1}, {0.0, 1.0, 0.0, -0.2}, {-0.6, 0.0, 0.8, 5.5}};

typedef struct gl_test {
  conic_context *context;
  const char *folder;    /* of the shaders */
  conic_gaussians scene; /* as conic reads the file */
  conic_camera camera;
  char path[2][4096]; /* of the scene and of the camera */
} gl_test;

/* Random ones; some nearly opaque, some dots, and some between the planes that are called near. */
static conic_gaussians make_scene(conic_context *context) {
  conic_gaussians made = gaussians_random(context, 120, 3, 0);
  for (size_t i = 0; i < 40; i++) {
    const double near = 0.04 + 0.015 * (double)i, seen[3] = {near * (0.1 * (double)i - 0.4), near * 0.1, near};
    made.opacity[i] = 0.9995f;
    for (size_t axis = 0; axis < 3; axis++) {
      double sum = 0.0;
      for (size_t row = 0; row < 3; row++)
        sum += from_world[row][axis] * (seen[row] - from_world[row][3]);
      made.position[axis][i] = i < 8 ? (float)sum : made.position[axis][i];
      made.scale[axis][i] *= i < 8 ? 0.05f : i > 30 ? 0.1f : 1.0f;
    }
  }
  for (size_t i = 0; i < made.count; i++)
    for (int k = 0; k < 4; k++)
      made.rotation[k][i] *= 1.2f;
  return made;
}

static void write_files(gl_test *t) {
  conic_gaussians_write_options options;
  conic_gaussians_read_options reading;
  conic_gaussians made = make_scene(t->context);
  conic_gaussians_write_options_init(&options);
  conic_gaussians_read_options_init(&reading);
  CHECK_OK(conic_gaussians_write(t->context, t->path[0], &made, &options));
  conic_gaussians_release(t->context, &made);
  FILE *file = fopen(t->path[1], "w");
  if (!file)
    exit(1);
  fprintf(file, "{\"width\": %d, \"height\": %d, \"fx\": 52, \"fy\": 50, \"cx\": 21, \"cy\": 19.5, ", WIDTH, HEIGHT);
  fprintf(file, "\"world_to_camera\": [");
  for (int row = 0; row < 3; row++)
    fprintf(file, "[%g, %g, %g, %g], ", from_world[row][0], from_world[row][1], from_world[row][2], from_world[row][3]);
  fprintf(file, "[0, 0, 0, 1]]}\n");
  fclose(file);
  CHECK_OK(conic_gaussians_read(t->context, t->path[0], &reading, &t->scene));
  CHECK_OK(conic_camera_read(t->context, t->path[1], &t->camera));
}

/* GLSL promises an eˣ to 3 + 2|x| ulp; llvmpipe's is off by up to 9.6 ulp, which is more than strict floats may be. */
static conic_gaussian_verdict judge_picture(gl_test *t, const char *profile, const plain_picture *p) {
  const unsigned planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_TRANSPARENCY;
  conic_image image;
  conic_gaussian_options options;
  conic_gaussian_judging judging;
  conic_gaussian_verdict verdict;
  conic_float_model model;
  conic_gaussian_options_init(&options);
  options.ignores_center = 1; /* as inria's does */
  for (int k = 0; k < CONIC_N_GAUSSIAN_PROFILES; k++)
    if (strcmp(conic_gaussian_profile_name((conic_gaussian_profile)k), profile) == 0)
      options.profile = (conic_gaussian_profile)k;
  conic_float_model_init(&model, CONIC_FLOATS_FAST);
  conic_gaussian_judging_init(&judging);
  judging.model = &model;
  CHECK_OK(conic_image_allocate(t->context, p->width, p->height, planes, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
    memcpy(rgba + 4 * i, p->rgb + 3 * i, 3 * sizeof *rgba);
    rgba[4 * i + 3] = p->alpha[i];
  }
  memcpy(image.planes[CONIC_PLANE_Z], p->z, sizeof(float) * WIDTH * HEIGHT);
  memcpy(image.planes[CONIC_PLANE_TRANSPARENCY], p->T, sizeof(float) * WIDTH * HEIGHT);
  CHECK_OK(conic_gaussian_judge(t->context, &t->scene, &t->camera, &options, &judging, &image, NULL, &verdict));
  conic_image_release(t->context, &image);
  return verdict;
}

/* A fault that changes nothing is none. */
static int can_have(const char *profile, int fault) {
  const int is_khr = strcmp(profile, "khr-2026") == 0, is_inria = strcmp(profile, "inria-2023") == 0;
  switch (fault) {
  case PLAIN_ALPHA_MAX_0_99:
    return strncmp(profile, "gsplat-1.5", 10) == 0 || is_khr;
  case PLAIN_ALPHA_MAX_0_999:
    return strncmp(profile, "gsplat-1.5", 10) != 0;
  case PLAIN_DILATION_0:
  case PLAIN_EXTENT_3_SIGMA:
  case PLAIN_ORDER_DISTANCE:
    return !is_khr;
  case PLAIN_CENTRE_IGNORED:
    return !is_inria;
  default:
    return fault < PLAIN_AFFINE;
  }
}

/* Draws with a fault, or with none (−1). */
static void judge_fault(gl_test *t, const char *profile, int fault) {
  const gl_order order = {t->folder, profile, fault < 0 ? 0 : 1u << fault};
  plain_scene scene = plain_scene_read(t->path[0], order.faults);
  plain_camera camera = plain_camera_read(t->path[1]);
  plain_picture picture = plain_picture_allocate(camera.width, camera.height);
  gl_draw(&order, &scene, &camera, &picture);
  const conic_gaussian_verdict v = judge_picture(t, profile, &picture);
  printf("%-14s %-24s wrong %zu of %zu", profile, fault < 0 ? "right" : plain_fault_names[fault],
         v.pixels[CONIC_PIXEL_WRONG], v.judged_pixels);
  if (v.n_worst)
    printf(", worst %d,%d %s[%d]: %.9g not in %.9g to %.9g", v.worst[0].x, v.worst[0].y,
           conic_plane_describe((conic_plane)v.worst[0].plane)->name, v.worst[0].channel, v.worst[0].found,
           v.worst[0].low, v.worst[0].high);
  printf("\n");
  CHECK(v.pass == (fault < 0) && v.covered_pixels > WIDTH * HEIGHT / 2);
  plain_picture_release(&picture);
  plain_scene_release(&scene);
}

/* Every fault in one profile, and one more in each of the others. */
int main(int n, char **words) {
  static const char *const profiles[] = {"gsplat-1.6", "inria-2023", "gsplat-1.5-aa", "khr-2026"};
  static const int one_more[] = {0, PLAIN_HALF_PIXEL, PLAIN_NEAR, PLAIN_ORDER_FILE};
  const char *reason;
  char folder[4096];
  gl_test t = {.folder = folder};
  if (!gl_open(&reason)) {
    printf("skipped: %s\n", reason);
    return 77;
  }
  snprintf(folder, sizeof folder, "%s/tests/judge", n > 1 ? words[1] : ".");
  t.context = files_context();
  snprintf(t.path[0], sizeof t.path[0], "%s", files_path("scene.ply"));
  snprintf(t.path[1], sizeof t.path[1], "%s", files_path("camera.json"));
  write_files(&t);
  for (int k = 0; k < 4; k++)
    judge_fault(&t, profiles[k], -1);
  for (int k = 0; k < 4; k++)
    for (int fault = 0; fault < PLAIN_N_FAULTS; fault++)
      if (can_have(profiles[k], fault) && (k == 0 || fault == one_more[k]))
        judge_fault(&t, profiles[k], fault);
  conic_gaussians_release(t.context, &t.scene);
  remove(t.path[0]);
  remove(t.path[1]);
  files_end(t.context);
  return check_result();
}
