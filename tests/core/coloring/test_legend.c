/* The legend: its colours are those of the values, and it stays within the picture. */
#include "core/coloring/glyphs.h"
#include "core/coloring/legend.h"
#include "tests/support/check.h"

static conic_context *context;

static const float *pixel(const conic_image *image, int x, int y) {
  return (const float *)image->planes[CONIC_PLANE_RGBA] + 4 * ((size_t)y * (size_t)image->width + (size_t)x);
}

/* How many pixels have that colour. */
static int count(const conic_image *image, const float color[3]) {
  int n = 0;
  for (int y = 0; y < image->height; y++)
    for (int x = 0; x < image->width; x++)
      n += memcmp(pixel(image, x, y), color, 3 * sizeof *color) == 0;
  return n;
}

static conic_coloring bar(double minimum, double maximum) {
  conic_coloring coloring = {.field = "height", .ramp = "sequential", .minimum = minimum, .maximum = maximum};
  return coloring;
}

static void test_bar(int is_root) {
  conic_image image;
  conic_coloring coloring = bar(10.0, 30.0);
  float lightest[3], darkest[3];
  coloring.is_root = is_root;
  CHECK_OK(conic_legend_make(context, &coloring, "", &image));
  int left = 2 * 5 + 1, top = 2 * (5 + 12), bottom = image.height - 2 * 5 - 1;
  double n = (double)(bottom - top + 1), t = 0.5 / n;
  conic_coloring_color(&coloring, 10.0 + 20.0 * (is_root ? t * t : t), darkest);
  conic_coloring_color(&coloring, 30.0 - 20.0 * (is_root ? 1.0 - (1.0 - t) * (1.0 - t) : t), lightest);
  for (int channel = 0; channel < 3; channel++) {
    CHECK_NEAR((double)pixel(&image, left, bottom)[channel], (double)darkest[channel], 1e-5);
    CHECK_NEAR((double)pixel(&image, left, top)[channel], (double)lightest[channel], 1e-5);
  }
  for (int i = 0; i < image.width * image.height; i++)
    CHECK(pixel(&image, i % image.width, i / image.width)[3] == 1.0f);
  conic_image_release(context, &image);
}

static void test_classes_and_axes(void) {
  conic_image image;
  conic_coloring coloring = {.field = "classification", .ramp = "classes", .classes = {1u << 2 | 1u << 9}};
  float ground[3], water[3], building[3];
  conic_coloring_color(&coloring, 2.0, ground);
  conic_coloring_color(&coloring, 9.0, water);
  conic_coloring_color(&coloring, 6.0, building);
  CHECK_OK(conic_legend_make(context, &coloring, "", &image));
  CHECK(count(&image, ground) == 256 && count(&image, water) == 256 && count(&image, building) == 0);
  conic_image_release(context, &image);
  coloring = (conic_coloring){.field = "normal"};
  CHECK_OK(conic_legend_make(context, &coloring, "", &image));
  conic_image_release(context, &image);
}

/* The unit of lengths stands in the title of heights alone. */
static void test_units(void) {
  conic_image images[3];
  conic_coloring coloring = bar(10.0, 30.0);
  CHECK_OK(conic_legend_make(context, &coloring, "", &images[0]));
  CHECK_OK(conic_legend_make(context, &coloring, "us-ft", &images[1]));
  CHECK(images[1].width > images[0].width);
  coloring = (conic_coloring){.field = "intensity", .ramp = "sequential", .maximum = 30.0};
  CHECK_OK(conic_legend_make(context, &coloring, "", &images[2]));
  conic_image_release(context, &images[1]);
  CHECK_OK(conic_legend_make(context, &coloring, "us-ft", &images[1]));
  CHECK(images[1].width == images[2].width);
  CHECK(conic_image_hash(&images[1], CONIC_PLANE_RGBA) == conic_image_hash(&images[2], CONIC_PLANE_RGBA));
  for (int i = 0; i < 3; i++)
    conic_image_release(context, &images[i]);
}

/* Every range has a few numbers and ends; a picture that is too small is no trouble. */
static void test_sizes(void) {
  static const double ranges[][2] = {{0, 1},      {0, 1e-7},      {-1e300, 1e300},  {5, 5},           {1e9, 1e9 + 1},
                                     {0, 999999}, {-0.003, 0.01}, {1e-300, 2e-300}, {1e17, 1e17 + 16}};
  conic_image image;
  for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
    conic_coloring coloring = bar(ranges[i][0], ranges[i][1]);
    CHECK_OK(conic_legend_make(context, &coloring, "", &image));
    CHECK(image.width > 40 && image.width < 400);
    conic_image_release(context, &image);
    for (int size = 1; size < 2000; size = 5 * size + 3) {
      CHECK_OK(conic_image_allocate(context, size, size / 2 + 1, 1u << CONIC_PLANE_RGBA, &image));
      conic_legend_draw(&coloring, "", &image);
      CHECK(pixel(&image, 0, 0)[3] == 0.0f || size < 300);
      conic_image_release(context, &image);
    }
  }
}

static void test_glyphs(void) {
  CHECK(conic_glyph('a') == conic_glyph('A') && conic_glyph('A') != conic_glyph('B'));
  CHECK(conic_glyph('?') == conic_glyph('\x80') && conic_glyph('?') != conic_glyph(' '));
  CHECK(conic_glyph('1')[6] == 0x0e && conic_glyph('L')[0] == 0x10);
}

int main(void) {
  context = check_context(1);
  test_bar(0);
  test_bar(1);
  test_classes_and_axes();
  test_units();
  test_sizes();
  test_glyphs();
  conic_context_destroy(context);
  return check_result();
}
