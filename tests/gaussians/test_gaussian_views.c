/* What `exact` has of its own: its filter, and cameras that are no pinholes. */
#include "core/lanes/instruction_sets.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_picture.h"

static conic_camera camera_of(uint32_t kind, double distance, int width, int height) {
  conic_camera camera = {.width = width, .height = height, .cx = 0.5 * width, .cy = 0.5 * height, .kind = kind};
  camera.fx = camera.fy = kind == CONIC_CAMERA_ORTHOGRAPHIC ? 0.2 * height : 1.1 * height;
  for (int axis = 0; axis < 3; axis++)
    camera.cam_from_world[axis][axis] = 1.0;
  camera.cam_from_world[2][3] = distance;
  return camera;
}

static conic_gaussian_options exact_options(double prefilter, conic_isa isa) {
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  options.prefilter = prefilter;
  options.isa = isa;
  return options;
}

static conic_gaussian_planes draw_view(conic_context *context, const conic_gaussians *scene, const conic_camera *camera,
                                       double prefilter) {
  const conic_gaussian_options options = exact_options(prefilter, CONIC_ISA_AUTO);
  conic_gaussian_planes planes = picture_planes(camera);
  if (conic_gaussians_render(context, scene, camera, &options, &planes, NULL) != CONIC_OK)
    exit(1);
  return planes;
}

/* By the oracle; the same bits by every instruction set and by one thread. */
static void compare_view(conic_context *context, conic_context *one, const char *name, const conic_gaussians *scene,
                         const conic_camera *camera, double prefilter, double bound) {
  const size_t n = (size_t)camera->width * (size_t)camera->height;
  conic_gaussian_options options = exact_options(prefilter, CONIC_ISA_SCALAR);
  conic_gaussian_reference r;
  conic_gaussian_planes p = picture_planes(camera);
  CHECK_OK(conic_gaussians_render(one, scene, camera, &options, &p, NULL));
  CHECK_OK(conic_gaussian_oracle_render(context, scene, camera, &options, CONIC_GAUSSIAN_PROFILE, &r));
  size_t n_other = 0, n_covered = 0;
  double depth = 0.0;
  for (size_t i = 0; i < n; i++) {
    n_other += p.count[i] != r.count[i];
    n_covered += p.count[i] > 0;
    depth = fmax(depth, fabs((double)p.z[i] - r.z[i]) / fmax(1.0, r.z[i]));
  }
  double rgb = picture_difference(p.rgb, r.rgb, 3 * n), rest = picture_difference(p.transparency, r.transparency, n);
  double normal = picture_difference(p.normal, r.normal, 3 * n);
  printf("%-28s rgb %.2g, T %.2g, N %.2g, Z %.2g; %zu of %zu pixels with another count\n", name, rgb, rest, normal,
         depth, n_other, n_covered);
  CHECK(rgb <= bound && rest <= bound && normal <= bound && n_other * 1000 <= n && n_covered * 10 > n);
  for (int isa = CONIC_ISA_SSE2; isa < CONIC_N_ISAS; isa++) {
    conic_gaussian_planes planes = picture_planes(camera);
    options.isa = (conic_isa)isa;
    if (conic_isa_is_here((conic_isa)isa)) {
      CHECK_OK(conic_gaussians_render(context, scene, camera, &options, &planes, NULL));
      CHECK(picture_is_same(&p, &planes));
    }
    picture_release(&planes);
  }
  picture_release(&p);
  conic_gaussian_reference_release(context, &r);
}

/* One Gaussian before the camera, turned, with the scales given. */
static conic_gaussians single_gaussian(conic_context *context, const double place[3], const double scale[3],
                                       double opacity) {
  static const float turn[4] = {0.8f, 0.3f, -0.4f, 0.2f};
  conic_gaussians scene;
  CHECK_OK(conic_gaussians_allocate(context, 1, 0, 0, &scene));
  for (int k = 0; k < 3; k++) {
    scene.position[k][0] = (float)place[k];
    scene.scale[k][0] = (float)scale[k];
    scene.sh[k] = 1.0f;
  }
  for (int k = 0; k < 4; k++)
    scene.rotation[k][0] = turn[k];
  scene.opacity[0] = (float)opacity;
  return scene;
}

static void test_filter_by_oracle(conic_context *context, conic_context *one) {
  static const double filters[] = {0.1, 1.0, 9.0};
  conic_gaussians scene = gaussians_random(context, 300, 1, 0);
  conic_gaussians flat = gaussians_random(context, 200, 1, CONIC_GAUSSIANS_2D);
  for (int k = 0; k < 3; k++)
    for (int kind = 0; kind <= CONIC_CAMERA_ORTHOGRAPHIC; kind += CONIC_CAMERA_ORTHOGRAPHIC) {
      const conic_camera camera = camera_of((uint32_t)kind, 5.0, 70, 60);
      compare_view(context, one, kind ? "filter, orthographic" : "filter", &scene, &camera, filters[k], 1e-6);
      compare_view(context, one, kind ? "filter, discs, orthographic" : "filter, discs", &flat, &camera, filters[k],
                   4e-6);
    }
  conic_gaussians_release(context, &scene);
  conic_gaussians_release(context, &flat);
}

enum { FINE = 8 };

/* What the filter should do: alpha is the response of rays in between, weighed by a normal density about the pixel. */
static double convolve_at(const conic_gaussian_planes *fine, double h, double x0, double y0) {
  double sum = 0.0;
  for (int y = 0; y < fine->height; y++)
    for (int x = 0; x < fine->width; x++) {
      double dx = (x + 0.5) / FINE - x0, dy = (y + 0.5) / FINE - y0;
      double weight = exp(-0.5 * (dx * dx + dy * dy) / h) / (6.283185307179586 * h * FINE * FINE);
      sum += weight * (1.0 - (double)fine->transparency[y * fine->width + x]);
    }
  return sum;
}

static void test_filter_by_convolution(conic_context *context) {
  enum { SIDE = 24 };
  static const double places[3][3] = {{0.0, 0.0, 0.0}, {0.5, -0.4, 0.0}, {-0.4, 0.5, 0.0}};
  static const double scales[3][3] = {{0.4, 0.2, 0.3}, {0.05, 0.08, 0.3}, {0.3, 0.15, 0.02}};
  for (int kind = 0; kind <= CONIC_CAMERA_ORTHOGRAPHIC; kind += CONIC_CAMERA_ORTHOGRAPHIC)
    for (int k = 0; k < 3; k++) {
      conic_gaussians scene = single_gaussian(context, places[k], scales[k], 0.9);
      conic_camera camera = camera_of((uint32_t)kind, 5.0, SIDE, SIDE), fine;
      camera.fx = camera.fy = kind ? 6.0 : 30.0;
      fine = camera;
      fine.width = fine.height = SIDE * FINE;
      fine.fx = fine.fy = camera.fx * FINE;
      fine.cx = fine.cy = camera.cx * FINE;
      conic_gaussian_planes p = draw_view(context, &scene, &camera, 0.5), q = draw_view(context, &scene, &fine, 0.0);
      double apart = 0.0, unfiltered = 0.0;
      conic_gaussian_planes bare = draw_view(context, &scene, &camera, 0.0);
      for (int pixel = 0; pixel < SIDE * SIDE; pixel++) {
        double wanted = convolve_at(&q, 0.5, pixel % SIDE + 0.5, pixel / SIDE + 0.5);
        apart = fmax(apart, fabs(1.0 - (double)p.transparency[pixel] - wanted));
        unfiltered = fmax(unfiltered, fabs(1.0 - (double)bare.transparency[pixel] - wanted));
      }
      printf("filter and convolution: %.2g apart; %.2g without\n", apart, unfiltered);
      CHECK(apart < 8e-3 && unfiltered > 5.0 * apart); /* beyond 1/255 is nothing */
      picture_release(&p);
      picture_release(&q);
      picture_release(&bare);
      conic_gaussians_release(context, &scene);
    }
}

/* However far it is, a Gaussian gives the same light: opacity, times its area on the screen. Unfiltered, it falls
 * between the pixels. */
static void test_filter_far(conic_context *context) {
  static const double place[3] = {0.0, 0.0, 0.0}, scale[3] = {0.1, 0.1, 0.1};
  conic_gaussians scene = single_gaussian(context, place, scale, 0.9);
  for (double distance = 1.0; distance <= 64.0; distance *= 1.3) {
    conic_camera camera = camera_of(CONIC_CAMERA_PERSPECTIVE, distance, 64, 64);
    camera.cx = camera.cy = 32.0 + 0.37;
    conic_gaussian_planes p = draw_view(context, &scene, &camera, 1.0);
    double sum = 0.0, sigma = 0.1 * camera.fx / distance, light = 0.9 * 6.283185307179586 * sigma * sigma;
    size_t n = 0;
    for (size_t i = 0; i < 64 * 64; i++) {
      sum += 1.0 - (double)p.transparency[i];
      n += p.count[i];
    }
    CHECK(distance < 1.5 || (light / (6.283185307179586 * (1.0 + sigma * sigma)) < 1.5 / 255.0 ? n <= 4 : n >= 4));
    if (light > 0.5 && distance > 2.0) /* what is fainter than 1/255 is left out */
      CHECK_NEAR(sum / light, 1.0, 0.12);
    picture_release(&p);
  }
  conic_gaussians_release(context, &scene);
}

static void test_refused_views(conic_context *quiet) {
  conic_gaussians scene = gaussians_random(quiet, 4, 0, 0);
  conic_camera camera = camera_of(CONIC_CAMERA_PERSPECTIVE, 5.0, 16, 16);
  conic_gaussian_planes p = picture_planes(&camera);
  conic_gaussian_options options = exact_options(-1.0, CONIC_ISA_AUTO);
  conic_gaussian_reference r;
  CHECK(conic_gaussians_render(quiet, &scene, &camera, &options, &p, NULL) == CONIC_ERROR_ARGUMENT);
  options.prefilter = 0.3;
  CHECK_OK(conic_gaussians_render(quiet, &scene, &camera, &options, &p, NULL));
  for (int profile = 1; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    options.profile = (conic_gaussian_profile)profile;
    options.prefilter = 0.3;
    CHECK(conic_gaussians_render(quiet, &scene, &camera, &options, &p, NULL) == CONIC_ERROR_ARGUMENT);
    CHECK(conic_gaussian_oracle_render(quiet, &scene, &camera, &options, CONIC_GAUSSIAN_PROFILE, &r) ==
          CONIC_ERROR_ARGUMENT);
    options.prefilter = 0.0;
    for (int kind = 1; kind < CONIC_N_CAMERA_KINDS; kind++) {
      conic_camera other = camera;
      other.kind = (uint32_t)kind;
      CHECK(conic_gaussians_render(quiet, &scene, &other, &options, &p, NULL) == CONIC_ERROR_ARGUMENT);
      CHECK(conic_gaussian_oracle_render(quiet, &scene, &other, &options, CONIC_GAUSSIAN_PROFILE, &r) ==
            CONIC_ERROR_ARGUMENT);
    }
  }
  picture_release(&p);
  conic_gaussians_release(quiet, &scene);
}

static void test_orthographic(conic_context *context, conic_context *one) {
  conic_gaussians scene = gaussians_random(context, 400, 2, 0),
                  flat = gaussians_random(context, 200, 0, CONIC_GAUSSIANS_2D);
  const conic_camera camera = camera_of(CONIC_CAMERA_ORTHOGRAPHIC, 5.0, 70, 60);
  compare_view(context, one, "orthographic", &scene, &camera, 0.0, 1e-6);
  compare_view(context, one, "orthographic, discs", &flat, &camera, 0.0, 4e-6);
  /* As a pinhole from very far sees it. */
  conic_camera far = camera_of(CONIC_CAMERA_PERSPECTIVE, 2e4, 70, 60);
  far.fx = far.fy = camera.fx * 2e4;
  conic_camera near = camera_of(CONIC_CAMERA_ORTHOGRAPHIC, 50.0, 70, 60);
  conic_gaussian_planes a = draw_view(context, &scene, &near, 0.0), b = draw_view(context, &scene, &far, 0.0);
  double apart = 0.0;
  for (size_t i = 0; i < 3 * 70 * 60; i++)
    apart += fabs((double)a.rgb[i] - (double)b.rgb[i]) / (3 * 70 * 60);
  printf("orthographic and a far pinhole: %.2g apart in the mean\n", apart);
  CHECK(apart < 2e-4);
  picture_release(&a);
  picture_release(&b);
  conic_gaussians_release(context, &scene);
  conic_gaussians_release(context, &flat);
}

int main(void) {
  conic_context *context = check_context(2), *one = check_context(1), *quiet;
  conic_context_options options;
  conic_context_options_init(&options);
  CHECK_OK(conic_context_create(&options, &quiet));
  test_filter_by_oracle(context, one);
  test_filter_by_convolution(context);
  test_filter_far(context);
  test_orthographic(context, one);
  test_refused_views(quiet);
  conic_context_destroy(quiet);
  conic_context_destroy(one);
  conic_context_destroy(context);
  return check_result();
}
