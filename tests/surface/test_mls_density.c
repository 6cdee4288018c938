/* Thinning and densifying: fewer points or more of them, and the same surface. */
#include "core/estimate/neighbours.h"
#include "tests/support/sanitized.h"
#include "tests/support/surface_shapes.h"

enum { N_SAMPLES = IS_SANITIZED ? 3000 : 6000 };

static double greatest_distance(shape s, const conic_splats *splats) {
  double greatest = 0.0;
  for (size_t i = 0; i < splats->count; i++) {
    const double p[3] = {(double)splats->position[0][i], (double)splats->position[1][i],
                         (double)splats->position[2][i]};
    double normal[3], distance = fabs(shape_distance(s, p, normal));
    greatest = distance > greatest ? distance : greatest;
  }
  return greatest;
}

/* Every point of `part` is one of `whole`, in the same order. */
static int is_subset(const conic_splats *part, const conic_splats *whole) {
  size_t j = 0;
  for (size_t i = 0; i < part->count; i++, j++) {
    while (j < whole->count &&
           !(part->position[0][i] == whole->position[0][j] && part->position[1][i] == whole->position[1][j] &&
             part->position[2][i] == whole->position[2][j]))
      j++;
    if (j == whole->count)
      return 0;
  }
  return 1;
}

static double hausdorff(conic_surface *a, const conic_splats *b_points, const conic_surface_options *options,
                        conic_context *context) {
  conic_surface_distance there, back;
  conic_surface *b = shape_surface(context, b_points, options);
  CHECK_OK(conic_surface_deviation(a, b, &there));
  CHECK_OK(conic_surface_deviation(b, a, &back));
  CHECK(there.n_failed <= there.n_measured / 100 && back.n_failed <= back.n_measured / 100);
  conic_surface_destroy(b);
  return there.max > back.max ? there.max : back.max;
}

static void check_thin_count(conic_context *context) {
  conic_splats samples = shape_sample(context, SHAPE_TORUS, N_SAMPLES, 0.0, 4), thinned, again, random;
  conic_surface_options options;
  conic_thin_options wanted;
  conic_surface_report report;
  conic_surface_options_init(&options);
  conic_thin_options_init(&wanted);
  wanted.count = N_SAMPLES / 4;
  conic_surface *surface = shape_surface(context, &samples, &options);
  CHECK_OK(conic_surface_thin(surface, &wanted, &thinned, &report));
  CHECK(thinned.count == wanted.count && report.n_out == wanted.count && report.n_in == N_SAMPLES);
  CHECK(is_subset(&thinned, &samples));
  double error = hausdorff(surface, &thinned, &options, context);
  /* The same number chosen at random, as a yardstick. */
  random = shape_sample(context, SHAPE_TORUS, N_SAMPLES, 0.0, 4);
  CHECK_OK(conic_splats_thin(context, &random, N_SAMPLES / 4, 1));
  double random_error = hausdorff(surface, &random, &options, context);
  printf("to a quarter: Hausdorff distance %.2g, chosen at random %.2g; %zu measures\n", error, random_error,
         report.n_evaluations);
  CHECK(error < 0.5 * random_error);
  conic_context *one = check_context(1);
  conic_surface *same = shape_surface(one, &samples, &options);
  CHECK_OK(conic_surface_thin(same, &wanted, &again, NULL));
  for (int axis = 0; axis < 3; axis++)
    CHECK(again.count == thinned.count &&
          memcmp(again.position[axis], thinned.position[axis], thinned.count * sizeof(float)) == 0);
  conic_splats_release(one, &again);
  conic_surface_destroy(same);
  conic_context_destroy(one);
  conic_surface_destroy(surface);
  conic_splats_release(context, &samples);
  conic_splats_release(context, &thinned);
  conic_splats_release(context, &random);
}

static void check_thin_error(conic_context *context) {
  conic_splats samples = shape_sample(context, SHAPE_TORUS, N_SAMPLES, 0.0, 4), thinned;
  conic_surface_options options;
  conic_thin_options wanted;
  conic_surface_report report;
  conic_surface_options_init(&options);
  conic_thin_options_init(&wanted);
  size_t before = N_SAMPLES;
  conic_surface *surface = shape_surface(context, &samples, &options);
  for (wanted.max_error = IS_SANITIZED ? 3e-3 : 3e-4; wanted.max_error < 4e-3; wanted.max_error *= 10.0) {
    CHECK_OK(conic_surface_thin(surface, &wanted, &thinned, &report));
    double error = hausdorff(surface, &thinned, &options, context);
    printf("within %.0e: %zu left, Hausdorff distance %.2g\n", wanted.max_error, thinned.count, error);
    CHECK(error <= wanted.max_error);
    CHECK(error == report.there.max || error == report.back.max);
    CHECK(thinned.count < before);
    before = thinned.count;
    conic_splats_release(context, &thinned);
  }
  CHECK(before < 2000);
  conic_surface_destroy(surface);
  conic_splats_release(context, &samples);
}

/* Duplicates go, and a set that is small enough stays. */
static void check_thin_little(conic_context *context) {
  conic_splats samples = shape_sample(context, SHAPE_SPHERE, 1000, 0.0, 4), thinned;
  conic_thin_options wanted;
  conic_thin_options_init(&wanted);
  wanted.count = 5000;
  for (int axis = 0; axis < 3; axis++)
    samples.position[axis][999] = samples.position[axis][0];
  samples.position[0][500] = NAN;
  conic_surface *surface = shape_surface(context, &samples, NULL);
  CHECK_OK(conic_surface_thin(surface, &wanted, &thinned, NULL));
  CHECK(thinned.count == 998);
  conic_splats_release(context, &thinned);
  conic_surface_destroy(surface);
  conic_splats_release(context, &samples);
}

/* The farthest that a place on the torus is from the nearest point. */
static double widest_gap(conic_context *context, const conic_splats *splats) {
  conic_splats places = shape_sample(context, SHAPE_TORUS, 10000, 0.0, 77);
  conic_neighbours tree;
  double widest = 0.0;
  CHECK_OK(conic_neighbours_build(context, (const float *const *)splats->position, splats->count, &tree));
  for (size_t i = 0; i < places.count; i++) {
    const double query[3] = {(double)places.position[0][i], (double)places.position[1][i],
                             (double)places.position[2][i]};
    uint32_t slot;
    double distance2;
    conic_neighbours_nearest(&tree, query, CONIC_NO_SLOT, 1, HUGE_VAL, &slot, &distance2);
    widest = distance2 > widest ? distance2 : widest;
  }
  conic_neighbours_release(context, &tree);
  conic_splats_release(context, &places);
  return sqrt(widest);
}

/* The first point that goes is the one that contributes least, and by so much it is missed. */
static void check_contributions(conic_context *context) {
  conic_splats samples = shape_sample(context, SHAPE_TORUS, 3000, 0.2, 5), thinned;
  conic_thin_options options;
  conic_surface_report report;
  float values[3000];
  conic_surface *surface = shape_surface(context, &samples, NULL);
  size_t least = 0;
  CHECK_OK(conic_surface_contributions(surface, values));
  for (size_t i = 1; i < samples.count; i++)
    least = values[i] < values[least] ? i : least;
  conic_thin_options_init(&options);
  options.count = samples.count - 1;
  CHECK_OK(conic_surface_thin(surface, &options, &thinned, &report));
  CHECK(thinned.count == samples.count - 1);
  CHECK_NEAR(report.error, (double)values[least], 1e-7 * report.error);
  for (size_t i = 0; i < thinned.count; i++)
    CHECK(thinned.position[0][i] == samples.position[0][i + (i >= least)]);
  conic_splats_release(context, &thinned);
  conic_surface_destroy(surface);
  conic_splats_release(context, &samples);
}

static void check_densify(conic_context *context) {
  conic_splats samples = shape_sample(context, SHAPE_TORUS, 800, 0.0, 6), dense, again;
  conic_surface_options options;
  conic_densify_options wanted;
  conic_surface_report report;
  conic_surface_options_init(&options);
  conic_densify_options_init(&wanted);
  wanted.spacing = 0.03;
  conic_surface *surface = shape_surface(context, &samples, &options);
  CHECK_OK(conic_surface_densify(surface, &wanted, &dense, &report));
  printf("800 points to %zu: the widest gap from %.3f to %.3f; off the torus by %.2g, projected ones by %.2g\n",
         dense.count, widest_gap(context, &samples), widest_gap(context, &dense),
         greatest_distance(SHAPE_TORUS, &samples), greatest_distance(SHAPE_TORUS, &dense));
  CHECK(report.n_in == 800 && report.n_out == dense.count);
  for (int axis = 0; axis < 3; axis++)
    CHECK(memcmp(dense.position[axis], samples.position[axis], 800 * sizeof(float)) == 0);
  CHECK(widest_gap(context, &dense) <= 1.05 * wanted.spacing);
  CHECK((double)dense.count < 9.87 / (0.866 * 0.03 * 0.03)); /* no closer to each other than that, packed tightly */
  CHECK(greatest_distance(SHAPE_TORUS, &dense) < 0.02);
  conic_context *one = check_context(1);
  conic_surface *same = shape_surface(one, &samples, &options);
  CHECK_OK(conic_surface_densify(same, &wanted, &again, NULL));
  for (int axis = 0; axis < 3; axis++)
    CHECK(again.count == dense.count &&
          memcmp(again.position[axis], dense.position[axis], dense.count * sizeof(float)) == 0);
  conic_splats_release(one, &again);
  wanted.max_count = 1000;
  CHECK_OK(conic_surface_densify(same, &wanted, &again, &report));
  CHECK(again.count == 1000 && report.error > wanted.spacing);
  conic_splats_release(one, &again);
  conic_surface_destroy(same);
  conic_context_destroy(one);
  conic_surface_destroy(surface);
  conic_splats_release(context, &samples);
  conic_splats_release(context, &dense);
}

/* A square sheet with a round hole: neither its border nor the hole, which is wider than h, is grown over. */
static void check_borders(conic_context *context) {
  enum { SIDE = 50 };
  conic_splats sheet = shape_allocate(context, (size_t)SIDE * SIDE, CONIC_SPLATS_NORMALS), dense;
  conic_surface_options options;
  conic_densify_options wanted;
  uint64_t state = 8;
  size_t n = 0;
  for (int i = 0; i < SIDE * SIDE; i++) {
    double x = i % SIDE + 0.7 * random_unit(&state) - 25.0, y = i / SIDE + 0.7 * random_unit(&state) - 25.0;
    if (x * x + y * y < 36.0)
      continue;
    sheet.position[0][n] = (float)x;
    sheet.position[1][n] = (float)y;
    sheet.position[2][n] = sheet.normal[0][n] = sheet.normal[1][n] = 0.0f;
    sheet.normal[2][n++] = 1.0f;
  }
  sheet.count = n;
  conic_surface_options_init(&options);
  conic_densify_options_init(&wanted);
  options.h = 2.0;
  options.degree = 2;
  wanted.spacing = 0.4;
  conic_surface *surface = shape_surface(context, &sheet, &options);
  CHECK_OK(conic_surface_densify(surface, &wanted, &dense, NULL));
  CHECK(dense.count > 2 * n);
  for (size_t i = n; i < dense.count; i++) {
    double x = (double)dense.position[0][i], y = (double)dense.position[1][i];
    CHECK(x > -25.0 && x < 24.7 && y > -25.0 && y < 24.7);
    CHECK(x * x + y * y > 5.3 * 5.3);
    CHECK_NEAR((double)dense.position[2][i], 0.0, 1e-6);
  }
  printf("a sheet with a hole: %zu points to %zu\n", n, dense.count);
  conic_splats_release(context, &dense);
  conic_surface_destroy(surface);
  conic_splats_release(context, &sheet);
}

/* Triangles of a mesh say where the surface is: a square of four corners, of which nothing can be projected, is filled
 * to its border, with the corners' colours between them. */
static void check_mesh(conic_context *context) {
  static const uint32_t triangles[2][3] = {{0, 1, 2}, {2, 1, 3}};
  conic_splats corners = shape_allocate(context, 4, CONIC_SPLATS_NORMALS | CONIC_SPLATS_COLORS), dense;
  conic_densify_options wanted;
  conic_surface_report report;
  conic_neighbours tree;
  for (int i = 0; i < 4; i++)
    for (int axis = 0; axis < 3; axis++) {
      corners.position[axis][i] = axis < 2 ? (float)(i >> axis & 1) : 0.0f;
      corners.normal[axis][i] = axis == 2 ? 1.0f : 0.0f;
      corners.color[axis][i] = (float)(i & 1);
    }
  conic_densify_options_init(&wanted);
  wanted.spacing = 0.05;
  conic_surface *surface = shape_surface(context, &corners, NULL);
  wanted.triangles = triangles;
  wanted.n_triangles = 2;
  CHECK_OK(conic_surface_densify(surface, &wanted, &dense, &report));
  CHECK(report.n_flat == dense.count - 4 && dense.count < 600);
  CHECK_OK(conic_neighbours_build(context, (const float *const *)dense.position, dense.count, &tree));
  for (int i = 0; i < 10000; i++) {
    const double place[3] = {(i % 100 + 0.5) / 100.0, (i / 100 + 0.5) / 100.0, 0.0};
    uint32_t slot;
    double distance2;
    conic_neighbours_nearest(&tree, place, CONIC_NO_SLOT, 1, HUGE_VAL, &slot, &distance2);
    CHECK(sqrt(distance2) <= 1.05 * wanted.spacing);
  }
  for (size_t i = 4; i < dense.count; i++) {
    CHECK(dense.position[2][i] == 0.0f && dense.normal[2][i] == 1.0f);
    CHECK_NEAR((double)dense.color[0][i], (double)dense.position[0][i], 1e-6);
  }
  conic_neighbours_release(context, &tree);
  conic_splats_release(context, &dense);
  const uint32_t wrong[1][3] = {{0, 1, 4}};
  wanted.triangles = wrong;
  wanted.n_triangles = 1;
  CHECK(conic_surface_densify(surface, &wanted, &dense, NULL) == CONIC_ERROR_ARGUMENT);
  conic_surface_destroy(surface);
  conic_splats_release(context, &corners);
}

int main(void) {
  conic_context *context = check_context(2);
  check_thin_count(context);
  check_thin_error(context);
  check_thin_little(context);
  check_contributions(context);
  check_densify(context);
  check_borders(context);
  check_mesh(context);
  conic_context_destroy(context);
  return check_result();
}
