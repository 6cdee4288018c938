/* Eye-dome lighting: against its formula, by the oracle; whatever the scale; and nothing where nothing stands out. */
#include "conic/lighting.h"
#include "conic/oracle.h"
#include "core/image/image_common.h"
#include "tests/support/check.h"

enum { EDGE = 24, N = EDGE * EDGE };

/* A step, a pit, a slope and a hole of a rough ground, in units of `unit`. */
static double depth_at(int x, int y, double unit) {
  if (x >= 18 && y >= 18)
    return 0.0;
  double z = 10.0 + 0.02 * x + 0.01 * ((x * 7 + y * 5) % 11);
  if (x < 8)
    z -= 1.5;
  if (x > 11 && x < 15 && y > 4 && y < 9)
    z += 0.7;
  return z * unit;
}

static void fill_picture(double unit, conic_image *image) {
  for (int i = 0; i < N; i++) {
    ((float *)image->planes[CONIC_PLANE_Z])[i] = (float)depth_at(i % EDGE, i / EDGE, unit);
    for (int c = 0; c < 4; c++)
      ((float *)image->planes[CONIC_PLANE_RGBA])[4 * i + c] = c == 3 ? 1.0f : 0.5f;
  }
}

static conic_camera camera_of(conic_camera_kind kind, double unit) {
  conic_camera camera = {.width = EDGE, .height = EDGE, .fx = 20.0, .fy = 20.0, .cx = 12.0, .cy = 12.0, .kind = kind};
  for (int i = 0; i < 3; i++)
    camera.cam_from_world[i][i] = 1.0;
  if (kind == CONIC_CAMERA_ORTHOGRAPHIC)
    camera.fx = camera.fy = 20.0 / unit;
  return camera;
}

static void draw_dome(conic_context *context, conic_camera_kind kind, double unit, double stops, conic_image *image) {
  const conic_camera camera = camera_of(kind, unit);
  CHECK_OK(conic_image_allocate(context, EDGE, EDGE, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z, image));
  fill_picture(unit, image);
  CHECK_OK(conic_image_eye_dome(context, &camera, stops, image));
}

static double red_at(const conic_image *image, int x, int y) {
  return (double)((const float *)image->planes[CONIC_PLANE_RGBA])[4 * (y * EDGE + x)];
}

/* The oracle's light of a white picture is the same. */
static void check_oracle(conic_context *context, conic_camera_kind kind) {
  const conic_camera camera = camera_of(kind, 1.0);
  conic_image image;
  double rgba[4 * N];
  conic_reference reference = {.width = EDGE, .height = EDGE, .n_pixels = N, .planes[CONIC_PLANE_RGBA] = rgba};
  draw_dome(context, kind, 1.0, 4.0, &image);
  for (int i = 0; i < 4 * N; i++)
    rgba[i] = i % 4 == 3 ? 1.0 : 0.5;
  CHECK_OK(conic_oracle_eye_dome(context, &camera, 4.0, &image, &reference));
  for (int i = 0; i < N; i++)
    CHECK_NEAR(red_at(&image, i % EDGE, i / EDGE), rgba[4 * i], 2e-6);
  conic_image_release(context, &image);
}

static void check_scale(conic_context *context, conic_camera_kind kind) {
  conic_image one, large;
  draw_dome(context, kind, 1.0, 4.0, &one);
  draw_dome(context, kind, 1024.0, 4.0, &large);
  CHECK(memcmp(one.planes[CONIC_PLANE_RGBA], large.planes[CONIC_PLANE_RGBA], sizeof(float) * 4 * N) == 0);
  /* Below the step and in the pit it is dark, above the step and where nothing is it is not. */
  CHECK(red_at(&one, 8, 12) < 0.35 && red_at(&one, 12, 5) < 0.35);
  CHECK(red_at(&one, 7, 12) > 1.5 * red_at(&one, 8, 12) && red_at(&one, 20, 20) == 0.5);
  conic_image_release(context, &one);
  conic_image_release(context, &large);
}

int main(void) {
  conic_context *context;
  CHECK_OK(conic_context_create(NULL, &context));
  conic_image none;
  const conic_camera_kind kinds[] = {CONIC_CAMERA_PERSPECTIVE, CONIC_CAMERA_ORTHOGRAPHIC};
  for (int i = 0; i < 2; i++) {
    check_oracle(context, kinds[i]);
    check_scale(context, kinds[i]);
  }
  draw_dome(context, CONIC_CAMERA_PERSPECTIVE, 1.0, 0.0, &none);
  CHECK(red_at(&none, 8, 12) == 0.5);
  const conic_camera camera = camera_of(CONIC_CAMERA_PERSPECTIVE, 1.0);
  CHECK(conic_image_eye_dome(context, &camera, 17.0, &none) == CONIC_ERROR_ARGUMENT);
  conic_image_release(context, &none);
  conic_context_destroy(context);
  return check_result();
}
