/* Outlines of a mesh's vertices cover its faces, as seen straight on each. */
#include "tests/support/outlines.h"

static void add_triangle(conic_context *context, conic_model *model, size_t a, size_t b, size_t c) {
  static uint32_t triangles[20000][3];
  (void)context;
  model->triangles = triangles;
  triangles[model->n_triangles][0] = (uint32_t)a;
  triangles[model->n_triangles][1] = (uint32_t)b;
  triangles[model->n_triangles++][2] = (uint32_t)c;
}

/* Samples of a triangle that no outline of its own vertices or of those around covers, as seen along its normal. */
static size_t count_uncovered(const conic_model *model, size_t i_triangle, size_t *n_samples, size_t *n_outlines) {
  enum { STEPS = 12 };
  double corners[3][3], edges[2][3], normal[3], longest = 0.0;
  size_t n_uncovered = 0;
  for (int i = 0; i < 3; i++)
    for (int axis = 0; axis < 3; axis++)
      corners[i][axis] = (double)model->points.position[axis][model->triangles[i_triangle][i]];
  for (int axis = 0; axis < 3; axis++) {
    edges[0][axis] = corners[1][axis] - corners[0][axis];
    edges[1][axis] = corners[2][axis] - corners[0][axis];
    longest = fmax(longest, fmax(fabs(edges[0][axis]), fabs(edges[1][axis])));
  }
  for (int axis = 0; axis < 3; axis++)
    normal[axis] =
        edges[0][(axis + 1) % 3] * edges[1][(axis + 2) % 3] - edges[0][(axis + 2) % 3] * edges[1][(axis + 1) % 3];
  double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] /= length;
  for (int i = 0; i <= STEPS; i++)
    for (int j = 0; i + j <= STEPS; j++) {
      double p[3];
      int n = 0;
      for (int axis = 0; axis < 3; axis++)
        p[axis] = corners[0][axis] + edges[0][axis] * i / STEPS + edges[1][axis] * j / STEPS;
      for (int k = 0; k < 3; k++) {
        outlines_splat s = outlines_get(&model->points, model->triangles[i_triangle][k]);
        n += outlines_cover(&s, p, normal, 2.0 * longest);
      }
      n_uncovered += n == 0;
      *n_outlines += (size_t)n;
      ++*n_samples;
    }
  return n_uncovered;
}

static void check_covered(const char *name, const conic_model *model) {
  size_t n_uncovered = 0, n_samples = 0, n_outlines = 0;
  for (size_t i = 0; i < model->n_triangles; i++)
    n_uncovered += count_uncovered(model, i, &n_samples, &n_outlines);
  fprintf(stderr, "%s: %zu of %zu samples uncovered by their triangle's vertices, %.2f of 3 outlines on each\n", name,
          n_uncovered, n_samples, (double)n_outlines / (double)n_samples);
  CHECK(n_uncovered == 0);
}

static void release(conic_context *context, conic_model *model) {
  model->triangles = NULL; /* not the library's */
  conic_model_release(context, model);
}

/* A grid with hills, cells `stretch` times as long as wide. */
static void check_bumpy_grid(conic_context *context, double stretch) {
  enum { SIDE = 30 };
  conic_model model = outlines_model(context, SIDE * SIDE, 0);
  for (int i = 0; i < SIDE * SIDE; i++) {
    double x = i % SIDE, y = i / SIDE;
    outlines_add(&model, stretch * x, y, 1.5 * sin(0.5 * x) * cos(0.4 * y));
  }
  for (size_t y = 0; y + 1 < SIDE; y++)
    for (size_t x = 0; x + 1 < SIDE; x++) {
      size_t i = y * SIDE + x;
      add_triangle(context, &model, i, i + 1, i + SIDE);
      add_triangle(context, &model, i + 1, i + SIDE + 1, i + SIDE);
    }
  conic_repairs repairs = outlines_estimate(context, &model);
  CHECK(repairs.nan + repairs.zero + repairs.duplicate + repairs.isolated + repairs.failed == 0);
  check_covered("bumpy grid", &model);
  for (size_t i = 0; i < model.points.count; i++) {
    outlines_splat s = outlines_get(&model.points, i);
    CHECK(s.normal[2] > 0.0 && s.a < 3.5 * stretch);
  }
  release(context, &model);
}

/* Twelve vertices, twenty faces: as coarse as a sphere gets. */
static void check_icosahedron(conic_context *context) {
  static const double golden = 1.618033988749895;
  static const size_t faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  static const double at[12][3] = {{-1, 1, 0},  {1, 1, 0},  {-1, -1, 0}, {1, -1, 0}, {0, -1, 1},  {0, 1, 1},
                                   {0, -1, -1}, {0, 1, -1}, {1, 0, -1},  {1, 0, 1},  {-1, 0, -1}, {-1, 0, 1}};
  conic_model model = outlines_model(context, 12, 0);
  for (int i = 0; i < 12; i++)
    outlines_add(&model, at[i][0] * (i >= 8 ? golden : 1.0), at[i][1] * (i < 4 ? golden : 1.0),
                 at[i][2] * (i >= 4 && i < 8 ? golden : 1.0));
  for (int i = 0; i < 20; i++)
    add_triangle(context, &model, faces[i][0], faces[i][1], faces[i][2]);
  outlines_estimate(context, &model);
  check_covered("icosahedron", &model);
  for (size_t i = 0; i < 12; i++) {
    outlines_splat s = outlines_get(&model.points, i);
    double out = s.normal[0] * s.center[0] + s.normal[1] * s.center[1] + s.normal[2] * s.center[2];
    CHECK_NEAR(out, sqrt(1.0 + golden * golden), 1e-5);
  }
  release(context, &model);
}

/* A long cone: the tip's own outline must stay within the cone, and the ring's outlines cover the sides. */
static void check_horn(conic_context *context) {
  enum { N_SIDES = 16 };
  conic_model model = outlines_model(context, N_SIDES + 1, 0);
  size_t tip = outlines_add(&model, 0, 0, 10);
  for (int i = 0; i < N_SIDES; i++)
    outlines_add(&model, cos(0.39269908169872414 * i), sin(0.39269908169872414 * i), 0);
  for (size_t i = 0; i < N_SIDES; i++)
    add_triangle(context, &model, tip, 1 + i, 1 + (i + 1) % N_SIDES);
  outlines_estimate(context, &model);
  check_covered("horn", &model);
  CHECK(outlines_get(&model.points, tip).a < 1.2);
  release(context, &model);
}

/* Slivers, degenerate faces, a vertex that is nowhere, and one of no face. */
static void check_bad_faces(conic_context *context) {
  conic_model model = outlines_model(context, 110, 0);
  for (int i = 0; i < 100; i++)
    outlines_add(&model, i % 10, i / 10, 0.0);
  for (size_t y = 0; y < 9; y++)
    for (size_t x = 0; x < 9; x++) {
      add_triangle(context, &model, y * 10 + x, y * 10 + x + 1, y * 10 + x + 10);
      add_triangle(context, &model, y * 10 + x + 1, y * 10 + x + 11, y * 10 + x + 10);
    }
  size_t nowhere = outlines_add(&model, NAN, 0, 0), faceless = outlines_add(&model, 4.5, 4.5, 0.0);
  size_t far = outlines_add(&model, 0, 0, 500);
  add_triangle(context, &model, 0, 0, 99);        /* a line */
  add_triangle(context, &model, 0, 55, 99);       /* another */
  add_triangle(context, &model, 33, 34, nowhere); /* to nowhere */
  conic_repairs repairs = outlines_estimate(context, &model);
  CHECK(repairs.nan == 1 && repairs.isolated == 1 && repairs.failed == 0);
  CHECK(isnan(model.points.tangent_u[0][nowhere]) && isnan(model.points.tangent_v[2][nowhere]));
  for (size_t i = 0; i < 100; i++)
    CHECK(outlines_get(&model.points, i).a < 2.0);
  CHECK(outlines_get(&model.points, faceless).b > 0.0 && outlines_get(&model.points, faceless).a < 2.5);
  CHECK(outlines_get(&model.points, far).b > 0.0 && outlines_get(&model.points, far).a < 1.0);

  model.triangles[0][1] = 5000;
  conic_estimate_options options;
  conic_estimate_options_init(&options);
  CHECK(conic_model_to_splats(context, &options, &model, NULL) == CONIC_ERROR_ARGUMENT);
  release(context, &model);
}

static void check_file(conic_context *context, const char *source_folder, const char *name) {
  const char *path = check_data(source_folder, name);
  conic_read_options options;
  conic_model model;
  size_t n_uncovered = 0, n_samples = 0, n_outlines = 0;
  if (!path)
    return;
  conic_read_options_init(&options);
  CHECK_OK(conic_model_read(context, path, &options, &model));
  conic_repairs repairs = outlines_estimate(context, &model);
  for (size_t i = 0; i < model.n_triangles; i += 7)
    n_uncovered += count_uncovered(&model, i, &n_samples, &n_outlines);
  fprintf(stderr, "%s: %zu of %zu samples uncovered, %.2f of 3 outlines on each; %zu failed\n", name, n_uncovered,
          n_samples, (double)n_outlines / (double)n_samples, repairs.failed);
  CHECK((double)n_uncovered < 0.002 * (double)n_samples);
  conic_model_release(context, &model);
}

int main(int argc, char **argv) {
  conic_context *context = check_context(2);
  const char *files[] = {"bunny.obj", "cow.obj", "fandisk.obj", "spot.obj", "igea.ply", "nefertiti.obj"};
  check_bumpy_grid(context, 1.0);
  check_bumpy_grid(context, 3.0);
  check_icosahedron(context);
  check_horn(context);
  check_bad_faces(context);
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
    check_file(context, argc > 1 ? argv[1] : ".", files[i]);
  conic_context_destroy(context);
  return check_result();
}
