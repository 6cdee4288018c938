/* PNG, and TIFF, JPEG, HDR through OpenImageIO: which codes colours become, and what comes back. */
#include "core/base/color.h"
#include "core/pictures/image_samples.h"
#include "tests/support/image_fixture.h"

static conic_image write_and_read(conic_context *context, const char *name, const conic_image *image) {
  conic_image back;
  memset(&back, 0, sizeof back);
  CHECK_OK(conic_image_write(context, in_folder(name), image));
  CHECK_OK(conic_image_read(context, in_folder(name), &back));
  CHECK(back.width == image->width && back.height == image->height);
  CHECK(conic_image_planes(&back) == 1u << CONIC_PLANE_RGBA);
  return back;
}

/* The codes are those of core/base/color.h for every float there is near a border between two, and for odd values. */
static void test_codes(conic_context *context) {
  static const float odd[] = {0.0f, -0.0f, -1.0f, 1.0f, 2.0f, INFINITY, -INFINITY, NAN, 1e-40f, 0.99999994f};
  enum { N = 255 * 3 + sizeof odd / sizeof odd[0] };
  float thresholds[255], rgba[4 * N];
  uint8_t samples[3 * N];
  conic_srgb_thresholds(thresholds);
  for (int i = 0; i < 255; i++) {
    rgba[12 * i] = nextafterf(thresholds[i], 0.0f);
    rgba[12 * i + 4] = thresholds[i];
    rgba[12 * i + 8] = nextafterf(thresholds[i], 2.0f);
  }
  for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++)
    rgba[4 * (255 * 3 + i)] = odd[i];
  for (int i = 0; i < N; i++) {
    rgba[4 * i + 1] = rgba[4 * i + 2] = rgba[4 * i];
    rgba[4 * i + 3] = 1.0f;
  }
  conic_samples_from_rgba(context, rgba, N, 1, (conic_samples_layout){3, 1, 0}, samples);
  for (int i = 0; i < 3 * N; i++)
    CHECK(samples[i] == conic_srgb_code(thresholds, rgba[4 * (i / 3)]));
  CHECK(samples[0] == 0 && samples[3] == 1);
}

/* Straight alpha: what is stored is the colour divided by alpha. Halves are chosen so that the codes are known. */
static void test_straight_codes(conic_context *context) {
  const float rgba[] = {0.5f, 0.25f, 0.0f, 0.5f, 0.3f, 0.3f, 0.3f, 0.0f, 1.0f, 0.5f, 0.0f, 1.0f};
  const uint8_t straight[] = {255, 188, 0, 128, 0, 0, 0, 0, 255, 188, 0, 255};
  const uint8_t black[] = {188, 137, 0, 149, 149, 149, 255, 188, 0};
  uint8_t samples[12];
  uint16_t wide[12];
  conic_samples_from_rgba(context, rgba, 3, 1, (conic_samples_layout){4, 1, 1}, samples);
  CHECK(memcmp(samples, straight, 12) == 0);
  conic_samples_from_rgba(context, rgba, 3, 1, (conic_samples_layout){3, 1, 0}, samples);
  CHECK(memcmp(samples, black, 9) == 0);
  conic_samples_from_rgba(context, rgba, 3, 1, (conic_samples_layout){4, 2, 1}, wide);
  CHECK(wide[0] == 65535 && wide[1] == 48192 && wide[3] == 32768); /* 48192.3: 65535 × encode(½) */
}

/* All codes in all channels of opaque pixels. */
static void test_png_exact(conic_context *context) {
  float table[256];
  conic_image image;
  conic_srgb_decode_table(table);
  CHECK_OK(conic_image_allocate(context, 256, 3, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int i = 0; i < 256 * 3; i++) {
    for (int c = 0; c < 3; c++)
      rgba[4 * i + c] = table[(i + 85 * c * (i / 256)) % 256];
    rgba[4 * i + 3] = 1.0f;
  }
  conic_image back = write_and_read(context, "a.png", &image);
  CHECK(same_planes(&image, &back));
  conic_image_release(context, &image);
  conic_image_release(context, &back);
}

/* A smooth picture, half of it half covered. */
static conic_image gradient(conic_context *context, int is_opaque) {
  conic_image image;
  CHECK_OK(conic_image_allocate(context, 64, 64, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int i = 0; i < 64 * 64; i++) {
    int x = i % 64, y = i / 64;
    rgba[4 * i + 3] = is_opaque || y < 32 ? 1.0f : (float)x / 63.0f;
    rgba[4 * i] = rgba[4 * i + 3] * (float)x / 63.0f;
    rgba[4 * i + 1] = rgba[4 * i + 3] * (float)y / 63.0f;
    rgba[4 * i + 2] = rgba[4 * i + 3] * 0.25f;
  }
  return image;
}

/* Colour and alpha come back within half a code each. The curve is steepest at the top, where a step of the encoded
 * scale is 2.28 of linear light. */
static void test_round_trip(conic_context *context, const char *name, double n_codes) {
  conic_image image = gradient(context, 0), back = write_and_read(context, name, &image);
  const float *a = image.planes[CONIC_PLANE_RGBA], *b = back.planes[CONIC_PLANE_RGBA];
  for (int i = 0; b && i < 64 * 64; i++) {
    CHECK_NEAR(a[4 * i + 3], b[4 * i + 3], 0.5 / n_codes + 1e-7);
    for (int c = 0; c < 3; c++)
      CHECK_NEAR(a[4 * i + c], b[4 * i + c], (2.28 * a[4 * i + 3] + 1.0) * 0.5 / n_codes + 1e-7);
  }
  conic_image_release(context, &image);
  conic_image_release(context, &back);
}

static void test_jpeg(conic_context *context) {
  conic_image image = gradient(context, 1), back = write_and_read(context, "a.jpg", &image);
  conic_difference difference;
  CHECK_OK(conic_image_compare(context, &image, &back, &difference));
  CHECK(difference.psnr > 40.0 && difference.ssim > 0.99);
  CHECK(!difference.identical);
  conic_image_release(context, &image);
  conic_image_release(context, &back);
}

/* Linear, with a shared exponent of 8 bits and 8 bits a channel: within 1/256 of the largest. */
static void test_hdr(conic_context *context) {
  conic_image image = gradient(context, 1);
  float *a = image.planes[CONIC_PLANE_RGBA];
  a[0] = 1000.0f;
  conic_image back = write_and_read(context, "a.hdr", &image);
  const float *b = back.planes[CONIC_PLANE_RGBA];
  for (int i = 0; b && i < 64 * 64; i++) {
    double largest = (double)fmaxf(a[4 * i], fmaxf(a[4 * i + 1], a[4 * i + 2]));
    for (int c = 0; c < 3; c++)
      CHECK_NEAR(a[4 * i + c], b[4 * i + c], largest / 128.0);
    CHECK(b[4 * i + 3] == 1.0f);
  }
  conic_image_release(context, &image);
  conic_image_release(context, &back);
}

int main(void) {
  conic_context *context = check_context(2);
  test_codes(context);
  test_straight_codes(context);
  open_test_folder();
  if (has_feature("libpng") || has_feature("OpenImageIO")) {
    test_png_exact(context);
    test_round_trip(context, "a.png", 255.0);
  }
  if (!has_feature("OpenImageIO")) {
    close_test_folder();
    conic_context_destroy(context);
    fprintf(stderr, "skipped: other files, as this build is without OpenImageIO\n");
    return check_result();
  }
  test_round_trip(context, "a.tif", 65535.0);
  test_round_trip(context, "a.tga", 255.0);
  test_jpeg(context);
  test_hdr(context);
  close_test_folder();
  conic_context_destroy(context);
  return check_result();
}
