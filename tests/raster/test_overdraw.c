/* The false colours of how many splats a pixel blends. */
#include "tests/support/fixture.h"

static void expect(const float *pixel, float red, float green, float blue) {
  CHECK(pixel[0] == red && pixel[1] == green && pixel[2] == blue && pixel[3] == 1.0f);
}

/* Confetti's Fig. 18: one blue, 8 green, 16 red. */
static void check_confetti(fixture *f) {
  conic_image map = {0};
  const uint32_t counts[7] = {0, 1, 8, 16, 4000000000u, 12, 17};
  memcpy(f->image.planes[CONIC_PLANE_COUNT], counts, sizeof counts);
  CHECK_OK(conic_image_overdraw_confetti(f->context, &f->image, &map));
  const float *pixels = map.planes[CONIC_PLANE_RGBA];
  expect(pixels, 0, 0, 0);
  expect(pixels + 4, 0, 0, 1);
  expect(pixels + 8, 0, 1, 0);
  expect(pixels + 12, 1, 0, 0);
  expect(pixels + 16, 1, 0, 0);
  expect(pixels + 20, 0.5f, 0.5f, 0);
  expect(pixels + 24, 1, 0, 0);
  conic_image_release(f->context, &map);
}

int main(void) {
  fixture f = fixture_open(1);
  conic_image map = {0};
  CHECK_OK(conic_image_allocate(f.context, 7, 1, 1u << CONIC_PLANE_COUNT, &f.image));
  const uint32_t counts[7] = {0, 1, 4, 16, 64, 4000000000u, 2};
  memcpy(f.image.planes[CONIC_PLANE_COUNT], counts, sizeof counts);
  CHECK_OK(conic_image_overdraw(f.context, &f.image, &map));
  const float *pixels = map.planes[CONIC_PLANE_RGBA];
  expect(pixels, 0, 0, 0);
  expect(pixels + 4, 0, 0, 1);
  expect(pixels + 12, 1, 1, 0);
  expect(pixels + 16, 1, 1, 1);
  expect(pixels + 20, 1, 1, 1);
  CHECK_NEAR((double)pixels[8], 1.0, 1e-6);
  CHECK_NEAR((double)pixels[9] + (double)pixels[10], 0.0, 1e-6);
  CHECK_NEAR((double)pixels[24], 0.5, 1e-6);
  CHECK_NEAR((double)pixels[26], 0.5, 1e-6);
  conic_image_release(f.context, &map);
  check_confetti(&f);
  conic_image_release(f.context, &f.image);
  CHECK_OK(conic_image_allocate(f.context, 7, 1, 1u << CONIC_PLANE_RGBA, &f.image));
  memset(&map, 0x55, sizeof map);
  CHECK(conic_image_overdraw(f.context, &f.image, &map) == CONIC_ERROR_ARGUMENT && !map.planes[CONIC_PLANE_RGBA]);
  fixture_close(&f);
  return check_result();
}
