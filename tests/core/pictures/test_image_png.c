/* PNG files of every kind: what their samples become, that OpenImageIO's are the same, and files that are not sound. */
#include "core/base/color.h"
#include "core/pictures/image_foreign.h"
#include "tests/support/image_fixture.h"
#include "tests/support/png_file.h"

static double color_of(unsigned value, int depth) {
  return conic_srgb_decode((double)value / (double)((1u << depth) - 1));
}

/* Whether tRNS makes the pixel invisible: it is of the colour of the first one. */
static int is_marked(const png_kind *kind, uint32_t x, uint32_t y) {
  for (int c = 0; c < png_n_channels(kind->kind); c++)
    if (png_sample(kind, x, y, c) != png_sample(kind, 0, 0, c))
      return 0;
  return kind->has_transparency;
}

/* The pixel by the format's definition. */
static void expect_pixel(const png_kind *kind, uint32_t x, uint32_t y, double rgba[4]) {
  int n = png_n_channels(kind->kind), most = (1 << kind->depth) - 1;
  unsigned first = png_sample(kind, x, y, 0);
  rgba[3] = 1.0;
  if (kind->kind == PNG_BY_PALETTE && kind->has_transparency)
    rgba[3] = first == 0 ? 0.0 : first == 1 ? 100.0 / 255.0 : 1.0;
  else if (kind->kind == PNG_GREY_ALPHA || kind->kind == PNG_COLOR_ALPHA)
    rgba[3] = (double)png_sample(kind, x, y, n - 1) / most;
  else if (is_marked(kind, x, y))
    rgba[3] = 0.0;
  for (int c = 0; c < 3; c++)
    rgba[c] = rgba[3] * (kind->kind == PNG_BY_PALETTE ? color_of(png_entry(first, c), 8)
                                                      : color_of(png_sample(kind, x, y, n < 3 ? 0 : c), kind->depth));
}

static void test_kind(conic_context *context, const png_kind *kind) {
  static png_file file;
  conic_image image, other;
  int failures_before = check_failures;
  png_make(&file, kind);
  write_bytes(in_folder("a.png"), file.bytes, file.n_bytes);
  CHECK_OK(conic_image_read(context, in_folder("a.png"), &image));
  CHECK(image.width == (int)kind->width && image.height == (int)kind->height);
  CHECK(conic_image_planes(&image) == 1u << CONIC_PLANE_RGBA);
  const float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (uint32_t i = 0; rgba && i < kind->width * kind->height; i++) {
    double expected[4];
    expect_pixel(kind, i % kind->width, i / kind->width, expected);
    for (int c = 0; c < 4; c++)
      CHECK_NEAR(rgba[4 * i + (uint32_t)c], expected[c], 1e-6);
  }
  if (has_feature("OpenImageIO")) {
    CHECK_OK(conic_foreign_read(context, in_folder("a.png"), &other));
    CHECK(same_planes(&image, &other));
    conic_image_release(context, &other);
  }
  conic_image_release(context, &image);
  if (check_failures > failures_before)
    fprintf(stderr, "kind %d, depth %d, interlaced %d, tRNS %d, gamma %d, %u x %u\n", kind->kind, kind->depth,
            kind->is_interlaced, kind->has_transparency, kind->has_gamma, kind->width, kind->height);
}

static void test_kinds(conic_context *context) {
  static const int kinds[] = {PNG_GREY, PNG_COLOR, PNG_BY_PALETTE, PNG_GREY_ALPHA, PNG_COLOR_ALPHA};
  static const uint32_t sizes[][2] = {{1, 1}, {13, 9}, {3, 20}};
  int n_read = 0;
  for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
    for (int depth = 1; depth <= 16; depth *= 2)
      for (int more = 0; more < 12; more++) {
        int is_packed = depth<8, has_alpha = kinds[i]> PNG_BY_PALETTE;
        png_kind kind = {.kind = kinds[i], .depth = depth, .is_interlaced = more % 2};
        kind.has_transparency = more / 2 % 2;
        kind.has_gamma = more / 4;
        if ((is_packed && kinds[i] != PNG_GREY && kinds[i] != PNG_BY_PALETTE) ||
            (depth > 8 && kinds[i] == PNG_BY_PALETTE) || (has_alpha && kind.has_transparency))
          continue;
        for (size_t size = 0; size < sizeof sizes / sizeof sizes[0]; size++) {
          kind.width = sizes[size][0];
          kind.height = sizes[size][1];
          test_kind(context, &kind);
          n_read++;
        }
      }
  CHECK(n_read > 300);
}

/* What is written has the samples that OpenImageIO would write, and straight alpha; and the same bytes by any number of
 * threads, though the picture has several strips. */
static void test_written(conic_context *context, int height) {
  conic_image image = random_image(context, 301, height, 1u << CONIC_PLANE_RGBA), back, other;
  conic_context *alone = check_context(1);
  unsigned char *bytes[2];
  size_t n_bytes[2];
  CHECK_OK(conic_image_write(alone, in_folder("b.png"), &image));
  CHECK_OK(conic_image_write(context, in_folder("a.png"), &image));
  for (int i = 0; i < 2; i++)
    bytes[i] = read_bytes(in_folder(i ? "b.png" : "a.png"), &n_bytes[i]);
  CHECK(n_bytes[0] == n_bytes[1] && memcmp(bytes[0], bytes[1], n_bytes[0]) == 0);
  free(bytes[0]);
  free(bytes[1]);
  conic_context_destroy(alone);
  CHECK_OK(conic_image_read(context, in_folder("a.png"), &back));
  if (has_feature("OpenImageIO")) {
    CHECK_OK(conic_foreign_write(context, in_folder("b.png"), "png", &image, CONIC_TONE_SRGB));
    CHECK_OK(conic_foreign_read(context, in_folder("b.png"), &other));
    CHECK(same_planes(&back, &other));
    conic_image_release(context, &other);
  }
  conic_image_release(context, &back);
  conic_image_release(context, &image);
}

/* A header that promises more than its file can hold is refused before there is room for it; a wrong sum, an end that
 * is missing, and a size beyond all bounds, too. */
static void test_unsound(conic_context *context) {
  static png_file file;
  conic_image image;
  const png_kind large = {.width = 60000, .height = 60000, .kind = PNG_COLOR_ALPHA, .depth = 16};
  const png_kind wide = {.width = 70000, .height = 1, .kind = PNG_GREY, .depth = 1};
  png_kind small = {.width = 4, .height = 4, .kind = PNG_COLOR, .depth = 8};
  for (int i = 0; i < 4; i++) {
    png_make(&file, &small);
    if (i == 0)
      file.n_bytes -= 12;
    else if (i == 1)
      file.bytes[60] ^= 1;
    else if (i == 2) {
      file.n_bytes = 8;
      unsigned char header[13] = {0, 0, 0, 0, 0, 0, 0, 0, 16, PNG_COLOR_ALPHA};
      png_put(header, large.width);
      png_put(header + 4, large.height);
      png_chunk(&file, "IHDR", header, sizeof header);
      png_chunk(&file, "IDAT", "x", 1);
    } else
      png_make(&file, &wide);
    write_bytes(in_folder("a.png"), file.bytes, file.n_bytes);
    CHECK(conic_image_read(context, in_folder("a.png"), &image) == CONIC_ERROR_INPUT);
    CHECK(conic_image_planes(&image) == 0);
  }
}

int main(void) {
  conic_context *context = check_context(2);
  if (!has_feature("libpng")) {
    conic_context_destroy(context);
    fprintf(stderr, "skipped: this build is without libpng\n");
    return 77;
  }
  open_test_folder();
  test_kinds(context);
  test_written(context, 47);
  test_written(context, 331);
  test_unsound(context);
  close_test_folder();
  conic_context_destroy(context);
  return check_result();
}
