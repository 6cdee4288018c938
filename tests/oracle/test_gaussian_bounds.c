/* Bounds of what floats make of Gaussian scenes are never violated: by the renderer, by the double run, and by an
 * evaluator of this test's own, which rounds, fuses and orders at random. They are tight enough to see what is wrong.
 */
#include "conic/gaussian_judge.h"
#include "core/base/memory.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_picture.h"

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
                           const conic_camera *camera) {
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_gaussian_planes p = picture_draw(context, scene, camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
    conic_image image = image_of(context, &p);
    conic_gaussian_verdict verdict = judge_image(context, scene, camera, profile, &image);
    tell_verdict(name, profile, &verdict);
    CHECK(verdict.pass && verdict.judged_pixels == (size_t)camera->width * (size_t)camera->height);
    conic_image_release(context, &image);
    picture_release(&p);
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

int main(void) {
  conic_context *context = check_context(2);
  test_renderer(context);
  conic_context_destroy(context);
  return check_result();
}
