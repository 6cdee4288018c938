/* Comparing images: answers worked out by hand, or by the definition written down plainly. */
#include "core/base/color.h"
#include "tests/support/image_fixture.h"

static conic_image flat_image(conic_context *context, int width, int height, float value) {
  conic_image image;
  CHECK_OK(conic_image_allocate(context, width, height, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int i = 0; i < width * height; i++) {
    rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = value;
    rgba[4 * i + 3] = 1.0f;
  }
  return image;
}

static conic_difference compare(conic_context *context, const conic_image *a, const conic_image *b) {
  conic_difference difference;
  memset(&difference, 0xff, sizeof difference);
  CHECK_OK(conic_image_compare(context, a, b, &difference));
  return difference;
}

static void test_identical(conic_context *context) {
  conic_image image = random_image(context, 37, 29, EVERY_PLANE); /* with NaN and infinities */
  conic_difference difference = compare(context, &image, &image);
  CHECK(difference.identical && difference.same_size && difference.has_color);
  CHECK(difference.max_abs == 0.0 && difference.rmse == 0.0 && difference.differing_pixels == 0);
  CHECK(isinf(difference.psnr) && difference.psnr > 0.0 && difference.ssim == 1.0);
  CHECK(difference.largest_hole == 0);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    CHECK(difference.planes[i].compared && difference.planes[i].max_abs == 0.0 && difference.planes[i].rmse == 0.0);
  conic_image_release(context, &image);
}

/* Two flat pictures whose encoded values are 0.5 and 0.6: the mean square is 0.01, so 20 dB; and with no variance only
 * the first factor of SSIM is left, (2·0.5·0.6 + C1)/(0.5² + 0.6² + C1). */
/* Where an image has no alpha, colours are all that both have. */
static void test_without_alpha(conic_context *context) {
  conic_image a = flat_image(context, 4, 4, 0.5f), b = flat_image(context, 4, 4, 0.25f);
  CHECK_NEAR(compare(context, &a, &b).rmse, 0.25 * sqrt(0.75), 1e-12);
  a.lacks_alpha = b.lacks_alpha = 1;
  CHECK_NEAR(compare(context, &a, &b).rmse, 0.25, 1e-12);
  ((float *)b.planes[CONIC_PLANE_RGBA])[3] = 0.0f;
  b.lacks_alpha = 0;
  conic_difference difference = compare(context, &a, &b);
  CHECK(difference.lacks_alpha && difference.max_abs == 0.25 && difference.p999 == 0.25);
  CHECK_NEAR(difference.rmse, 0.25, 1e-12);
  memcpy(a.planes[CONIC_PLANE_RGBA], b.planes[CONIC_PLANE_RGBA], 64 * sizeof(float));
  ((float *)a.planes[CONIC_PLANE_RGBA])[3] = 1.0f;
  difference = compare(context, &a, &b); /* what only one has differs from the 1 that the other one stands for */
  CHECK(!difference.identical && difference.differing_pixels == 0 && difference.max_abs == 0.0);
  conic_image heatmap;
  CHECK_OK(conic_image_heatmap(context, &a, &b, &heatmap));
  CHECK(((float *)heatmap.planes[CONIC_PLANE_RGBA])[2] == 0.0f);
  conic_image_release(context, &heatmap);
  ((float *)b.planes[CONIC_PLANE_RGBA])[3] = 1.0f;
  CHECK(compare(context, &a, &b).identical);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

static void test_flat(conic_context *context, int width, int height) {
  conic_image a = flat_image(context, width, height, (float)conic_srgb_decode(0.5));
  conic_image b = flat_image(context, width, height, (float)conic_srgb_decode(0.6));
  conic_difference difference = compare(context, &a, &b);
  double step = (double)((float *)b.planes[0])[0] - (double)((float *)a.planes[0])[0];
  CHECK_NEAR(difference.psnr, 20.0, 1e-5);
  CHECK_NEAR(difference.ssim, (0.6 + 1e-4) / (0.61 + 1e-4), 1e-6);
  CHECK_NEAR(difference.max_abs, step, 1e-12);
  CHECK_NEAR(difference.rmse, step * sqrt(0.75), 1e-12); /* three channels of four */
  CHECK(difference.differing_pixels == (size_t)(width * height) && !difference.identical);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

/* One channel off by 0.5 of the encoded scale in one of 50 pixels: the mean square is 0.25/150. */
static void test_one_sample(conic_context *context) {
  conic_image a = flat_image(context, 10, 5, 0.0f), b = flat_image(context, 10, 5, 0.0f);
  ((float *)b.planes[0])[4 * 23 + 1] = (float)conic_srgb_decode(0.5);
  conic_difference difference = compare(context, &a, &b);
  CHECK_NEAR(difference.psnr, 10.0 * log10(150.0 / 0.25), 1e-5);
  CHECK_NEAR(difference.max_abs, conic_srgb_decode(0.5), 1e-7);
  CHECK_NEAR(difference.rmse, conic_srgb_decode(0.5) / sqrt(200.0), 1e-7);
  CHECK(difference.differing_pixels == 1);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

/* Very good and very bad pictures: the logarithm holds over the range. */
static void test_psnr_range(conic_context *context) {
  for (double step = 1.0; step > 1e-4; step *= 0.37) {
    conic_image a = flat_image(context, 3, 3, 0.0f), b = flat_image(context, 3, 3, (float)conic_srgb_decode(step));
    double encoded = conic_srgb_encode((double)((float *)b.planes[0])[0]);
    CHECK_NEAR(compare(context, &a, &b).psnr, -20.0 * log10(encoded), 1e-11);
    conic_image_release(context, &a);
    conic_image_release(context, &b);
  }
}

static double encoded_at(const conic_image *image, int x, int y, int c) {
  if (x < 0 || x >= image->width || y < 0 || y >= image->height)
    return 0.0;
  return conic_srgb_encode((double)((float *)image->planes[0])[4 * (y * image->width + x) + c]);
}

/* One window by the definition: weights from exp, moments about the means. */
static double plain_window(const conic_image *a, const conic_image *b, int left, int top, int c) {
  double sum = 0.0, mean_a = 0.0, mean_b = 0.0, variance_a = 0.0, variance_b = 0.0, covariance = 0.0;
  for (int pass = 0; pass < 3; pass++)
    for (int i = 0; i < 121; i++) {
      int dx = i % 11, dy = i / 11;
      double weight = exp(-((dx - 5) * (dx - 5) + (dy - 5) * (dy - 5)) / (2.0 * 1.5 * 1.5));
      double p = encoded_at(a, left + dx, top + dy, c), q = encoded_at(b, left + dx, top + dy, c);
      if (pass == 0)
        sum += weight;
      else if (pass == 1) {
        mean_a += weight / sum * p;
        mean_b += weight / sum * q;
      } else {
        variance_a += weight / sum * (p - mean_a) * (p - mean_a);
        variance_b += weight / sum * (q - mean_b) * (q - mean_b);
        covariance += weight / sum * (p - mean_a) * (q - mean_b);
      }
    }
  return (2 * mean_a * mean_b + 1e-4) * (2 * covariance + 9e-4) /
         ((mean_a * mean_a + mean_b * mean_b + 1e-4) * (variance_a + variance_b + 9e-4));
}

static void test_ssim_by_definition(conic_context *context) {
  const int width = 19, height = 14;
  conic_image a = flat_image(context, width, height, 0.0f), b = flat_image(context, width, height, 0.0f);
  uint64_t state = 3;
  double sum = 0.0, padded = 0.0;
  for (int i = 0; i < width * height * 4; i++) {
    if (i % 4 == 3)
      continue;
    ((float *)a.planes[0])[i] = (float)(next_random(&state) >> 8) / 16777216.0f;
    ((float *)b.planes[0])[i] = 0.5f * ((float *)a.planes[0])[i] + (float)(next_random(&state) >> 9) / 16777216.0f;
  }
  for (int c = 0; c < 3; c++)
    for (int y = -5; y + 6 <= height; y++)
      for (int x = -5; x + 6 <= width; x++) {
        double window = plain_window(&a, &b, x, y, c);
        padded += window;
        sum += x >= 0 && y >= 0 && x + 11 <= width && y + 11 <= height ? window : 0.0;
      }
  double expected = sum / (3 * (width - 10) * (height - 10));
  CHECK(expected > 0.1 && expected < 0.95);
  CHECK_NEAR(compare(context, &a, &b).ssim, expected, 1e-12);
  CHECK_NEAR(compare(context, &a, &b).ssim_padded, padded / (3 * width * height), 1e-12);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

/* NaN against a number is as far as can be; NaN against the same NaN is equal; the two zeros differ by nothing but
 * bits. */
static void test_odd_values(conic_context *context) {
  conic_image a = flat_image(context, 20, 20, 0.5f), b = flat_image(context, 20, 20, 0.5f);
  float *p = a.planes[0], *q = b.planes[0];
  p[0] = NAN;
  q[0] = NAN;
  p[4] = 0.0f;
  q[4] = -0.0f;
  p[8] = q[8] = INFINITY;
  conic_difference difference = compare(context, &a, &b);
  CHECK(!difference.identical && difference.differing_pixels == 1);
  CHECK(difference.max_abs == 0.0 && difference.rmse == 0.0 && isinf(difference.psnr) && difference.ssim == 1.0);
  q[0] = 0.0f;
  difference = compare(context, &a, &b);
  CHECK(isinf(difference.max_abs) && isinf(difference.rmse) && difference.differing_pixels == 2);
  CHECK(isfinite(difference.psnr) && difference.psnr < 31.0 && difference.ssim < 1.0);
  q[0] = NAN;
  q[8] = -INFINITY;
  difference = compare(context, &a, &b);
  CHECK(isinf(difference.max_abs) && difference.differing_pixels == 2);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

static void test_planes_and_sizes(conic_context *context) {
  unsigned rgba = 1u << CONIC_PLANE_RGBA, id = 1u << CONIC_PLANE_ID, count = 1u << CONIC_PLANE_COUNT;
  conic_image a, b;
  CHECK_OK(conic_image_allocate(context, 5, 4, rgba | id | count, &a));
  CHECK_OK(conic_image_allocate(context, 5, 4, rgba | id | 1u << CONIC_PLANE_Z, &b));
  ((uint32_t *)b.planes[CONIC_PLANE_ID])[7] = 300;
  conic_difference difference = compare(context, &a, &b);
  CHECK(!difference.identical && difference.max_abs == 0.0 && difference.rmse == 0.0);
  CHECK(difference.differing_pixels == 1 && difference.planes[CONIC_PLANE_ID].max_abs == 300.0);
  CHECK_NEAR(difference.planes[CONIC_PLANE_ID].rmse, 300.0 / sqrt(20.0), 1e-12);
  CHECK(!difference.planes[CONIC_PLANE_Z].compared && !difference.planes[CONIC_PLANE_COUNT].compared);
  ((uint32_t *)b.planes[CONIC_PLANE_ID])[7] = 0;
  CHECK(!compare(context, &a, &b).identical); /* the planes are not the same */
  conic_image_release(context, &b);
  CHECK_OK(conic_image_allocate(context, 4, 5, rgba | id | count, &b));
  difference = compare(context, &a, &b);
  CHECK(!difference.identical && !difference.same_size && !difference.has_color && !difference.planes[0].compared);
  conic_image_release(context, &b);
  CHECK_OK(conic_image_allocate(context, 5, 4, id, &b));
  CHECK(!compare(context, &a, &b).has_color);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

/* Paints `#` of a picture of text as covered, by any one plane. */
static conic_image text_image(conic_context *context, conic_plane plane, const char *text, int width) {
  int height = (int)strlen(text) / width, n_channels = conic_plane_describe(plane)->n_channels;
  conic_image image;
  CHECK_OK(conic_image_allocate(context, width, height, 1u << plane, &image));
  for (int i = 0; i < width * height; i++)
    if (plane == CONIC_PLANE_ID || plane == CONIC_PLANE_CLUSTER || plane == CONIC_PLANE_LAST)
      ((uint32_t *)image.planes[plane])[i] = text[i] == '#' ? 0 : CONIC_NO_ID;
    else if (plane == CONIC_PLANE_COUNT || plane == CONIC_PLANE_DOUBT || plane == CONIC_PLANE_SAMPLES)
      ((uint32_t *)image.planes[plane])[i] = text[i] == '#';
    else if (plane == CONIC_PLANE_TRANSPARENCY)
      ((float *)image.planes[plane])[i] = text[i] == '#' ? 0.5f : 1.0f;
    else
      ((float *)image.planes[plane])[(i + 1) * n_channels - 1] = text[i] == '#' ? 0.5f : 0.0f;
  return image;
}

/* Holes: 5 pixels in a bent line, 1 beside it by a corner only, 3 at the rim; what only the second covers is none; what
 * ends one row and begins the next does not touch. */
static void test_holes(conic_context *context) {
  static const char full[] = "########"
                             "########"
                             "########"
                             "#######."
                             "########";
  static const char holed[] = "########"
                              "#..#####"
                              ".#.#####"
                              "##..####"
                              "#####...";
  static const char wrapped[] = "######.."
                                "..######"
                                "########"
                                "########"
                                "########";
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    conic_image a = text_image(context, (conic_plane)i, full, 8), b = text_image(context, (conic_plane)i, holed, 8);
    conic_image c = text_image(context, (conic_plane)i, wrapped, 8);
    CHECK(compare(context, &a, &b).largest_hole == 5);
    CHECK(compare(context, &b, &a).largest_hole == 1); /* the end of row 3 */
    CHECK(compare(context, &a, &c).largest_hole == 2);
    conic_image_release(context, &a);
    conic_image_release(context, &b);
    conic_image_release(context, &c);
  }
}

/* A hole of a million pixels, as a whole and as a comb. */
static void test_large_holes(conic_context *context) {
  const int size = 1000;
  conic_image a, b;
  CHECK_OK(conic_image_allocate(context, size, size, 1u << CONIC_PLANE_Z, &a));
  CHECK_OK(conic_image_allocate(context, size, size, 1u << CONIC_PLANE_Z, &b));
  for (int i = 0; i < size * size; i++)
    ((float *)a.planes[CONIC_PLANE_Z])[i] = 1.0f;
  CHECK(compare(context, &a, &b).largest_hole == 1000000);
  for (int i = 0; i < size * size; i++)
    ((float *)b.planes[CONIC_PLANE_Z])[i] = i % size % 2 && i / size > 0 ? 1.0f : 0.0f;
  CHECK(compare(context, &a, &b).largest_hole == 1000 + 500 * 999);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

static void check_pixel(const conic_image *image, int i, float r, float g, float b) {
  const float *pixel = (const float *)image->planes[CONIC_PLANE_RGBA] + 4 * i;
  CHECK_NEAR(pixel[0], r, 1e-6);
  CHECK_NEAR(pixel[1], g, 1e-6);
  CHECK_NEAR(pixel[2], b, 1e-6);
  CHECK(pixel[3] == 1.0f);
}

static void test_heatmap(conic_context *context) {
  conic_image a = flat_image(context, 8, 1, 0.0f), b = flat_image(context, 8, 1, 0.0f), map;
  float *p = b.planes[CONIC_PLANE_RGBA];
  p[4 * 1] = ldexpf(1.0f, -20);
  p[4 * 2 + 1] = ldexpf(1.0f, -10); /* half way on the logarithmic scale: between red and yellow */
  p[4 * 3 + 2] = 1.0f;
  p[4 * 4] = NAN;
  p[4 * 5] = 1e-30f;
  p[4 * 6] = -0.0f;
  p[4 * 7 + 3] = -50.0f; /* alpha counts too */
  CHECK_OK(conic_image_heatmap(context, &a, &b, &map));
  check_pixel(&map, 0, 0, 0, 0);
  check_pixel(&map, 1, 0, 0, 1);
  check_pixel(&map, 2, 1, 0.5f, 0);
  check_pixel(&map, 3, 1, 1, 1);
  check_pixel(&map, 4, 1, 1, 1);
  check_pixel(&map, 5, 0, 0, 1);
  check_pixel(&map, 6, 0, 0, 0);
  check_pixel(&map, 7, 1, 1, 1);
  conic_image_release(context, &map);
  conic_image_release(context, &b);
  b = flat_image(context, 4, 2, 0.0f);
  memset(&map, 0x55, sizeof map);
  CHECK(conic_image_heatmap(context, &a, &b, &map) == CONIC_ERROR_ARGUMENT && !map.planes[CONIC_PLANE_RGBA]);
  conic_image_release(context, &b);
  CHECK_OK(conic_image_allocate(context, 8, 1, 1u << CONIC_PLANE_Z, &b));
  CHECK(conic_image_heatmap(context, &a, &b, &map) == CONIC_ERROR_ARGUMENT);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

/* Out of memory at every allocation in turn: no crash, and the status says so. */
typedef struct short_allocator {
  int left;
} short_allocator;

static void *allocate_few(void *cookie, size_t n_bytes) {
  short_allocator *allocator = cookie;
  return allocator->left-- > 0 ? malloc(n_bytes) : NULL;
}

static void release_any(void *cookie, void *pointer) {
  (void)cookie;
  free(pointer);
}

static void test_memory(conic_context *context) {
  conic_image a = random_image(context, 30, 20, EVERY_PLANE), b = random_image(context, 30, 20, EVERY_PLANE);
  short_allocator allocator = {1000};
  conic_context_options options;
  conic_context *poor;
  conic_difference difference;
  int n_failed = 0;
  conic_context_options_init(&options);
  options.allocate = allocate_few;
  options.release = release_any;
  options.allocator_cookie = &allocator;
  options.threads = 1;
  ((float *)b.planes[CONIC_PLANE_RGBA])[3] = 1.0f;
  CHECK_OK(conic_context_create(&options, &poor));
  for (int n = 0; n < 100; n++) {
    allocator.left = n;
    conic_status status = conic_image_compare(poor, &a, &b, &difference);
    if (status == CONIC_OK)
      break;
    CHECK(status == CONIC_ERROR_MEMORY);
    n_failed++;
  }
  CHECK(n_failed >= 3 && n_failed < 100);
  conic_context_destroy(poor);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

/* The numbers are the same whatever the threads. */
static void test_threads(conic_context *context) {
  conic_image a = random_image(context, 90, 70, EVERY_PLANE), b = flat_image(context, 90, 70, 0.3f);
  conic_context *alone = check_context(1);
  conic_difference one = compare(alone, &a, &b), many = compare(context, &a, &b);
  CHECK(one.ssim == many.ssim && one.psnr == many.psnr && one.differing_pixels == many.differing_pixels);
  CHECK(isfinite(one.psnr) && isfinite(one.ssim));
  conic_context_destroy(alone);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

int main(void) {
  conic_context *context = check_context(3);
  test_identical(context);
  test_without_alpha(context);
  test_flat(context, 16, 12);
  test_flat(context, 40, 10); /* too small for a window */
  test_flat(context, 1, 1);
  test_one_sample(context);
  test_psnr_range(context);
  test_ssim_by_definition(context);
  test_odd_values(context);
  test_planes_and_sizes(context);
  test_holes(context);
  test_large_holes(context);
  test_heatmap(context);
  test_memory(context);
  test_threads(context);
  conic_context_destroy(context);
  return check_result();
}
