/* Inputs on which a point-set surface has no answer, or the wrong one if it is not careful: what is said of each. */
#include "tests/support/surface_shapes.h"

static conic_surface_options options_of(conic_surface_type type, double h) {
  conic_surface_options options;
  conic_surface_options_init(&options);
  options.type = type;
  options.h = h;
  options.degree = 2;
  return options;
}

/* A sheet of 60 × 60 points, half a unit apart and shaken, put somewhere by `place`. */
enum { SIDE = 60, N_SHEET = SIDE * SIDE };

static void put_sheet(conic_splats *s, size_t first, uint64_t seed, const double u[3], const double v[3],
                      const double origin[3], const double normal[3]) {
  for (size_t i = 0; i < N_SHEET; i++) {
    double a = 0.5 * ((double)(i % SIDE) + 0.6 * random_unit(&seed));
    double b = 0.5 * ((double)(i / SIDE) + 0.6 * random_unit(&seed));
    for (int axis = 0; axis < 3; axis++) {
      s->position[axis][first + i] = (float)(origin[axis] + a * u[axis] + b * v[axis]);
      s->normal[axis][first + i] = (float)normal[axis];
    }
  }
}

static const double ZERO[3] = {0, 0, 0}, X[3] = {1, 0, 0}, Y[3] = {0, 1, 0}, Z[3] = {0, 0, 1};

static conic_surface_point project_one(conic_surface *surface, double x, double y, double z) {
  const double position[1][3] = {{x, y, z}};
  conic_surface_point point;
  CHECK_OK(conic_surface_project(surface, 1, position, &point));
  return point;
}

/* What failed is where it was, and says nothing else. */
static void check_failed(const conic_surface_point *point, conic_surface_outcome outcome) {
  if (point->outcome != outcome) {
    fprintf(stderr, "'%s' in place of '%s'\n", conic_surface_outcome_name(point->outcome),
            conic_surface_outcome_name(outcome));
    check_failures++;
  }
  CHECK(point->normal[0] == 0.0 && point->normal[1] == 0.0 && point->normal[2] == 0.0 && point->n_neighbours == 0);
}

static void check_not_finite(conic_context *context) {
  conic_splats s = shape_allocate(context, N_SHEET, CONIC_SPLATS_NORMALS);
  conic_splats out;
  conic_surface_report report;
  put_sheet(&s, 0, 1, X, Y, ZERO, Z);
  for (size_t i = 0; i < 100; i++)
    s.position[i % 3][i * 30] = i % 2 ? NAN : INFINITY;
  for (int type = CONIC_SURFACE_MLS; type <= CONIC_SURFACE_APSS; type++) {
    conic_surface_options options = options_of((conic_surface_type)type, 1.5);
    conic_surface *surface = shape_surface(context, &s, &options);
    CHECK_OK(conic_surface_clean(surface, &out, &report));
    CHECK(report.outcomes[CONIC_SURFACE_NOT_FINITE] == 100 && report.n_out == N_SHEET - 100);
    for (size_t i = 0; i < out.count; i++)
      CHECK_NEAR((double)out.position[2][i], 0.0, 1e-6);
    conic_surface_point point = project_one(surface, NAN, 1.0, 0.0);
    check_failed(&point, CONIC_SURFACE_NOT_FINITE);
    point = project_one(surface, 1.0, -INFINITY, 0.0);
    check_failed(&point, CONIC_SURFACE_NOT_FINITE);
    conic_splats_release(context, &out);
    conic_surface_destroy(surface);
  }
  for (size_t i = 0; i < N_SHEET; i++)
    s.position[0][i] = NAN;
  conic_surface *surface;
  CHECK(conic_surface_create(context, &s, NULL, &surface) == CONIC_ERROR_INPUT && !surface);
  conic_splats_release(context, &s);
}

/* Far points have a place, but no surface. */
static void check_isolated(conic_context *context) {
  conic_splats s = shape_allocate(context, N_SHEET + 3, CONIC_SPLATS_NORMALS);
  put_sheet(&s, 0, 1, X, Y, ZERO, Z);
  for (size_t i = 0; i < 3; i++)
    for (int axis = 0; axis < 3; axis++) {
      s.position[axis][N_SHEET + i] = 100.0f * (float)(i + 1);
      s.normal[axis][N_SHEET + i] = 1.0f;
    }
  for (int type = CONIC_SURFACE_MLS; type <= CONIC_SURFACE_APSS; type++) {
    conic_surface_options options = options_of((conic_surface_type)type, 1.5);
    conic_surface *surface = shape_surface(context, &s, &options);
    conic_surface_point point = project_one(surface, 100.0, 100.0, 100.0);
    check_failed(&point, CONIC_SURFACE_TOO_FEW);
    point = project_one(surface, 15.0, 15.0, 50.0);
    check_failed(&point, CONIC_SURFACE_TOO_FEW);
    conic_surface_destroy(surface);
  }
  conic_splats_release(context, &s);
}

/* A point given twenty times weighs as much as twenty; a set given twice is the same set. */
static void check_duplicates(conic_context *context) {
  conic_splats once = shape_allocate(context, N_SHEET, CONIC_SPLATS_NORMALS), twice, same;
  conic_splats out;
  conic_surface_report report;
  put_sheet(&once, 0, 1, X, Y, ZERO, Z);
  for (size_t i = 0; i < N_SHEET; i++)
    once.position[2][i] += 0.1f * (float)sin((double)once.position[0][i]);
  twice = shape_allocate(context, 2 * N_SHEET, CONIC_SPLATS_NORMALS);
  for (size_t i = 0; i < 2 * N_SHEET; i++)
    for (int axis = 0; axis < 3; axis++) {
      twice.position[axis][i] = once.position[axis][i / 2];
      twice.normal[axis][i] = once.normal[axis][i / 2];
    }
  conic_surface_options options = options_of(CONIC_SURFACE_MLS, 1.5);
  conic_surface *a = shape_surface(context, &once, &options), *b = shape_surface(context, &twice, &options);
  for (double x = 3.0; x < 25.0; x += 1.7) {
    conic_surface_point first = project_one(a, x, 12.0, 0.1), second = project_one(b, x, 12.0, 0.1);
    CHECK(first.outcome == CONIC_SURFACE_DONE && second.outcome == CONIC_SURFACE_DONE);
    CHECK(first.n_neighbours == second.n_neighbours);
    CHECK_NEAR(first.position[2], second.position[2], 1e-10);
  }
  CHECK_OK(conic_surface_clean(b, &out, &report));
  CHECK(report.n_out == 2 * N_SHEET);
  for (size_t i = 0; i + 1 < out.count; i += 2)
    CHECK(out.position[2][i] == out.position[2][i + 1]);
  conic_splats_release(context, &out);
  conic_surface_destroy(a);
  conic_surface_destroy(b);
  /* All in one place: no surface, and no end of time. */
  same = shape_allocate(context, 1000, CONIC_SPLATS_NORMALS);
  for (size_t i = 0; i < 1000; i++)
    for (int axis = 0; axis < 3; axis++)
      same.position[axis][i] = same.normal[axis][i] = 1.0f;
  for (int local = 0; local < 2; local++) {
    options.h = local ? 0.0 : 1.5;
    a = shape_surface(context, &same, &options);
    conic_surface_point point = project_one(a, 1.0, 1.0, 1.1);
    check_failed(&point, CONIC_SURFACE_TOO_FEW);
    conic_surface_destroy(a);
  }
  conic_splats_release(context, &once);
  conic_splats_release(context, &twice);
  conic_splats_release(context, &same);
}

/* Points on a line have many planes, and no polynomial across it. */
static void check_line(conic_context *context) {
  conic_splats s = shape_allocate(context, 300, CONIC_SPLATS_NORMALS);
  for (size_t i = 0; i < 300; i++) {
    s.position[0][i] = 0.1f * (float)i;
    s.position[1][i] = s.position[2][i] = s.normal[0][i] = s.normal[1][i] = 0.0f;
    s.normal[2][i] = 1.0f;
  }
  conic_surface_options options = options_of(CONIC_SURFACE_MLS, 1.0);
  for (int plane = CONIC_PLANE_FULL; plane <= CONIC_PLANE_FAST; plane++) {
    options.plane = (conic_surface_plane)plane;
    conic_surface *surface = shape_surface(context, &s, &options);
    conic_surface_point point = project_one(surface, 15.0, 0.0, 0.0);
    CHECK(point.outcome == CONIC_SURFACE_ILL_CONDITIONED || point.outcome == CONIC_SURFACE_NO_MINIMUM);
    conic_surface_destroy(surface);
  }
  conic_splats_release(context, &s);
}

typedef struct layers {
  size_t below, between, above, failed, merged;
} layers;

static layers sort_layers(conic_context *context, conic_surface_type type, double gap) {
  conic_splats s = shape_allocate(context, 2 * N_SHEET, CONIC_SPLATS_NORMALS), out;
  const double down[3] = {0, 0, -1}, up[3] = {0, 0, gap};
  conic_surface_report report;
  layers found = {0, 0, 0, 0, 0};
  put_sheet(&s, 0, 1, X, Y, ZERO, down);
  put_sheet(&s, N_SHEET, 2, X, Y, up, Z);
  conic_surface_options options = options_of(type, 1.0);
  conic_surface *surface = shape_surface(context, &s, &options);
  CHECK_OK(conic_surface_clean(surface, &out, &report));
  found.failed = report.n_in - report.n_out;
  found.merged = (size_t)report.n_merged;
  for (size_t i = 0; i < out.count; i++) {
    double height = (double)out.position[2][i] / gap;
    found.below += height < 0.1;
    found.above += height > 0.9;
    found.between += height >= 0.1 && height <= 0.9;
  }
  conic_splats_release(context, &out);
  conic_surface_destroy(surface);
  conic_splats_release(context, &s);
  return found;
}

/* Two sheets: nearer than h they are one, in the middle; from 1.6 h on they are two; in between MLS finds no plane and
 * says so, where normals still tell the sheets apart for APSS. */
static void check_sheets(conic_context *context) {
  for (double gap = 0.1; gap < 2.0; gap += 0.3)
    for (int type = CONIC_SURFACE_MLS; type <= CONIC_SURFACE_APSS; type++) {
      layers found = sort_layers(context, (conic_surface_type)type, gap);
      printf("sheets %.1f h apart, %s: %zu below, %zu between, %zu above, %zu failed\n", gap, type ? "apss" : "mls",
             found.below, found.between, found.above, found.failed);
      if (type == CONIC_SURFACE_MLS && gap < 0.5)
        CHECK(found.between == 2 * N_SHEET);
      if (type == CONIC_SURFACE_MLS && gap > 0.2 && gap < 0.5)
        CHECK(found.merged > 2 * N_SHEET * 9 / 10);
      if (type == CONIC_SURFACE_MLS && gap > 0.9)
        CHECK(found.between == 0 && found.merged == 0);
      if (gap > 1.5)
        CHECK(found.below == N_SHEET && found.above == N_SHEET);
    }
}

/* Beyond a sheet's edge there is nothing. */
static void check_edge(conic_context *context) {
  conic_splats s = shape_allocate(context, N_SHEET, CONIC_SPLATS_NORMALS);
  put_sheet(&s, 0, 1, X, Y, ZERO, Z);
  for (int type = CONIC_SURFACE_MLS; type <= CONIC_SURFACE_APSS; type++) {
    conic_surface_options options = options_of((conic_surface_type)type, 1.2);
    conic_surface *surface = shape_surface(context, &s, &options);
    CHECK(project_one(surface, 15.0, 0.1, 0.1).outcome == CONIC_SURFACE_DONE);
    for (double out = 1.0; out < 4.0; out += 0.25)
      CHECK(project_one(surface, 15.0, -out, 0.1).outcome != CONIC_SURFACE_DONE);
    conic_surface_destroy(surface);
  }
  conic_splats_release(context, &s);
}

/* A crease becomes round on the scale of h, and what is not near it stays. */
static void check_crease(conic_context *context) {
  conic_splats s = shape_allocate(context, 2 * N_SHEET, CONIC_SPLATS_NORMALS), out;
  const double below[3] = {0, 0, -1}, left[3] = {0, -1, 0};
  conic_surface_report report;
  put_sheet(&s, 0, 1, X, Y, ZERO, Z);
  put_sheet(&s, N_SHEET, 2, X, below, ZERO, left);
  for (int type = CONIC_SURFACE_MLS; type <= CONIC_SURFACE_APSS; type++) {
    conic_surface_options options = options_of((conic_surface_type)type, 1.2);
    conic_surface *surface = shape_surface(context, &s, &options);
    CHECK_OK(conic_surface_clean(surface, &out, &report));
    printf("crease, %s: %zu of %zu projected, moved by %.2f h at most\n", type ? "apss" : "mls", report.n_out,
           report.n_in, report.moved_max / 1.2);
    CHECK(report.n_out > report.n_in * 9 / 10);
    CHECK(report.moved_max < 0.3 * 1.2);
    for (size_t i = 0; i < out.count; i++) {
      double y = (double)out.position[1][i], depth = -(double)out.position[2][i];
      CHECK(y + depth > 0.0 && y > -0.1 && depth > -0.1);
      if (y > 3.0)
        CHECK_NEAR(depth, 0.0, 1e-5);
    }
    conic_splats_release(context, &out);
    conic_surface_destroy(surface);
  }
  conic_splats_release(context, &s);
}

static void check_refusals(conic_context *context) {
  conic_splats s = shape_allocate(context, N_SHEET, 0), dense;
  conic_surface *surface;
  conic_surface_options options = options_of(CONIC_SURFACE_APSS, 1.0);
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < N_SHEET; i++)
      s.position[axis][i] = (float)(i % 60) * (float)(axis + 1);
  CHECK(conic_surface_create(context, &s, &options, &surface) == CONIC_ERROR_ARGUMENT); /* no normals */
  options.type = CONIC_SURFACE_MLS;
  options.degree = 5;
  CHECK(conic_surface_create(context, &s, &options, &surface) == CONIC_ERROR_ARGUMENT);
  options.degree = 2;
  options.h = NAN;
  CHECK(conic_surface_create(context, &s, &options, &surface) == CONIC_ERROR_ARGUMENT);
  options.h = 1.0;
  options.isa = CONIC_ISA_NEON;
  if (conic_isa_best() != CONIC_ISA_NEON)
    CHECK(conic_surface_create(context, &s, &options, &surface) == CONIC_ERROR_UNSUPPORTED);
  options.isa = CONIC_ISA_AUTO;
  CHECK_OK(conic_surface_create(context, &s, &options, &surface));
  conic_thin_options thin;
  conic_densify_options densify;
  conic_thin_options_init(&thin);
  conic_densify_options_init(&densify);
  CHECK(conic_surface_thin(surface, &thin, &dense, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_surface_densify(surface, &densify, &dense, NULL) == CONIC_ERROR_ARGUMENT);
  conic_surface_destroy(surface);
  conic_splats_release(context, &s);
}

int main(void) {
  conic_context *context = check_context(2);
  check_not_finite(context);
  check_isolated(context);
  check_duplicates(context);
  check_line(context);
  check_sheets(context);
  check_edge(context);
  check_crease(context);
  check_refusals(context);
  conic_context_destroy(context);
  return check_result();
}
