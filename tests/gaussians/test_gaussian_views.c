/* What `exact` has of its own: its filter, and cameras that are no pinholes. */
#include "core/base/vectors.h"
#include "core/image/camera_rays.h"
#include "core/lanes/instruction_sets.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_picture.h"

static conic_camera camera_of_kind(uint32_t kind, double distance, int width, int height) {
  conic_camera camera = {.width = width, .height = height, .cx = 0.5 * width, .cy = 0.5 * height, .kind = kind};
  camera.fx = camera.fy = kind == CONIC_CAMERA_ORTHOGRAPHIC ? 0.2 * height : 1.1 * height;
  for (int axis = 0; axis < 3; axis++)
    camera.cam_from_world[axis][axis] = 1.0;
  camera.cam_from_world[2][3] = distance;
  return camera;
}

static conic_gaussian_profile drawn = CONIC_PROFILE_EXACT;

static conic_gaussian_options exact_options(double prefilter, conic_isa isa) {
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  options.profile = drawn;
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
  CHECK(rgb <= bound && rest <= bound && normal <= bound && n_other * 1000 <= n && n_covered * 20 > n);
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
      const conic_camera camera = camera_of_kind((uint32_t)kind, 5.0, 70, 60);
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
      conic_camera camera = camera_of_kind((uint32_t)kind, 5.0, SIDE, SIDE), fine;
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
    conic_camera camera = camera_of_kind(CONIC_CAMERA_PERSPECTIVE, distance, 64, 64);
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

/* --- rays --- */

/* What a camera makes of a direction, by the C library. */
static void project_direction(const conic_camera *c, const double d[3], double pixel[2]) {
  double across = hypot(d[0], d[1]), a = d[0] / d[2], b = d[1] / d[2];
  if (c->kind == CONIC_CAMERA_FISHEYE) {
    a = across > 0.0 ? d[0] * atan2(across, d[2]) / across : 0.0;
    b = across > 0.0 ? d[1] * atan2(across, d[2]) / across : 0.0;
  } else if (c->kind == CONIC_CAMERA_EQUIRECTANGULAR) {
    a = atan2(d[0], d[2]);
    b = atan2(d[1], hypot(d[0], d[2]));
  }
  const double *k = c->distortion, s = a * a + b * b;
  double r = 1.0, x = 0.0, y = 0.0;
  int is_prism = c->lens == CONIC_LENS_THIN_PRISM;
  if (c->lens == CONIC_LENS_RADIAL)
    r = 1.0 + k[0] * s + k[1] * s * s + k[2] * s * s * s + k[3] * s * s * s * s;
  if (c->lens == CONIC_LENS_OPENCV)
    r = (1.0 + k[0] * s + k[1] * s * s + k[4] * s * s * s) / (1.0 + k[5] * s + k[6] * s * s + k[7] * s * s * s);
  if (is_prism)
    r = 1.0 + k[0] * s + k[1] * s * s + k[4] * s * s * s + k[5] * s * s * s * s;
  if (c->lens == CONIC_LENS_FOV && s > 0.0)
    r = atan(2.0 * sqrt(s) * tan(0.5 * k[0])) / (k[0] * sqrt(s));
  if (c->lens == CONIC_LENS_DIVISION)
    r = 2.0 / (1.0 + sqrt(1.0 - 4.0 * k[0] * s));
  if (c->lens == CONIC_LENS_EUCM)
    r = 1.0 / (k[0] * sqrt(1.0 + k[1] * s) + 1.0 - k[0]);
  if (c->lens == CONIC_LENS_OPENCV || is_prism) {
    x = 2.0 * k[2] * a * b + k[3] * (s + 2.0 * a * a) + (is_prism ? k[6] * s : 0.0);
    y = k[2] * (s + 2.0 * b * b) + 2.0 * k[3] * a * b + (is_prism ? k[7] * s : 0.0);
  }
  pixel[0] = c->fx * (a * r + x) + c->cx;
  pixel[1] = c->fy * (b * r + y) + c->cy;
}

/* Cameras with every kind and lens, as they come of photographs. */
typedef struct lens_case {
  const char *name;
  uint32_t kind, lens;
  double focal; /* of the height */
  double distortion[8];
} lens_case;

static const lens_case lens_cases[] = {
    {"fisheye", CONIC_CAMERA_FISHEYE, CONIC_LENS_NONE, 0.31, {0.0}},
    {"equirectangular", CONIC_CAMERA_EQUIRECTANGULAR, CONIC_LENS_NONE, 0.3183098861837907, {0.0}},
    {"radial", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_RADIAL, 0.9, {-0.12, 0.03}},
    {"opencv", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_OPENCV, 0.9, {-0.28, 0.07, 1e-3, -2e-3}},
    {"full opencv", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_OPENCV, 0.9, {0.4, 0.1, 1e-3, 5e-4, 0.01, 0.6, 0.2, 0.02}},
    {"fov", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_FOV, 0.6, {0.9}},
    {"division", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_DIVISION, 0.6, {-0.2}},
    {"pincushion", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_DIVISION, 0.9, {0.1}},
    {"eucm", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_EUCM, 0.6, {0.6, 1.1}},
    {"opencv fisheye", CONIC_CAMERA_FISHEYE, CONIC_LENS_RADIAL, 0.4, {0.03, -0.01, 2e-3, -3e-4}},
    {"thin prism fisheye",
     CONIC_CAMERA_FISHEYE,
     CONIC_LENS_THIN_PRISM,
     0.4,
     {0.03, -0.01, 1e-3, 5e-4, 2e-3, -3e-4, 1e-3, -1e-3}}};
enum { N_LENS_CASES = sizeof lens_cases / sizeof *lens_cases };

static conic_camera camera_of_case(const lens_case *c, double distance, int width, int height) {
  conic_camera camera = camera_of_kind(c->kind, distance, width, height);
  camera.lens = c->lens;
  camera.fx = camera.fy = c->focal * height;
  memcpy(camera.distortion, c->distortion, sizeof camera.distortion);
  return camera;
}

/* Undistorted and distorted again, every pixel is where it was. */
static void test_lens_round_trips(void) {
  for (int i = 0; i < N_LENS_CASES; i++) {
    const conic_camera camera = camera_of_case(&lens_cases[i], 0.0, 90, 60);
    conic_camera_rays rays;
    double worst = 0.0, origin[3], d[3], pixel[2];
    int n = 0;
    conic_camera_rays_init(&camera, &rays);
    for (int y = 0; y < 60; y++)
      for (int x = 0; x < 90; x++) {
        if (!conic_camera_ray(&rays, x + 0.5, y + 0.5, origin, d))
          continue;
        n++;
        CHECK(camera.kind == CONIC_CAMERA_PERSPECTIVE ? d[2] == 1.0 : fabs(conic_length(d) - 1.0) < 1e-15);
        project_direction(&camera, d, pixel);
        worst = fmax(worst, fmax(fabs(pixel[0] - x - 0.5), fabs(pixel[1] - y - 0.5)) / 60.0);
      }
    printf("%-20s %d rays, %.2g of the height off\n", lens_cases[i].name, n, worst);
    CHECK(worst < 1e-12 && n > 3500);
  }
}

/* Where a lens turns back there is no ray: r = 1 − s has its fold at 1/√3, where the radius is 2/(3·√3). */
static void test_folds(void) {
  conic_camera camera = camera_of_kind(CONIC_CAMERA_PERSPECTIVE, 0.0, 1000, 1000);
  conic_camera_rays rays;
  double origin[3], d[3], fold = 2.0 / (3.0 * sqrt(3.0));
  camera.fx = camera.fy = 1000.0;
  camera.lens = CONIC_LENS_RADIAL;
  camera.distortion[0] = -1.0;
  conic_camera_rays_init(&camera, &rays);
  CHECK_NEAR(rays.most_radius, 1.0 / sqrt(3.0), 1e-12);
  CHECK(conic_camera_ray(&rays, 500.0 + 1000.0 * fold - 0.01, 500.0, origin, d));
  CHECK(!conic_camera_ray(&rays, 500.0 + 1000.0 * fold + 0.01, 500.0, origin, d));
  camera.lens = CONIC_LENS_OPENCV; /* a pole at s = ¼ */
  memset(camera.distortion, 0, sizeof camera.distortion);
  camera.distortion[5] = -4.0;
  conic_camera_rays_init(&camera, &rays);
  CHECK(rays.most_radius <= 0.5 && conic_camera_ray(&rays, 1e5, 500.0, origin, d) && d[0] < 0.5);
  camera.kind = CONIC_CAMERA_FISHEYE; /* beyond π there is nothing */
  camera.lens = CONIC_LENS_NONE;
  conic_camera_rays_init(&camera, &rays);
  CHECK(conic_camera_ray(&rays, 500.0 + 3141.59, 500.0, origin, d) && d[2] < -0.999);
  CHECK(!conic_camera_ray(&rays, 500.0 + 3141.60, 500.0, origin, d));
  camera.kind = CONIC_CAMERA_EQUIRECTANGULAR;
  conic_camera_rays_init(&camera, &rays);
  CHECK(!conic_camera_ray(&rays, 500.0, 500.0 + 1570.8, origin, d));
  CHECK(!conic_camera_ray(&rays, 500.0 - 3141.60, 500.0, origin, d));
}

static void test_cameras_by_oracle(conic_context *context, conic_context *one) {
  conic_gaussians scene = gaussians_random(context, 400, 2, 0),
                  flat = gaussians_random(context, 200, 0, CONIC_GAUSSIANS_2D);
  for (int i = 0; i < N_LENS_CASES; i++) {
    const conic_camera out = camera_of_case(&lens_cases[i], 3.5, 70, 50),
                       in = camera_of_case(&lens_cases[i], 0.2, 70, 50);
    compare_view(context, one, lens_cases[i].name, &scene, &out, 0.0, 2e-6);
    compare_view(context, one, "  amid the scene", &scene, &in, 0.0, 2e-6);
    compare_view(context, one, "  discs", &flat, &in, 0.0, 6e-6);
  }
  conic_gaussians_release(context, &scene);
  conic_gaussians_release(context, &flat);
}

/* The plane P: places that are projected again come to their pixels, at their depth. */
static void test_places(conic_context *context) {
  for (int i = -1; i < N_LENS_CASES; i++) {
    conic_camera camera =
        i < 0 ? camera_of_kind(CONIC_CAMERA_ORTHOGRAPHIC, 0.0, 24, 20) : camera_of_case(&lens_cases[i], 0.0, 24, 20);
    conic_image image = {0};
    CHECK_OK(conic_image_allocate(context, 24, 20, 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_POSITION, &image));
    float *z = image.planes[CONIC_PLANE_Z], *place = image.planes[CONIC_PLANE_POSITION];
    for (int at = 0; at < 24 * 20; at++)
      z[at] = 3.0f;
    CHECK_OK(conic_image_locate(context, &camera, 1, &image));
    for (int at = 0; at < 24 * 20; at++) {
      const double p[3] = {(double)place[3 * at], (double)place[3 * at + 1], (double)place[3 * at + 2]};
      double pixel[2] = {camera.fx * p[0] + camera.cx, camera.fy * p[1] + camera.cy};
      if (i >= 0)
        project_direction(&camera, p, pixel);
      CHECK_NEAR(pixel[0], at % 24 + 0.5, 1e-4);
      CHECK_NEAR(pixel[1], at / 24 + 0.5, 1e-4);
      CHECK_NEAR(camera.kind == CONIC_CAMERA_PERSPECTIVE || i < 0 ? p[2] : conic_length(p), 3.0, 1e-6);
    }
    conic_image_release(context, &image);
  }
}

/* A direction's pixel, and between pixels the mean of four. */
static double color_between(const conic_gaussian_planes *p, const double pixel[2], int channel) {
  double x = pixel[0] - 0.5, y = pixel[1] - 0.5, sum = 0.0;
  int left = (int)floor(x), top = (int)floor(y);
  for (int k = 0; k < 4; k++) {
    int column = left + k % 2, row = top + k / 2;
    double weight = (k % 2 ? x - left : 1.0 - (x - left)) * (k / 2 ? y - top : 1.0 - (y - top));
    sum += weight * (double)p->rgb[3 * (row * p->width + column) + channel];
  }
  return sum;
}

/* What a fisheye and a panorama see in a direction, a pinhole sees there, too. */
static void test_resampled(conic_context *context) {
  conic_gaussians scene = gaussians_random(context, 300, 0, 0);
  for (size_t i = 0; i < scene.count; i++)
    for (int k = 0; k < 3; k++) /* of which no pixel is a large part */
      scene.scale[k][i] = 0.1f + scene.scale[k][i];
  const conic_camera pinhole = camera_of_kind(CONIC_CAMERA_PERSPECTIVE, 8.0, 60, 60);
  conic_gaussian_planes wanted = draw_view(context, &scene, &pinhole, 0.0);
  for (int kind = CONIC_CAMERA_FISHEYE; kind <= CONIC_CAMERA_EQUIRECTANGULAR; kind += 2) {
    conic_camera camera = camera_of_kind((uint32_t)kind, 8.0, 500, 500);
    camera.fx = camera.fy = 450.0;
    conic_gaussian_planes p = draw_view(context, &scene, &camera, 0.0);
    double worst = 0.0, pixel[2];
    for (int at = 0; at < 3600; at++) {
      const double d[3] = {(at % 60 + 0.5 - 30.0) / 66.0, (at / 60 + 0.5 - 30.0) / 66.0, 1.0};
      project_direction(&camera, d, pixel);
      for (int channel = 0; channel < 3; channel++)
        worst = fmax(worst, fabs(color_between(&p, pixel, channel) - (double)wanted.rgb[3 * at + channel]));
    }
    printf("resampled: %.2g apart\n", worst);
    CHECK(worst < 2.5e-2);
    picture_release(&p);
  }
  picture_release(&wanted);
  conic_gaussians_release(context, &scene);
}

/* A panorama's left side goes on where its right side ends: turned by half a picture, it is the same one, moved. */
static void test_seam(conic_context *context) {
  enum { W = 96, H = 48 };
  conic_gaussians scene = gaussians_random(context, 400, 0, 0);
  conic_camera camera = camera_of_kind(CONIC_CAMERA_EQUIRECTANGULAR, 0.3, W, H), turned;
  camera.fx = camera.fy = W / 6.283185307179586;
  turned = camera;
  for (int k = 0; k < 4; k++) { /* half a turn about y */
    turned.cam_from_world[0][k] = -camera.cam_from_world[0][k];
    turned.cam_from_world[2][k] = -camera.cam_from_world[2][k];
  }
  conic_gaussian_planes a = draw_view(context, &scene, &camera, 0.0), b = draw_view(context, &scene, &turned, 0.0);
  double worst = 0.0;
  for (int y = 0; y < H; y++)
    for (int x = 0; x < W; x++)
      for (int c = 0; c < 3; c++)
        worst =
            fmax(worst, fabs((double)a.rgb[3 * (y * W + x) + c] - (double)b.rgb[3 * (y * W + (x + W / 2) % W) + c]));
  printf("turned by half a picture: %.2g apart\n", worst);
  CHECK(worst < 2e-6);
  picture_release(&a);
  picture_release(&b);
  conic_gaussians_release(context, &scene);
}

static void test_orthographic(conic_context *context, conic_context *one) {
  conic_gaussians scene = gaussians_random(context, 400, 2, 0),
                  flat = gaussians_random(context, 200, 0, CONIC_GAUSSIANS_2D);
  const conic_camera camera = camera_of_kind(CONIC_CAMERA_ORTHOGRAPHIC, 5.0, 70, 60);
  compare_view(context, one, "orthographic", &scene, &camera, 0.0, 1e-6);
  compare_view(context, one, "orthographic, discs", &flat, &camera, 0.0, 4e-6);
  /* As a pinhole from very far sees it. */
  conic_camera far = camera_of_kind(CONIC_CAMERA_PERSPECTIVE, 2e4, 70, 60);
  far.fx = far.fy = camera.fx * 2e4;
  conic_camera near = camera_of_kind(CONIC_CAMERA_ORTHOGRAPHIC, 50.0, 70, 60);
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

/* 3dgut-2025 through the lenses that it takes. */
static void test_solids(conic_context *context, conic_context *one) {
  conic_gaussians scene = gaussians_random(context, 300, 2, 0);
  drawn = CONIC_PROFILE_3DGUT_2025;
  for (int i = 0; i < N_LENS_CASES; i++) {
    const conic_camera camera = camera_of_case(&lens_cases[i], 5.0, 70, 50);
    const int is_radial = camera.lens == CONIC_LENS_NONE || camera.lens == CONIC_LENS_RADIAL;
    const int is_pinhole = camera.kind == CONIC_CAMERA_PERSPECTIVE && camera.distortion[3] == 0.0;
    if (camera.kind == CONIC_CAMERA_FISHEYE ? is_radial : camera.lens == CONIC_LENS_OPENCV || (is_radial && is_pinhole))
      compare_view(context, one, lens_cases[i].name, &scene, &camera, 0.0, 1e-6);
  }
  drawn = CONIC_PROFILE_EXACT;
  conic_gaussians_release(context, &scene);
}

static void test_refused_views(conic_context *quiet) {
  conic_gaussians scene = gaussians_random(quiet, 4, 0, 0);
  conic_camera camera = camera_of_kind(CONIC_CAMERA_PERSPECTIVE, 5.0, 16, 16);
  conic_gaussian_planes p = picture_planes(&camera);
  conic_gaussian_options options = exact_options(-1.0, CONIC_ISA_AUTO);
  conic_gaussian_reference r;
  CHECK(conic_gaussians_render(quiet, &scene, &camera, &options, &p, NULL) == CONIC_ERROR_ARGUMENT);
  options.prefilter = 0.3;
  CHECK_OK(conic_gaussians_render(quiet, &scene, &camera, &options, &p, NULL));
  for (int i = 0; i < N_LENS_CASES; i++) { /* no filter, and orthographic ones no lens */
    conic_camera other = camera_of_case(&lens_cases[i], 5.0, 16, 16);
    CHECK(conic_gaussians_render(quiet, &scene, &other, &options, &p, NULL) == CONIC_ERROR_ARGUMENT);
    CHECK(conic_gaussian_oracle_render(quiet, &scene, &other, &options, CONIC_GAUSSIAN_PROFILE, &r) ==
          CONIC_ERROR_ARGUMENT);
  }
  for (uint32_t kind = CONIC_CAMERA_ORTHOGRAPHIC; kind < CONIC_N_CAMERA_KINDS; kind++) {
    conic_camera other = camera_of_kind(kind, 5.0, 16, 16);
    other.lens = CONIC_LENS_RADIAL;
    options.prefilter = 0.0;
    CHECK(conic_gaussians_render(quiet, &scene, &other, &options, &p, NULL) == CONIC_ERROR_ARGUMENT);
  }
  for (int profile = 1; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    options.profile = (conic_gaussian_profile)profile;
    options.prefilter = 0.3;
    CHECK(conic_gaussians_render(quiet, &scene, &camera, &options, &p, NULL) == CONIC_ERROR_ARGUMENT);
    CHECK(conic_gaussian_oracle_render(quiet, &scene, &camera, &options, CONIC_GAUSSIAN_PROFILE, &r) ==
          CONIC_ERROR_ARGUMENT);
    options.prefilter = 0.0;
    const int is_solid = profile == CONIC_PROFILE_3DGUT_2025; /* which takes fisheyes */
    for (int kind = is_solid ? CONIC_CAMERA_ORTHOGRAPHIC : 1; kind < CONIC_N_CAMERA_KINDS; kind++) {
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

int main(void) {
  conic_context *context = check_context(2), *one = check_context(1), *quiet;
  conic_context_options options;
  conic_context_options_init(&options);
  CHECK_OK(conic_context_create(&options, &quiet));
  test_filter_by_oracle(context, one);
  test_filter_by_convolution(context);
  test_filter_far(context);
  test_orthographic(context, one);
  test_lens_round_trips();
  test_folds();
  test_cameras_by_oracle(context, one);
  test_solids(context, one);
  test_places(context);
  test_resampled(context);
  test_seam(context);
  test_refused_views(quiet);
  conic_context_destroy(quiet);
  conic_context_destroy(one);
  conic_context_destroy(context);
  return check_result();
}
