/* Display values beside linear ones, and pictures with fewer pixels: answers worked out by hand. */
#include "core/base/color.h"
#include "core/image/compare.h"
#include "tests/support/image_fixture.h"

static conic_image grey(conic_context *context, float value, float alpha, int is_display) {
  conic_image image;
  CHECK_OK(conic_image_allocate(context, 16, 14, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int i = 0; i < 16 * 14 * 4; i++)
    rgba[i] = i % 4 == 3 ? alpha : value * alpha;
  image.is_display = (uint64_t)is_display;
  return image;
}

/* 0.5 on the screen against 0.6, of whatever kind both are: 20 dB, 0.1 where one is a display value. */
static void test_kinds(conic_context *context) {
  double flip = -1.0;
  for (int kinds = 0; kinds < 4; kinds++) {
    int is_a = kinds & 1, is_b = kinds >> 1;
    conic_image a = grey(context, is_a ? 0.5f : (float)conic_srgb_decode(0.5), 1.0f, is_a);
    conic_image b = grey(context, is_b ? 0.6f : (float)conic_srgb_decode(0.6), 1.0f, is_b);
    conic_difference difference;
    CHECK_OK(conic_image_compare(context, &a, &b, &difference));
    CHECK_NEAR(difference.psnr, 20.0, 1e-5);
    CHECK_NEAR(difference.ssim, (0.6 + 1e-4) / (0.61 + 1e-4), 1e-6);
    CHECK(difference.is_display == (kinds != 0) && difference.over_code == 16 * 14 && !difference.identical);
    if (kinds)
      CHECK_NEAR(difference.max_abs, 0.1, 1e-6);
    if (flip < 0.0)
      flip = difference.flip;
    CHECK(flip > 0.01);
    CHECK_NEAR(difference.flip, flip, 1e-6);
    CHECK(a.is_display == (uint64_t)is_a && b.is_display == (uint64_t)is_b); /* which are only read */
    conic_image_release(context, &a);
    conic_image_release(context, &b);
  }
}

/* What files of 8 bits have of display values under alpha is what these are. */
static void test_alpha(conic_context *context) {
  conic_image linear = grey(context, (float)conic_srgb_decode(0.7), 0.5f, 0), display = grey(context, 0.7f, 0.5f, 1);
  conic_difference difference;
  CHECK_OK(conic_image_compare(context, &linear, &display, &difference));
  CHECK(difference.max_abs < 1e-7 && difference.flip < 1e-5);
  conic_image heatmaps[2];
  CHECK_OK(conic_image_heatmap(context, &linear, &display, &heatmaps[0]));
  conic_image_encode(&linear);
  CHECK(linear.is_display == 1);
  CHECK_NEAR(((float *)linear.planes[0])[0], 0.35, 1e-7);
  CHECK_OK(conic_image_heatmap(context, &linear, &display, &heatmaps[1]));
  CHECK(conic_image_hash(&heatmaps[0], CONIC_PLANE_RGBA) == conic_image_hash(&heatmaps[1], CONIC_PLANE_RGBA));
  uint64_t hash = conic_image_hash(&linear, CONIC_PLANE_RGBA);
  conic_image_encode(&linear); /* once is enough */
  CHECK(conic_image_hash(&linear, CONIC_PLANE_RGBA) == hash);
  conic_image_release(context, &heatmaps[0]);
  conic_image_release(context, &heatmaps[1]);
  conic_image_release(context, &linear);
  conic_image_release(context, &display);
}

/* Three columns become two: the middle one goes half to each. Two rows become one. */
static void test_boxes(conic_context *context) {
  conic_image image, reduced;
  CHECK_OK(conic_image_allocate(context, 3, 2, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  const float red[6] = {1, 4, 7, 3, 8, 5};
  for (int i = 0; i < 6; i++)
    rgba[4 * i] = red[i];
  image.is_display = image.lacks_alpha = 1;
  CHECK_OK(conic_image_reduce(context, &image, 2, 1, &reduced));
  const float *mean = reduced.planes[CONIC_PLANE_RGBA];
  CHECK(reduced.width == 2 && reduced.height == 1 && reduced.is_display && reduced.lacks_alpha);
  CHECK_NEAR(mean[0], (1 + 0.5 * 4 + 3 + 0.5 * 8) / 3.0, 1e-6);
  CHECK_NEAR(mean[4], (0.5 * 4 + 7 + 0.5 * 8 + 5) / 3.0, 1e-6);
  CHECK(mean[1] == 0.0f && mean[3] == 0.0f);
  conic_image_release(context, &reduced);
  CHECK_OK(conic_image_reduce(context, &image, 3, 2, &reduced));
  CHECK(conic_image_hash(&image, CONIC_PLANE_RGBA) == conic_image_hash(&reduced, CONIC_PLANE_RGBA));
  conic_image_release(context, &reduced);
  CHECK(conic_image_reduce(context, &image, 4, 2, &reduced) == CONIC_ERROR_ARGUMENT);
  conic_image_release(context, &image);
}

int main(void) {
  conic_context *context = check_context(2);
  test_kinds(context);
  test_alpha(context);
  test_boxes(context);
  conic_context_destroy(context);
  return check_result();
}
