/* ꟻLIP against the values of its authors' own program (flip-evaluator 1.7, 67 pixels a degree) on pictures made by
 * formula; percentiles and counts against plain sorting; powers against the C library's. */
#include "core/base/color.h"
#include "core/base/power.h"
#include "tests/support/image_fixture.h"

/* The 8-bit code of a channel of a pixel. */
typedef int pattern(int x, int y, int c);

static int texture(int x, int y, int c) {
  return (x * 37 + y * 101 + c * 59 + x * y * (c + 1)) % 256;
}

static int ramp(int x, int y, int c) {
  return c == 0 ? x * 255 / 299 : c == 1 ? y * 255 / 199 : (x / 8 + y / 8) % 2 * 255;
}

static int moved_ramp(int x, int y, int c) {
  return ramp(x > 2 ? x - 2 : 0, y, c);
}

static int dark_ramp(int x, int y, int c) {
  return ramp(x, y, c) * 9 / 10;
}

static int grey(int x, int y, int c) {
  (void)x, (void)y, (void)c;
  return 128;
}

static int grey_with_line(int x, int y, int c) {
  (void)y, (void)c;
  return x == 150 ? 228 : 128;
}

static conic_image draw(conic_context *context, int width, int height, pattern *code) {
  float table[256];
  conic_image image;
  conic_srgb_decode_table(table);
  CHECK_OK(conic_image_allocate(context, width, height, 1u << CONIC_PLANE_RGBA, &image));
  float *value = image.planes[CONIC_PLANE_RGBA];
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++, value += 4) {
      for (int c = 0; c < 3; c++)
        value[c] = table[code(x, y, c)];
      value[3] = 1.0f;
    }
  return image;
}

static conic_difference compare(conic_context *context, const conic_image *a, const conic_image *b) {
  conic_difference difference;
  CHECK_OK(conic_image_compare(context, a, b, &difference));
  return difference;
}

/* `published` is the mean of the program's map. It filters in float: where nothing is to be found, what is left of the
 * rounding of the sums goes through a square root, so its sixth digit is uncertain. `defined` is the same by the
 * paper's two-dimensional filters in double, from codes that are not rounded to float first; `bits` is what is computed
 * here, on every machine. */
static void test_published(conic_context *context, int width, int height, pattern *a_code, pattern *b_code,
                           double published, double defined, double bits) {
  conic_image a = draw(context, width, height, a_code), b = draw(context, width, height, b_code);
  double flip = compare(context, &a, &b).flip;
  CHECK_NEAR(flip, published, 1e-5);
  CHECK_NEAR(flip, defined, 2e-8);
  if (flip != bits)
    fprintf(stderr, "flip is %a\n", flip);
  CHECK(flip == bits);
  CHECK(compare(context, &b, &a).flip == flip); /* symmetric */
  CHECK(compare(context, &a, &a).flip == 0.0);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

/* The heat map is black where nothing is seen, brightest where most is: at the line. */
static void test_map(conic_context *context) {
  conic_image a = draw(context, 300, 20, grey), b = draw(context, 300, 20, grey_with_line), map;
  CHECK_OK(conic_image_flip_heatmap(context, &a, &b, &map));
  const float *row = (const float *)map.planes[CONIC_PLANE_RGBA] + (size_t)4 * 300 * 10;
  CHECK(row[4 * 100] == 0.0f && row[4 * 100 + 1] == 0.0f && row[4 * 100 + 2] == 0.0f && row[4 * 100 + 3] == 1.0f);
  /* 0.580812 is the published value at the line: on the way from red, at ½, to yellow, at ¾ */
  CHECK_NEAR((double)row[4 * 150 + 1], (0.580812 - 0.5) * 4.0, 1e-5);
  CHECK(row[4 * 150] == 1.0f && row[4 * 150 + 2] == 0.0f);
  conic_image_release(context, &map);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

/* NaN in one picture only is the worst there is; in both, nothing; what no screen shows counts as what it shows. */
static void test_odd_values(conic_context *context) {
  conic_image a = draw(context, 1, 1, grey), b = draw(context, 1, 1, grey);
  float *a_value = a.planes[CONIC_PLANE_RGBA], *b_value = b.planes[CONIC_PLANE_RGBA];
  b_value[1] = NAN;
  CHECK(compare(context, &a, &b).flip == 1.0);
  a_value[1] = NAN;
  CHECK(compare(context, &a, &b).flip == 0.0);
  for (int c = 0; c < 3; c++) {
    a_value[c] = c == 0 ? INFINITY : -3.0f;
    b_value[c] = c == 0 ? 1.0f : 0.0f;
  }
  CHECK(compare(context, &a, &b).flip == 0.0);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

static void test_threads(conic_context *context) {
  conic_context *alone = check_context(1);
  conic_image a = random_image(context, 700, 200, EVERY_PLANE), b = draw(context, 700, 200, texture);
  conic_difference one = compare(alone, &a, &b), many = compare(context, &a, &b);
  CHECK(one.flip == many.flip && one.flip > 0.0 && one.flip <= 1.0);
  CHECK(one.p999 == many.p999 && one.over_code == many.over_code);
  conic_context_destroy(alone);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

static int by_size(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

/* 99.9 % of the pixels differ by no more, and fewer would by less. */
static void test_percentile(conic_context *context, int width, int height) {
  unsigned planes = 1u << CONIC_PLANE_Z;
  uint64_t state = 3;
  conic_image a, b;
  size_t n = (size_t)width * (size_t)height;
  float *differences = malloc(n * sizeof *differences);
  CHECK_OK(conic_image_allocate(context, width, height, planes, &a));
  CHECK_OK(conic_image_allocate(context, width, height, planes, &b));
  for (size_t i = 0; differences && i < n; i++) {
    differences[i] = ldexpf((float)(next_random(&state) >> 8), (int)(next_random(&state) % 60) - 50);
    ((float *)b.planes[CONIC_PLANE_Z])[i] = next_random(&state) % 2 ? differences[i] : -differences[i];
  }
  conic_difference difference = compare(context, &a, &b);
  CHECK(differences != NULL);
  if (differences)
    qsort(differences, n, sizeof *differences, by_size);
  size_t rank = (999 * n + 999) / 1000;
  CHECK(differences && difference.p999 == (double)differences[rank - 1]);
  CHECK(difference.planes[CONIC_PLANE_Z].p999 == difference.p999);
  CHECK(differences && difference.max_abs == (double)differences[n - 1]);
  free(differences);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

static int one_more(int x, int y, int c) {
  return ramp(x, y, c) < 255 ? ramp(x, y, c) + 1 : 255;
}

static int two_more(int x, int y, int c) {
  return ramp(x, y, c) + (c == 1 && x < 3 && y < 5 ? 2 : 0);
}

/* A difference of one code is rounding, one of two is not. */
static void test_codes(conic_context *context) {
  conic_image a = draw(context, 300, 200, ramp), b = draw(context, 300, 200, one_more);
  conic_image c = draw(context, 300, 200, two_more);
  CHECK(compare(context, &a, &b).over_code == 0);
  CHECK(compare(context, &a, &b).differing_pixels > 50000);
  CHECK(compare(context, &a, &c).over_code == 15);
  ((float *)c.planes[CONIC_PLANE_RGBA])[4 * 50000] = NAN;
  CHECK(compare(context, &a, &c).over_code == 16);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
  conic_image_release(context, &c);
}

static void test_powers(void) {
  CHECK(conic_power(0.0, 0.3) == 0.0 && conic_power(1.0, 0.3) == 1.0);
  for (double v = 1e-30; v < 1e30; v *= 1.37) {
    CHECK_NEAR(conic_logarithm(v), log(v), 1e-15 * (1.0 + fabs(log(v))));
    CHECK_NEAR(conic_cube_root(v), cbrt(v), 1e-15 * cbrt(v));
    for (double exponent = 0.1; exponent < 3.0; exponent += 0.3)
      CHECK_NEAR(conic_power(v, exponent) / pow(v, exponent), 1.0, 2e-15 * (1.0 + fabs(exponent * log(v))));
  }
}

int main(void) {
  conic_context *context = check_context(3);
  test_published(context, 53, 37, texture, ramp, 0.954717561, 0.9547175564887274, 0x1.e8d0bd531d6d4p-1);
  test_published(context, 300, 200, ramp, moved_ramp, 0.266645359, 0.26664536289556323, 0x1.110b7b673102ep-2);
  test_published(context, 300, 200, ramp, dark_ramp, 0.331799068, 0.33179911270280343, 0x1.53c3253c07423p-2);
  test_published(context, 300, 200, grey, grey_with_line, 0.007282619, 0.007283034119938721, 0x1.dd4d097133c8bp-8);
  test_published(context, 1, 1, grey, ramp, 0.933896780, 0.9338891441105945, 0x1.de26b7cfed5ecp-1);
  test_published(context, 300, 1, ramp, dark_ramp, 0.320319701, 0.3203197803304505, 0x1.4801e7fe50ebfp-2);
  test_map(context);
  test_odd_values(context);
  test_threads(context);
  test_percentile(context, 100, 77);
  test_percentile(context, 3, 2);
  test_percentile(context, 1000, 1);
  test_codes(context);
  test_powers();
  conic_context_destroy(context);
  return check_result();
}
