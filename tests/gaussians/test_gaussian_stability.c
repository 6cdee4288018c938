/* Gaussians that are turned, moved by a hair, at a threshold, or of sizes that break others. Every case prints its
 * figures, which docs/notes/gaussians-measured.md quotes. */
#include "core/splats/gaussian_profile.h"
#include "gaussians/scene/harmonics.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_picture.h"

enum { SIDE = 33, MIDDLE = 16 * SIDE + 16 };

static const float least = 1.0f / 255.0f, stop = 1e-4f;

static int is_undilated(int profile) {
  const conic_profile_row *row = conic_profile_row_of((conic_gaussian_profile)profile);
  return row->shape == CONIC_SHAPE_ELLIPSE && row->dilation == 0.0;
}

static int is_antialiased(int profile) {
  const conic_profile_row *row = conic_profile_row_of((conic_gaussian_profile)profile);
  return row->shape == CONIC_SHAPE_ELLIPSE && row->dilation > 0.0 && row->compensation_least >= 0.0;
}

/* The eye is at (0, 0, −5); `turn` goes from the world's directions to the camera's. */
static conic_camera camera_turned(const double turn[3][3], int width, int height) {
  conic_camera camera = {
      .width = width, .height = height, .fx = 1.1 * width, .fy = 1.1 * width, .cx = 0.5 * width, .cy = 0.5 * height};
  for (int row = 0; row < 3; row++) {
    memcpy(camera.cam_from_world[row], turn[row], sizeof turn[row]);
    camera.cam_from_world[row][3] = 5.0 * turn[row][2];
  }
  return camera;
}

static const double no_turn[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/* About the axis through (w, x, y, z), of any length. */
static void turn_by(const double q[4], double turn[3][3]) {
  double n = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  double w = q[0] / n, x = q[1] / n, y = q[2] / n, z = q[3] / n;
  const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  memcpy(turn, rows, sizeof rows);
}

static void turn_scene(conic_gaussians *scene, const double q[4]) {
  double turn[3][3];
  conic_harmonics_turn harmonics;
  const size_t n = conic_harmonics_of_degree(scene->sh_degree);
  turn_by(q, turn);
  conic_harmonics_find_turn((const double(*)[3])turn, harmonics);
  double norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  double a = q[0] / norm, b = q[1] / norm, c = q[2] / norm, d = q[3] / norm;
  for (size_t i = 0; i < scene->count; i++) {
    double p[3], r[4];
    for (int k = 0; k < 3; k++)
      p[k] = (double)scene->position[k][i];
    for (int k = 0; k < 3; k++)
      scene->position[k][i] = (float)(turn[k][0] * p[0] + turn[k][1] * p[1] + turn[k][2] * p[2]);
    for (int k = 0; k < 4; k++)
      r[k] = (double)scene->rotation[k][i];
    scene->rotation[0][i] = (float)(a * r[0] - b * r[1] - c * r[2] - d * r[3]);
    scene->rotation[1][i] = (float)(a * r[1] + b * r[0] + c * r[3] - d * r[2]);
    scene->rotation[2][i] = (float)(a * r[2] - b * r[3] + c * r[0] + d * r[1]);
    scene->rotation[3][i] = (float)(a * r[3] + b * r[2] - c * r[1] + d * r[0]);
    conic_harmonics_apply(harmonics, scene->sh_degree, scene->sh + i * n);
  }
}

static double pictures_apart(const conic_gaussian_planes *a, const conic_gaussian_planes *b) {
  const size_t n = (size_t)a->width * (size_t)a->height;
  double most = 0.0;
  for (size_t i = 0; i < 3 * n; i++)
    most = fmax(most, fabs((double)a->rgb[i] - (double)b->rgb[i]));
  return most;
}

/* Scene and camera together, harmonics too: the same picture, but for what the rounded scene changes. */
static void test_turned_together(conic_context *context) {
  static const double turns[3][4] = {{0.9, 0.1, -0.3, 0.2}, {0.1, 0.7, 0.5, -0.4}, {0.5, -0.5, 0.5, 0.5}};
  for (int k = 0; k < 3; k++) {
    conic_gaussians scene = gaussians_random(context, 300, 3, 0), turned = gaussians_random(context, 300, 3, 0);
    double turn[3][3], back[3][3];
    turn_scene(&turned, turns[k]);
    turn_by(turns[k], turn);
    for (int row = 0; row < 3; row++)
      for (int column = 0; column < 3; column++)
        back[row][column] = turn[column][row];
    const conic_camera before = camera_turned(no_turn, 64, 64);
    conic_camera after = camera_turned((const double(*)[3])back, 64, 64);
    for (int row = 0; row < 3; row++)
      after.cam_from_world[row][3] = before.cam_from_world[row][3];
    for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
      conic_gaussian_planes a = picture_draw(context, &scene, &before, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
      conic_gaussian_planes b = picture_draw(context, &turned, &after, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
      double apart = pictures_apart(&a, &b);
      printf("turned together %d, %-13s %.2g\n", k, conic_gaussian_profile_name((conic_gaussian_profile)profile),
             apart);
      CHECK(apart <= 1e-5);
      picture_release(&a);
      picture_release(&b);
    }
    conic_gaussians_release(context, &scene);
    conic_gaussians_release(context, &turned);
  }
}

/* A quaternion of another length is the same rotation in every profile but splat-2023, which takes it as it is. */
static void test_quaternion_lengths(conic_context *context) {
  conic_gaussians scene = gaussians_random(context, 200, 1, 0), longer = gaussians_random(context, 200, 1, 0);
  const conic_camera camera = camera_turned(no_turn, 48, 48);
  for (size_t i = 0; i < scene.count; i++)
    for (int k = 0; k < 4; k++)
      longer.rotation[k][i] *= i % 2 ? 3.0f : 0.999f;
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_gaussian_profile name = (conic_gaussian_profile)profile;
    conic_gaussian_planes a = picture_draw(context, &scene, &camera, name, CONIC_ISA_AUTO);
    conic_gaussian_planes b = picture_draw(context, &longer, &camera, name, CONIC_ISA_AUTO);
    conic_gaussian_reference r = picture_reference(context, &longer, &camera, name, CONIC_GAUSSIAN_PROFILE);
    CHECK(name == CONIC_PROFILE_SPLAT_2023 || pictures_apart(&a, &b) <= 1e-5);
    CHECK(picture_difference(b.rgb, r.rgb, 3 * 48 * 48) <= 1e-5);
    conic_gaussian_reference_release(context, &r);
    picture_release(&a);
    picture_release(&b);
  }
  conic_gaussians_release(context, &scene);
  conic_gaussians_release(context, &longer);
}

/* The eye looks elsewhere: in `exact` a ray has its colour, wherever on the picture it goes through. */
static void test_same_ray(conic_context *context) {
  enum { WIDTH = 65, HEIGHT = 17 };
  conic_gaussians scene = gaussians_random(context, 300, 2, 0);
  const conic_camera ahead = camera_turned(no_turn, WIDTH, HEIGHT);
  double apart[CONIC_N_GAUSSIAN_PROFILES] = {0};
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_gaussian_planes a = picture_draw(context, &scene, &ahead, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
    for (int from = 2; from < WIDTH; from += 5)
      for (int to = 4; to < WIDTH; to += 9) {
        double angle = atan((from + 0.5 - ahead.cx) / ahead.fx) - atan((to + 0.5 - ahead.cx) / ahead.fx);
        const double turn[3][3] = {{cos(angle), 0, -sin(angle)}, {0, 1, 0}, {sin(angle), 0, cos(angle)}};
        const conic_camera aside = camera_turned(turn, WIDTH, HEIGHT);
        conic_gaussian_planes b =
            picture_draw(context, &scene, &aside, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
        for (int c = 0; c < 3; c++)
          apart[profile] = fmax(apart[profile], fabs((double)a.rgb[3 * (8 * WIDTH + from) + c] -
                                                     (double)b.rgb[3 * (8 * WIDTH + to) + c]));
        picture_release(&b);
      }
    printf("one ray in two pictures, %-13s %.2g\n", conic_gaussian_profile_name((conic_gaussian_profile)profile),
           apart[profile]);
    picture_release(&a);
  }
  CHECK(apart[CONIC_PROFILE_EXACT] <= 1e-5);
  CHECK(apart[CONIC_PROFILE_GSPLAT_1_6] > 1e-2 && apart[CONIC_PROFILE_KHR_2026] > 1e-2);
  conic_gaussians_release(context, &scene);
}

/* Two that overlap, the one to the right nearer by what a pan of ¼ pixel makes up for. */
static conic_gaussians make_pair(conic_context *context) {
  static const float z[2] = {0.0f, -0.0035f}, color[2][3] = {{0.9f, 0.1f, 0.3f}, {0.1f, 0.8f, 0.9f}};
  conic_gaussians scene = gaussians_random(context, 2, 0, 0);
  for (size_t i = 0; i < 2; i++) {
    for (int k = 0; k < 3; k++) {
      scene.position[k][i] = k == 2 ? z[i] : k == 1 ? 0.0f : i ? 0.5f : -0.5f;
      scene.scale[k][i] = 0.6f;
      scene.sh[3 * i + (size_t)k] = (color[i][k] - 0.5f) / 0.28209479f;
    }
    for (int k = 0; k < 4; k++)
      scene.rotation[k][i] = k == 0;
    scene.opacity[i] = 0.8f;
  }
  return scene;
}

/* Turning the eye by 1/256 pixel at a time, half a pixel in all. Where the order is that of means, the whole overlap
 * changes in one step. In `exact`, only pixels at the line where one Gaussian goes through the other. */
static void test_pan(conic_context *context) {
  enum { WIDTH = 64, HEIGHT = 48, STEPS = 128 };
  conic_gaussians scene = make_pair(context);
  int most_pixels[CONIC_N_GAUSSIAN_PROFILES] = {0};
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_gaussian_planes before = {0};
    double most = 0.0, mean_most = 0.0;
    for (int step = 0; step <= STEPS; step++) {
      double angle = atan(step / 256.0 / (1.1 * WIDTH)), roll = 0.4, c = cos(roll), s = sin(roll);
      const double turn[3][3] = {
          {c * cos(angle), s, -c * sin(angle)}, {-s * cos(angle), c, s * sin(angle)}, {sin(angle), 0, cos(angle)}};
      const conic_camera camera = camera_turned(turn, WIDTH, HEIGHT);
      conic_gaussian_planes p = picture_draw(context, &scene, &camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
      int n_pixels = 0;
      double sum = 0.0;
      for (int i = 0; step > 0 && i < WIDTH * HEIGHT; i++) {
        double apart = fabs((double)p.rgb[3 * i] - (double)before.rgb[3 * i]);
        n_pixels += apart > 0.01;
        sum += apart / (WIDTH * HEIGHT);
        most = fmax(most, apart);
      }
      mean_most = fmax(mean_most, sum);
      most_pixels[profile] = n_pixels > most_pixels[profile] ? n_pixels : most_pixels[profile];
      picture_release(&before);
      before = p;
    }
    picture_release(&before);
    printf("pan by 1/256 px, %-13s at most %d pixels by over 0.01 in a step, %.2g at most, %.2g in the mean\n",
           conic_gaussian_profile_name((conic_gaussian_profile)profile), most_pixels[profile], most, mean_most);
  }
  CHECK(most_pixels[CONIC_PROFILE_EXACT] <= 2);
  for (int profile = CONIC_PROFILE_INRIA_2023; profile < CONIC_PROFILE_KHR_2026; profile++)
    CHECK(most_pixels[profile] > 200);
  conic_gaussians_release(context, &scene);
}

/* Balls on the axis, nearest first, with these opacities. */
static conic_gaussians make_stack(conic_context *context, size_t n, const float *opacity) {
  conic_gaussians scene = gaussians_random(context, n, 0, 0);
  for (size_t i = 0; i < n; i++) {
    for (int k = 0; k < 3; k++) {
      scene.position[k][i] = k == 2 ? 0.25f * (float)i : 0.0f;
      scene.scale[k][i] = 0.3f;
    }
    for (int k = 0; k < 4; k++)
      scene.rotation[k][i] = k == 0;
    scene.opacity[i] = opacity[i];
  }
  return scene;
}

/* How many are composited in the middle, where each has its opacity, and T there; by plain C as by lanes. */
static uint32_t count_in_middle(conic_context *context, const conic_gaussians *scene, int profile, float *T) {
  const conic_camera camera = camera_turned(no_turn, SIDE, SIDE);
  conic_gaussian_planes p = picture_draw(context, scene, &camera, (conic_gaussian_profile)profile, CONIC_ISA_SCALAR);
  conic_gaussian_planes q = picture_draw(context, scene, &camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
  uint32_t count = p.count[MIDDLE];
  *T = p.transparency[MIDDLE];
  CHECK(picture_is_same(&p, &q));
  picture_release(&p);
  picture_release(&q);
  return count;
}

/* An opacity of 1/255 is drawn, and one that is an ulp below is not. */
static void test_least_alpha(conic_context *context) {
  const float opacities[3] = {nextafterf(least, 0.0f), least, nextafterf(least, 1.0f)};
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++)
    for (int k = 0; k < 3; k++) {
      conic_gaussians scene = make_stack(context, 1, &opacities[k]);
      float T;
      uint32_t count = count_in_middle(context, &scene, profile, &T);
      if (!is_antialiased(profile) && profile != CONIC_PROFILE_3DGUT_2025) { /* which are fainter here */
        CHECK(count == (k > 0 || !(conic_profile_row_of((conic_gaussian_profile)profile)->alpha_least > 0.0)));
        CHECK(T == (count ? 1.0f - opacities[k] : 1.0f));
      }
      conic_gaussians_release(context, &scene);
    }
}

/* Three opacities after which T, in floats, is `wanted` to the bit. */
static int find_opacities(float wanted, float opacity[3]) {
  for (int i = 0; i < 3000; i++)
    for (int j = 0; j < 3000; j++) {
      opacity[0] = 0.9f;
      opacity[1] = 0.9f + (float)i * 1e-6f;
      float T = 1.0f - opacity[0], rest;
      T = T * (1.0f - opacity[1]);
      rest = wanted / T; /* what the third has to leave */
      opacity[2] = 1.0f - rest + (float)(j - 1500) * 6e-8f;
      if (opacity[2] < 0.99f && T * (1.0f - opacity[2]) == wanted)
        return 1;
    }
  return 0;
}

/* T of 10⁻⁴ ends compositing where the profile ends it there, and an ulp more or less decides. */
static void test_stop(conic_context *context) {
  const float wanted[3] = {nextafterf(stop, 0.0f), stop, nextafterf(stop, 1.0f)};
  for (int k = 0; k < 3; k++) {
    float opacity[4] = {0.0f, 0.0f, 0.0f, 0.5f};
    CHECK(find_opacities(wanted[k], opacity));
    conic_gaussians scene = make_stack(context, 3, opacity);
    for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
      float T;
      uint32_t count = count_in_middle(context, &scene, profile, &T);
      const conic_profile_row *row = conic_profile_row_of((conic_gaussian_profile)profile);
      int goes = !(row->stop > 0.0) || k == 2 || (k == 1 && !row->is_beyond_stop);
      if (is_antialiased(profile))
        continue;
      CHECK(count == (goes ? 3u : 2u));
      CHECK(T == (goes ? wanted[k] : (1.0f - opacity[0]) * (1.0f - opacity[1])));
    }
    conic_gaussians_release(context, &scene);
  }
}

/* Without a dilation, q of a needle that is a thousandth of a pixel wide is the difference of large numbers. */
typedef struct hard_case {
  const char *name;
  float scale[3], position[3];
  double bound_of_khr;
} hard_case;

/* One hard Gaussian before an ordinary one: drawn or counted, and where drawn, as the oracle has it. */
static void test_hard_by_oracle(conic_context *context) {
  static const hard_case cases[] = {
      {"1e-9", {1e-9f, 1e-9f, 1e-9f}, {0.0f, 0.0f, 0.0f}, 1e-5},
      {"1e9", {1e9f, 1e9f, 1e9f}, {0.0f, 0.0f, 0.0f}, 1e-5},
      {"needle", {1e-6f, 10.0f, 1e-6f}, {0.1f, 0.0f, 0.0f}, 1e-5},
      {"needle towards the eye", {1e-4f, 1e-4f, 10.0f}, {0.1f, 0.1f, 0.0f}, 0.1},
      {"plate", {3.0f, 1e-6f, 3.0f}, {0.0f, 0.2f, 0.0f}, 1e-5},
      {"round the eye", {3.0f, 2.0f, 1.0f}, {0.1f, 0.2f, -5.1f}, 1e-5},
      {"at the eye", {0.5f, 0.5f, 0.5f}, {0.0f, 0.0f, -5.0f}, 1e-5},
      {"behind the eye", {3.0f, 3.0f, 3.0f}, {1.0f, 0.5f, -8.0f}, 1e-5},
      {"at near", {0.1f, 0.1f, 0.1f}, {0.0f, 0.0f, -4.8f}, 1e-5},
      {"far", {1e6f, 1e6f, 1e6f}, {0.0f, 0.0f, 1e7f}, 1e-5},
  };
  const conic_camera camera = camera_turned(no_turn, SIDE, SIDE);
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
      const float opacity[2] = {0.7f, 0.6f};
      conic_gaussians scene = make_stack(context, 2, opacity);
      for (int axis = 0; axis < 3; axis++) {
        scene.scale[axis][0] = cases[k].scale[axis];
        scene.position[axis][0] = cases[k].position[axis];
      }
      conic_gaussian_options options;
      conic_gaussian_statistics s;
      conic_gaussian_planes p = picture_planes(&camera);
      conic_gaussian_options_init(&options);
      options.profile = (conic_gaussian_profile)profile;
      CHECK_OK(conic_gaussians_render(context, &scene, &camera, &options, &p, &s));
      conic_gaussian_reference r = picture_reference(context, &scene, &camera, options.profile, CONIC_GAUSSIAN_PROFILE);
      double apart = picture_difference(p.rgb, r.rgb, 3 * SIDE * SIDE);
      printf("%-24s %-13s %s, %.2g from the oracle\n", cases[k].name, conic_gaussian_profile_name(options.profile),
             s.gaussians_drawn == 2 ? "drawn"
             : s.gaussians_skipped  ? "skipped"
                                    : "culled",
             apart);
      CHECK(s.gaussians_drawn + s.gaussians_culled + s.gaussians_skipped == 2);
      CHECK(apart <= (is_undilated(profile) ? cases[k].bound_of_khr : 1e-5));
      conic_gaussian_reference_release(context, &r);
      picture_release(&p);
      conic_gaussians_release(context, &scene);
    }
}

/* Means of one depth: in the order of the file, but by `exact` in that along the ray. */
static void test_equal_depths(conic_context *context) {
  conic_gaussians scene = gaussians_random(context, 200, 0, 0);
  const conic_camera camera = camera_turned(no_turn, 48, 48);
  for (size_t i = 0; i < scene.count; i++)
    scene.position[2][i] = 0.0f;
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_gaussian_planes p = picture_draw(context, &scene, &camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
    conic_gaussian_reference r =
        picture_reference(context, &scene, &camera, (conic_gaussian_profile)profile, CONIC_GAUSSIAN_PROFILE);
    CHECK(picture_difference(p.rgb, r.rgb, 3 * 48 * 48) <= 1e-5);
    conic_gaussian_reference_release(context, &r);
    picture_release(&p);
  }
  conic_gaussians_release(context, &scene);
}

int main(void) {
  conic_context *context = check_context(2);
  test_turned_together(context);
  test_quaternion_lengths(context);
  test_same_ray(context);
  test_pan(context);
  test_least_alpha(context);
  test_stop(context);
  test_hard_by_oracle(context);
  test_equal_depths(context);
  conic_context_destroy(context);
  return check_result();
}
