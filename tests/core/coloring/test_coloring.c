/* Colours made of values: the ramps, the range that they take, and what is coloured. */
#include "core/base/color.h"
#include "core/coloring/color_ramp.h"
#include "core/coloring/value_limits.h"
#include "tests/support/check.h"

static conic_context *context;

/* OKLab's lightness. */
static double lightness(const float c[3]) {
  double r = (double)c[0], g = (double)c[1], b = (double)c[2];
  return 0.2104542553 * cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b) +
         0.7936177850 * cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b) -
         0.0040720468 * cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
}

/* All but the diverging one and the rainbow grow lighter evenly: no step is more than twice the mean one. */
static void test_ramps(void) {
  enum { STEPS = 64 };
  for (int ramp = 0; ramp < CONIC_RAMP_CLASSES; ramp++) {
    float first[3], last[3], color[3];
    double before = 0.0;
    conic_ramp_color((conic_ramp)ramp, 0.0, first);
    conic_ramp_color((conic_ramp)ramp, 1.0, last);
    for (int i = 0; i <= STEPS; i++) {
      conic_ramp_color((conic_ramp)ramp, (double)i / STEPS, color);
      for (int channel = 0; channel < 3; channel++)
        CHECK(color[channel] >= 0.0f && color[channel] <= 1.0f);
      double step = lightness(color) - before, mean = (lightness(last) - lightness(first)) / STEPS;
      if (i && ramp != CONIC_RAMP_DIVERGING && ramp != CONIC_RAMP_TURBO)
        CHECK(step > 0.3 * mean && step < 2.0 * mean);
      before = lightness(color);
    }
    conic_ramp_color((conic_ramp)ramp, 7.0, color);
    CHECK(memcmp(color, last, sizeof color) == 0);
    conic_ramp_color((conic_ramp)ramp, -7.0, color);
    CHECK(memcmp(color, first, sizeof color) == 0);
    CHECK(conic_ramp_name(ramp) != NULL);
  }
  float grey[3];
  conic_ramp_color(CONIC_RAMP_GREY, 0.5, grey); /* of lightness 0.64 */
  for (int channel = 0; channel < 3; channel++)
    CHECK_NEAR((double)grey[channel], 0.64 * 0.64 * 0.64, 1e-6);
  CHECK(!conic_ramp_name(-1) && conic_ramp_name(CONIC_RAMP_CLASSES) && !conic_ramp_name(CONIC_N_RAMPS));
}

static void test_classes(void) {
  float ground[3], water[3], high[3], other[3];
  conic_class_color(2, ground);
  conic_class_color(9, water);
  conic_class_color(5, high);
  CHECK(ground[0] > ground[1] && ground[1] > ground[2]);
  CHECK(water[2] > water[1] && water[1] > water[0]);
  CHECK(high[1] > 2.0f * high[0] && high[1] > 2.0f * high[2]);
  CHECK(strcmp(conic_class_name(6), "building") == 0 && !conic_class_name(23));
  conic_class_color(31, ground);
  conic_class_color(23, other);
  CHECK(memcmp(ground, other, sizeof other) == 0);
  conic_class_color(32, other);
  CHECK(memcmp(ground, other, sizeof other) != 0);
}

static void test_limits(void) {
  static conic_value_sample sample;
  double low, high;
  conic_value_sample_limits(&sample, &low, &high);
  CHECK(low == 0.0 && high == 0.0);
  for (int i = 0; i <= 100; i++)
    conic_value_sample_add(&sample, (double)((i * 37) % 101));
  conic_value_sample_add(&sample, NAN);
  conic_value_sample_add(&sample, HUGE_VAL);
  conic_value_sample_limits(&sample, &low, &high);
  CHECK(low == 2.0 && high == 98.0);

  memset(&sample, 0, sizeof sample); /* nearly all the same: the few others are the limits */
  for (int i = 0; i < 1000; i++)
    conic_value_sample_add(&sample, i == 7 ? -3.0 : i == 9 ? 5.0 : 1.0);
  conic_value_sample_limits(&sample, &low, &high);
  CHECK(low == -3.0 && high == 5.0);

  memset(&sample, 0, sizeof sample); /* more than it keeps */
  for (int i = 0; i < 1000000; i++)
    conic_value_sample_add(&sample, (double)i);
  CHECK(sample.n <= CONIC_MOST_VALUES && sample.n > CONIC_MOST_VALUES / 4);
  conic_value_sample_limits(&sample, &low, &high);
  CHECK_NEAR(low, 20000.0, 20.0);
  CHECK_NEAR(high, 980000.0, 20.0);
}

enum { N = 11 };

/* A row of points along z whose scalar is their number; the last one has none. */
static conic_splats row(unsigned fields) {
  conic_splats splats;
  CHECK_OK(conic_splats_allocate(context, N, fields, &splats));
  splats.origin[2] = 100.0;
  for (size_t i = 0; i < N; i++) {
    splats.position[0][i] = splats.position[1][i] = 0.0f;
    splats.position[2][i] = (float)i;
    if (splats.scalar)
      splats.scalar[i] = i + 1 == N ? NAN : (float)i;
    for (int axis = 0; axis < 3; axis++) {
      if (splats.tangent_u[0]) {
        splats.tangent_u[axis][i] = axis == 0 ? 2.0f : 0.0f;
        splats.tangent_v[axis][i] = axis == 1 ? -2.0f : 0.0f;
      }
      if (splats.color[0])
        splats.color[axis][i] = 0.25f;
    }
  }
  return splats;
}

static void check_color(const conic_splats *splats, size_t i, conic_ramp ramp, double t) {
  float expected[3];
  conic_ramp_color(ramp, t, expected);
  for (int channel = 0; channel < 3; channel++)
    CHECK(splats->color[0] && splats->color[channel][i] == expected[channel]);
}

static conic_coloring_options by(const char *what) {
  conic_coloring_options options;
  conic_coloring_options_init(&options);
  CHECK(strcmp(options.by, "rgb") == 0);
  options.by = what;
  return options;
}

static void test_values(void) {
  conic_coloring coloring;
  conic_splats splats = row(CONIC_SPLATS_SCALARS);
  conic_coloring_options options = by("temperature");
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  CHECK(!splats.scalar && strcmp(coloring.field, "temperature") == 0 && strcmp(coloring.ramp, "sequential") == 0);
  CHECK(coloring.minimum == 0.0 && coloring.maximum == 9.0 && !coloring.is_root);
  check_color(&splats, 0, CONIC_RAMP_SEQUENTIAL, 0.0);
  check_color(&splats, 3, CONIC_RAMP_SEQUENTIAL, 3.0 / 9.0);
  CHECK(splats.color[0] && splats.color[0][N - 1] == 0.2f && splats.color[2][N - 1] == 0.2f);
  conic_splats_release(context, &splats);

  splats = row(CONIC_SPLATS_SCALARS | CONIC_SPLATS_COLORS); /* colours give way to what is asked for */
  options = by("Intensity");
  options.has_range = 1;
  options.minimum = 1.0;
  options.maximum = 5.0;
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  CHECK(coloring.is_root && strcmp(coloring.ramp, "grey") == 0);
  check_color(&splats, 2, CONIC_RAMP_GREY, 0.5);
  check_color(&splats, 0, CONIC_RAMP_GREY, 0.0);
  check_color(&splats, 8, CONIC_RAMP_GREY, 1.0);
  conic_splats_release(context, &splats);

  splats = row(CONIC_SPLATS_SCALARS);
  options = by("classification");
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  CHECK(strcmp(coloring.ramp, "classes") == 0 && coloring.classes[0] == 0x3ffu && coloring.maximum == 9.0);
  float water[3];
  conic_class_color(9, water);
  CHECK(splats.color[0] && splats.color[2][9] == water[2]);
  conic_splats_release(context, &splats);
}

static void test_heights_and_normals(void) {
  conic_coloring coloring;
  conic_splats splats = row(CONIC_SPLATS_TANGENTS);
  conic_coloring_options options = by("height");
  options.up[2] = -3.0;
  options.ramp = "heat";
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  CHECK(coloring.minimum == -110.0 && coloring.maximum == -100.0 && strcmp(coloring.ramp, "heat") == 0);
  check_color(&splats, 10, CONIC_RAMP_HEAT, 0.0);
  check_color(&splats, 0, CONIC_RAMP_HEAT, 1.0);

  options = by("normal"); /* which is −z; where up is z, all are turned */
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  float half = (float)conic_srgb_decode(0.5);
  CHECK(!coloring.ramp && splats.color[0][4] == half && splats.color[1][4] == half && splats.color[2][4] == 0.0f);
  options.up[2] = 1.0;
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  CHECK(splats.color[0][4] == half && splats.color[2][4] == 1.0f);
  conic_splats_release(context, &splats);

  splats = row(0);
  CHECK(conic_drawing_color(context, &options, &splats, NULL, &coloring) == CONIC_ERROR_ARGUMENT);
  conic_splats_release(context, &splats);
}

/* What is not asked for: colours that there are, else the intensity, else the height. */
static void test_auto(void) {
  conic_coloring coloring;
  conic_coloring_options options = by("auto");
  conic_splats splats = row(CONIC_SPLATS_SCALARS | CONIC_SPLATS_COLORS);
  options.up[2] = 1.0;
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  CHECK(!coloring.field[0] && splats.color[0][3] == 0.25f && !splats.scalar);
  conic_splats_release(context, &splats);

  splats = row(CONIC_SPLATS_SCALARS);
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  CHECK(strcmp(coloring.field, "intensity") == 0 && coloring.is_root && splats.color[0]);
  conic_splats_release(context, &splats);

  splats = row(CONIC_SPLATS_SCALARS);
  for (int i = 0; i < N; i++)
    splats.scalar[i] = 7.0f;
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  CHECK(strcmp(coloring.field, "height") == 0 && strcmp(coloring.ramp, "terrain") == 0 && coloring.minimum == 100.0);
  conic_splats_release(context, &splats);

  splats = row(CONIC_SPLATS_SCALARS);
  for (int i = 0; i < N; i++)
    splats.scalar[i] = splats.position[2][i] = 7.0f;
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  CHECK(!coloring.field[0] && !splats.color[0] && !splats.scalar);
  conic_splats_release(context, &splats);

  splats = row(0);
  CHECK_OK(conic_drawing_color(context, &options, &splats, NULL, &coloring));
  CHECK(!coloring.field[0] && !splats.color[0]);
  conic_splats_release(context, &splats);
}

/* Splats and triangles share one scale; materials turn white. */
static void test_triangles(void) {
  conic_coloring coloring;
  conic_coloring_options options = by("height");
  conic_splats splats = row(0);
  conic_triangles triangles;
  CHECK_OK(conic_triangles_allocate(context, 1, 3, CONIC_TRIANGLES_SCALARS, &triangles));
  for (uint32_t i = 0; i < 3; i++) {
    triangles.corners[0][i] = i;
    triangles.position[0][i] = i == 1 ? 1.0f : 0.0f;
    triangles.position[1][i] = i == 2 ? 1.0f : 0.0f;
    triangles.position[2][i] = 90.0f;
    triangles.scalar[i] = (float)i;
  }
  triangles.materials = calloc(1, sizeof *triangles.materials);
  triangles.n_materials = 1;
  options.up[2] = 1.0;
  CHECK_OK(conic_drawing_color(context, &options, &splats, &triangles, &coloring));
  CHECK(coloring.minimum == 90.0 && coloring.maximum == 110.0 && !triangles.scalar);
  check_color(&splats, 0, CONIC_RAMP_TERRAIN, 0.5);
  float low[3];
  conic_ramp_color(CONIC_RAMP_TERRAIN, 0.0, low);
  CHECK(triangles.color[0] && triangles.color[1][2] == low[1] && triangles.materials[0].color[2] == 1.0f);

  options = by("normal");
  conic_splats_release(context, &splats);
  CHECK_OK(conic_drawing_color(context, &options, NULL, &triangles, &coloring));
  CHECK(triangles.color[2][1] == 1.0f && triangles.color[0][1] == (float)conic_srgb_decode(0.5));
  CHECK(!triangles.normal[0]);
  free(triangles.materials);
  triangles.materials = NULL;
  triangles.n_materials = 0;
  conic_triangles_release(context, &triangles);
}

static void test_refused(void) {
  conic_coloring coloring;
  conic_splats splats = row(0);
  conic_coloring_options options = by("");
  CHECK(conic_drawing_color(context, &options, &splats, NULL, &coloring) == CONIC_ERROR_ARGUMENT);
  options = by("temperature");
  CHECK(conic_drawing_color(context, &options, &splats, NULL, &coloring) == CONIC_ERROR_INPUT);
  options.ramp = "none";
  CHECK(conic_drawing_color(context, &options, &splats, NULL, &coloring) == CONIC_ERROR_ARGUMENT);
  options = by("height");
  options.has_range = 1;
  CHECK(conic_drawing_color(context, &options, &splats, NULL, &coloring) == CONIC_ERROR_ARGUMENT);
  CHECK(!splats.color[0]);
  conic_splats_release(context, &splats);
}

/* Scalars go with their splats. */
static void test_sets(void) {
  conic_splats splats = row(CONIC_SPLATS_SCALARS), bare = row(0);
  CHECK(conic_splats_fields(&splats) == CONIC_SPLATS_SCALARS);
  CHECK_OK(conic_splats_append(context, &splats, &bare));
  CHECK(splats.count == 2 * N && splats.scalar[5] == 5.0f && isnan(splats.scalar[N + 5]));
  CHECK_OK(conic_splats_thin(context, &splats, 15, 3));
  for (size_t i = 0; i < 10 && splats.scalar; i++)
    CHECK(isnan(splats.scalar[i]) || splats.scalar[i] == splats.position[2][i]);
  conic_splats_release(context, &splats);
  conic_splats_release(context, &bare);
}

int main(void) {
  context = check_context(1);
  test_ramps();
  test_classes();
  test_limits();
  test_values();
  test_heights_and_normals();
  test_auto();
  test_triangles();
  test_refused();
  test_sets();
  conic_context_destroy(context);
  return check_result();
}
