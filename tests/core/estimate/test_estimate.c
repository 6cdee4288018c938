/* Outlines of raw points: they cover what was sampled, whatever the pattern, and nothing that was not. */
#include "core/estimate/neighbours.h"
#include "tests/support/outlines.h"

static const double along_z[3] = {0.0, 0.0, 1.0};

typedef struct coverage {
  double uncovered;    /* share of the samples */
  double mean_overlap; /* outlines on a sample */
} coverage;

/* Samples the rectangle in z = `height` evenly. */
static coverage cover_rectangle(const conic_splats *splats, size_t begin, size_t end, double x0, double y0, double x1,
                                double y1, double height) {
  enum { SIDE = 91 };
  size_t n_uncovered = 0, sum = 0;
  for (int i = 0; i < SIDE; i++)
    for (int j = 0; j < SIDE; j++) {
      const double p[3] = {x0 + (x1 - x0) * (i + 0.5) / SIDE, y0 + (y1 - y0) * (j + 0.5) / SIDE, height};
      int n = outlines_count(splats, begin, end, p, along_z, 0.2);
      n_uncovered += n == 0;
      sum += (size_t)n;
    }
  coverage c = {(double)n_uncovered / (SIDE * SIDE), (double)sum / (SIDE * SIDE)};
  return c;
}

static void check_covered(const char *name, const conic_splats *splats, size_t begin, size_t end, double x0, double y0,
                          double x1, double y1, double height, double greatest_overlap) {
  coverage c = cover_rectangle(splats, begin, end, x0, y0, x1, y1, height);
  fprintf(stderr, "%s: %.4f %% uncovered, %.2f outlines on each other\n", name, 100.0 * c.uncovered, c.mean_overlap);
  CHECK(c.uncovered == 0.0);
  CHECK(c.mean_overlap <= greatest_overlap);
}

static void check_grid(conic_context *context) {
  conic_model model = outlines_model(context, 1600, 0);
  for (int i = 0; i < 1600; i++)
    outlines_add(&model, i % 40, i / 40, 0.0);
  conic_repairs repairs = outlines_estimate(context, &model);
  CHECK(repairs.nan + repairs.zero + repairs.duplicate + repairs.isolated + repairs.failed == 0);
  check_covered("grid", &model.points, 0, 1600, 0, 0, 39, 39, 0.0, 8.0);
  outlines_splat s = outlines_get(&model.points, 20 * 40 + 20);
  CHECK(s.b > 0.9 && s.a < 1.6 && fabs(s.normal[2]) > 1.0 - 1e-12);
  /* Nor does the edge grow far beyond the last row. */
  coverage outside = cover_rectangle(&model.points, 0, 1600, 41.5, 0, 44, 39, 0.0);
  CHECK(outside.mean_overlap == 0.0);
  conic_model_release(context, &model);
}

static void check_random(conic_context *context, double jitter, double greatest_uncovered) {
  conic_model model = outlines_model(context, 1600, 0);
  uint64_t state = 11;
  for (int i = 0; i < 1600; i++) {
    double x = jitter * (random_unit(&state) - 0.5), y = jitter * (random_unit(&state) - 0.5);
    outlines_add(&model, i % 40 + x, i / 40 + y, 0.0);
  }
  outlines_estimate(context, &model);
  coverage c = cover_rectangle(&model.points, 0, 1600, 1, 1, 38, 38, 0.0);
  fprintf(stderr, "random, moved by up to %g: %.4f %% uncovered, %.2f outlines on each other\n", 0.5 * jitter,
          100.0 * c.uncovered, c.mean_overlap);
  CHECK(c.uncovered <= greatest_uncovered);
  CHECK(c.mean_overlap <= 9.0);
  conic_model_release(context, &model);
}

/* Lines four apart, samples one apart and shifted from line to line. */
static void check_scan_lines(conic_context *context) {
  conic_model model = outlines_model(context, 1600, 0);
  uint64_t state = 12;
  for (int line = 0; line < 20; line++) {
    double shift = random_unit(&state);
    for (int i = 0; i < 80; i++)
      outlines_add(&model, i + shift, 4.0 * line, 0.0);
  }
  outlines_estimate(context, &model);
  check_covered("scan lines", &model.points, 0, 1600, 2, 0, 77, 76, 0.0, 9.0);
  outlines_splat s = outlines_get(&model.points, 10 * 80 + 40);
  CHECK(s.a / s.b > 2.0); /* long across the lines, so that it need not be wide along them */
  CHECK(fabs(s.u[1]) > 0.9 * s.a / 1.5);
  conic_model_release(context, &model);
}

/* Spacing 1 on the left, 2 on the right. */
static void check_density_step(conic_context *context) {
  conic_model model = outlines_model(context, 2000, 0);
  for (int i = 0; i < 20 * 40; i++)
    outlines_add(&model, i % 20, i / 20, 0.0);
  for (int i = 0; i < 10 * 20; i++)
    outlines_add(&model, 21 + 2 * (i % 10), 2 * (i / 10), 0.0);
  outlines_estimate(context, &model);
  check_covered("density step", &model.points, 0, model.points.count, 0, 0, 39, 38, 0.0, 9.0);
  conic_model_release(context, &model);
}

/* Gaps: a slit of three spacings closes, a hole of nine stays. */
static void check_gaps(conic_context *context) {
  conic_model model = outlines_model(context, 1600, 0);
  for (int i = 0; i < 1600; i++) {
    int x = i % 40, y = i / 40, is_slit = (x == 8 || x == 9), is_hole = x > 20 && x < 29 && y > 15 && y < 24;
    if (!is_slit && !is_hole)
      outlines_add(&model, x, y, 0.0);
  }
  outlines_estimate(context, &model);
  check_covered("slit", &model.points, 0, model.points.count, 7, 1, 10, 38, 0.0, 8.0);
  coverage hole = cover_rectangle(&model.points, 0, model.points.count, 22.5, 17.5, 26.5, 21.5, 0.0);
  CHECK(hole.uncovered == 1.0);
  conic_model_release(context, &model);
}

static void check_outliers(conic_context *context) {
  conic_model model = outlines_model(context, 1700, 0);
  for (int i = 0; i < 1600; i++)
    outlines_add(&model, i % 40, i / 40, 0.0);
  size_t lone = outlines_add(&model, 20, 20, 30), pair = outlines_add(&model, 5, 5, -20);
  outlines_add(&model, 5, 5.5, -20);
  size_t few = outlines_add(&model, 100, 100, 0);
  outlines_add(&model, 102, 100, 0);
  outlines_add(&model, 100, 103, 1);
  conic_repairs repairs = outlines_estimate(context, &model);
  CHECK(repairs.isolated >= 1 && repairs.isolated <= 6);
  for (size_t i = lone; i < model.points.count; i++) {
    outlines_splat s = outlines_get(&model.points, i);
    CHECK(s.b > 0.0 && s.a < (i < few ? 1.0 : 2.5) * 3.0);
  }
  CHECK(outlines_get(&model.points, lone).a < 1.0);
  CHECK(outlines_get(&model.points, pair).a < 3.0);
  check_covered("with outliers", &model.points, 0, 1600, 1, 1, 38, 38, 0.0, 8.0);
  conic_model_release(context, &model);
}

/* Two sheets half a spacing apart, facing away from each other: each must be covered by its own splats, no larger than
 * alone. */
static void check_sheets(conic_context *context) {
  conic_model model = outlines_model(context, 3200, CONIC_SPLATS_NORMALS);
  uint64_t state = 13;
  for (int i = 0; i < 3200; i++) {
    int is_upper = i >= 1600, at = i % 1600;
    double x = 0.8 * (random_unit(&state) - 0.5), y = 0.8 * (random_unit(&state) - 0.5);
    size_t added = outlines_add(&model, at % 40 + x, at / 40 + y, is_upper ? 0.5 : 0.0);
    model.points.normal[0][added] = model.points.normal[1][added] = 0.0f;
    model.points.normal[2][added] = is_upper ? 3.0f : -0.1f;
  }
  outlines_estimate(context, &model);
  check_covered("lower sheet", &model.points, 0, 1600, 1, 1, 38, 38, 0.0, 9.0);
  check_covered("upper sheet", &model.points, 1600, 3200, 1, 1, 38, 38, 0.5, 9.0);
  for (size_t i = 0; i < 3200; i++)
    CHECK(outlines_get(&model.points, i).normal[2] * (i >= 1600 ? 1.0 : -1.0) > 0.999);
  conic_model_release(context, &model);
}

/* The share of the middles between neighbours, on every 20th point, that no outline near by covers, as seen along the
 * point's normal. Neighbours are the 12 nearest where the normals are within 60°. */
static double uncovered_middles(conic_context *context, const conic_splats *splats) {
  enum { NEAREST = 12, AROUND = 40 };
  const float *const positions[3] = {splats->position[0], splats->position[1], splats->position[2]};
  uint32_t slots[NEAREST], around[AROUND];
  double distances2[AROUND];
  size_t n_middles = 0, n_uncovered = 0;
  conic_neighbours tree;
  CHECK_OK(conic_neighbours_build(context, positions, splats->count, &tree));
  for (uint32_t slot = 0; slot < tree.n_slots; slot += 20) {
    outlines_splat s = outlines_get(splats, tree.point_of_slot[slot]);
    size_t n = conic_neighbours_nearest(&tree, s.center, slot, NEAREST, HUGE_VAL, slots, distances2);
    for (size_t i = 0; i < n; i++) {
      outlines_splat other = outlines_get(splats, tree.point_of_slot[slots[i]]);
      double middle[3], cosine = 0.0;
      for (int axis = 0; axis < 3; axis++) {
        middle[axis] = 0.5 * (s.center[axis] + other.center[axis]);
        cosine += s.normal[axis] * other.normal[axis];
      }
      if (cosine < 0.5)
        continue;
      size_t n_around = conic_neighbours_nearest(&tree, middle, CONIC_NO_SLOT, AROUND, HUGE_VAL, around, distances2);
      int is_covered = 0;
      for (size_t j = 0; j < n_around && !is_covered; j++) {
        outlines_splat candidate = outlines_get(splats, tree.point_of_slot[around[j]]);
        is_covered = outlines_cover(&candidate, middle, s.normal, 2.0 * s.a);
      }
      n_middles++;
      n_uncovered += !is_covered;
    }
  }
  conic_neighbours_release(context, &tree);
  return (double)n_uncovered / (double)n_middles;
}

/* On real data: figures to read, and bounds that only a mistake would pass. */
static void check_lion(conic_context *context, const char *source_folder) {
  const char *path = check_data(source_folder, "lion.ply");
  conic_read_options options;
  conic_model model;
  if (!path)
    return;
  conic_read_options_init(&options);
  CHECK_OK(conic_model_read(context, path, &options, &model));
  conic_repairs repairs = outlines_estimate(context, &model);
  double sum = 0.0, greatest = 0.0;
  size_t n = model.points.count, n_bad = 0;
  for (size_t i = 0; i < n; i++) {
    outlines_splat s = outlines_get(&model.points, i);
    n_bad += !(s.b > 0.0 && s.a < HUGE_VAL);
    sum += s.a;
    greatest = fmax(greatest, s.a);
  }
  fprintf(stderr, "lion: mean outline %.5f, greatest %.5f; %zu isolated, %zu duplicate, %zu failed\n", sum / (double)n,
          greatest, repairs.isolated, repairs.duplicate, repairs.failed);
  double uncovered = uncovered_middles(context, &model.points);
  fprintf(stderr, "lion: %.4f %% of the middles between neighbours uncovered\n", 100.0 * uncovered);
  CHECK(uncovered < 0.001);
  CHECK(n_bad == 0 && repairs.failed == 0);
  CHECK(greatest < 20.0 * sum / (double)n);
  CHECK((double)repairs.isolated < 0.01 * (double)n);
  conic_model_release(context, &model);
}

int main(int argc, char **argv) {
  conic_context *context = check_context(2);
  check_grid(context);
  check_random(context, 0.5, 0.0);
  check_random(context, 1.0, 0.0);
  check_random(context, 40.0, 0.01);
  check_scan_lines(context);
  check_density_step(context);
  check_gaps(context);
  check_outliers(context);
  check_sheets(context);
  check_lion(context, argc > 1 ? argv[1] : ".");
  conic_context_destroy(context);
  return check_result();
}
