/* Automatic exposure, by its definition. */
#include "conic/image.h"
#include "core/base/color.h"
#include "tests/support/image_fixture.h"

enum { WIDTH = 20, HEIGHT = 10, N = WIDTH * HEIGHT };

static conic_image gray_image(conic_context *context, float gray, float alpha) {
  conic_image image;
  CHECK(conic_image_allocate(context, WIDTH, HEIGHT, 1u << CONIC_PLANE_RGBA, &image) == CONIC_OK);
  float *pixel = image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < N; i++, pixel += 4) {
    pixel[0] = pixel[1] = pixel[2] = gray * alpha;
    pixel[3] = alpha;
  }
  return image;
}

/* Pixels that are brighter than 2^(-3/8) with an exposure. */
static int count_white(const conic_image *image, double stops) {
  const float *pixel = image->planes[CONIC_PLANE_RGBA];
  int n = 0;
  for (size_t i = 0; i < N; i++, pixel += 4) {
    double luminance = 0.2126 * (double)pixel[0] + 0.7152 * (double)pixel[1] + 0.0722 * (double)pixel[2];
    n += pixel[3] >= 0.5f && luminance > (double)conic_exposure_factor(-0.375 - stops) * (double)pixel[3];
  }
  return n;
}

static void check_gray(conic_context *context) {
  const struct {
    float gray, alpha;
    double stops;
  } cases[] = {{0.77f, 1, 0},      {0.78f, 1, -0.125}, {0.385f, 1, 1},     {0.385f, 0.75f, 1},
               {0.385f, 0.25f, 0}, {0.0481f, 1, 4},    {7.7e4f, 1, -16},   {7.7e6f, 1, -16},
               {0, 1, 0},          {1e-6f, 1, 0},      {1.3e-5f, 1, 15.75}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    conic_image image = gray_image(context, cases[i].gray, cases[i].alpha);
    CHECK_NEAR(conic_image_exposure(&image), cases[i].stops, 0.0);
    conic_image_release(context, &image);
  }
}

/* One pixel in twenty may be white, whatever is beside it; what is not covered counts as little as what is no number.
 */
static void check_share(conic_context *context) {
  conic_image image = gray_image(context, 0.385f, 1.0f);
  float *pixel = image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < N / 20; i++)
    pixel[4 * i + 1] = 1e30f;
  CHECK(conic_image_exposure(&image) == 1.0);
  for (size_t i = 50; i < 70; i++)
    pixel[4 * i + 3] = 0.0f;
  CHECK(conic_image_exposure(&image) == -16.0); /* 10 of 180 are more than one in twenty */
  for (size_t i = 0; i < 10; i++)
    pixel[4 * i + 1] = (float)NAN;
  CHECK(conic_image_exposure(&image) == 1.0);
  conic_image_release(context, &image);
}

static void check_definition(conic_context *context) {
  conic_image image = gray_image(context, 0.5f, 1.0f);
  float *pixel = image.planes[CONIC_PLANE_RGBA];
  uint32_t random = 1;
  for (size_t i = 0; i < 4 * N; i++) {
    random = random * 1664525u + 1013904223u;
    pixel[i] = (float)(random >> 8) / 16777216.0f;
  }
  int n_covered = 0;
  for (size_t i = 0; i < N; i++)
    n_covered += pixel[4 * i + 3] >= 0.5f;
  double stops = conic_image_exposure(&image);
  CHECK(count_white(&image, stops) * 20 <= n_covered);
  CHECK(count_white(&image, stops + 0.125) * 20 > n_covered);
  conic_image_release(context, &image);
}

int main(void) {
  conic_context *context = check_context(1);
  const conic_image none = {0};
  CHECK(conic_image_exposure(&none) == 0.0);
  check_gray(context);
  check_share(context);
  check_definition(context);
  conic_context_destroy(context);
  return check_result();
}
