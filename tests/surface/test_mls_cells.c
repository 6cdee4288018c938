/* Projecting cell by cell: the same surface as in one piece, and the same bits whatever memory there is. */
#include "core/base/team_runs.h"
#include "tests/support/surface_shapes.h"
#include "tests/support/thread_team.h"

typedef struct feed {
  const conic_splats *points;
  size_t batch;  /* points that are handed over at a time */
  size_t n_more; /* and from the second time on so many less */
  int n_times;
} feed;

static conic_status give(void *cookie, conic_batch_receiver *receive, void *to) {
  feed *from = cookie;
  size_t count = from->points->count - (from->n_times++ ? from->n_more : 0);
  for (size_t at = 0; at < count; at += from->batch) {
    conic_splats batch = *from->points;
    batch.count = count - at < from->batch ? count - at : from->batch;
    for (int axis = 0; axis < 3; axis++) {
      batch.position[axis] += at;
      batch.normal[axis] = batch.normal[axis] ? batch.normal[axis] + at : NULL;
      batch.color[axis] = batch.color[axis] ? batch.color[axis] + at : NULL;
    }
    conic_status status = receive(to, &batch);
    if (status != CONIC_OK)
      return status;
  }
  return CONIC_OK;
}

typedef struct kept {
  conic_context *context;
  conic_splats points; /* with room for all */
  size_t n;
} kept;

static conic_status begin(void *cookie, const conic_surface_report *report, unsigned fields) {
  kept *to = cookie;
  conic_splats_release(to->context, &to->points);
  to->n = 0;
  return conic_splats_allocate(to->context, report->n_out, fields, &to->points);
}

static conic_status keep(void *cookie, const conic_splats *batch) {
  kept *to = cookie;
  CHECK(to->n + batch->count <= to->points.count);
  for (int axis = 0; axis < 3; axis++) {
    memcpy(to->points.position[axis] + to->n, batch->position[axis], batch->count * sizeof(float));
    if (to->points.normal[axis])
      memcpy(to->points.normal[axis] + to->n, batch->normal[axis], batch->count * sizeof(float));
    if (to->points.color[axis])
      memcpy(to->points.color[axis] + to->n, batch->color[axis], batch->count * sizeof(float));
  }
  to->n += batch->count;
  return CONIC_OK;
}

static conic_status clean(conic_context *context, feed *from, const conic_clean_options *options, kept *to,
                          conic_surface_report *report) {
  const conic_points_sink sink = {begin, keep, to};
  to->context = context;
  from->n_times = 0;
  return conic_surface_clean_cells(context, options, give, from, &sink, report);
}

static int is_same(const conic_splats *a, const conic_splats *b) {
  int same = a->count == b->count && conic_splats_fields(a) == conic_splats_fields(b);
  for (int axis = 0; axis < 3 && same; axis++) {
    same = memcmp(a->position[axis], b->position[axis], a->count * sizeof(float)) == 0;
    same = same && (!a->normal[axis] || memcmp(a->normal[axis], b->normal[axis], a->count * sizeof(float)) == 0);
    same = same && (!a->color[axis] || memcmp(a->color[axis], b->color[axis], a->count * sizeof(float)) == 0);
  }
  return same;
}

static double farthest(float *const a[3], float *const b[3], size_t n) {
  double most = 0.0;
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++)
      most = fmax(most, fabs((double)a[axis][i] - (double)b[axis][i]));
  return most;
}

/* Moves a point half of h off the surface, to one side or the other, where that brings it to a border of cells, which
 * all go through the origin: then its foot and what is about that lie in another cell as far as they ever do. */
static void move_to_border(conic_splats *points, size_t i) {
  for (int side = -1; side <= 1; side += 2) {
    float moved[3];
    int is_there = 0;
    for (int axis = 0; axis < 3; axis++) {
      moved[axis] = points->position[axis][i] + 0.024f * (float)side * points->normal[axis][i];
      is_there |= fabsf(moved[axis]) < 0.002f;
    }
    for (int axis = 0; is_there && axis < 3; axis++)
      points->position[axis][i] = moved[axis];
    if (is_there)
      return;
  }
}

/* A sphere over eight cells, whose borders cut it aslant. With points that are none, twins, and one alone in a cell of
 * its own. */
static conic_splats make_points(conic_context *context) {
  conic_splats points = shape_sample(context, SHAPE_SPHERE, 20000, 0.1, 5);
  for (size_t i = 0; i < points.count; i++) {
    for (int axis = 0; axis < 3; axis++)
      points.position[axis][i] += 0.3f - 0.05f * (float)axis;
    move_to_border(&points, i);
  }
  points.position[1][3] = NAN;
  for (int axis = 0; axis < 3; axis++) {
    points.position[axis][7000] = points.position[axis][70];
    points.position[axis][9] = 40.0f;
  }
  return points;
}

static void test_whole(conic_context *context, const conic_splats *points, const conic_clean_options *options) {
  conic_surface_report report, expected;
  conic_splats whole;
  kept cells = {0};
  feed from = {.points = points, .batch = SIZE_MAX};
  conic_surface *surface = shape_surface(context, points, &options->surface);
  CHECK_OK(conic_surface_clean(surface, &whole, &expected));
  CHECK_OK(clean(context, &from, options, &cells, &report));
  CHECK(report.n_in == 20000 && report.n_out == expected.n_out && cells.n == report.n_out);
  CHECK(memcmp(report.outcomes, expected.outcomes, sizeof report.outcomes) == 0);
  CHECK(report.outcomes[CONIC_SURFACE_NOT_FINITE] == 1 && report.outcomes[CONIC_SURFACE_TOO_FEW] >= 1);
  CHECK_NEAR(report.moved_rms, expected.moved_rms, 1e-9);
  CHECK_NEAR(report.mean_neighbours, expected.mean_neighbours, 1e-9);
  double moved = farthest(cells.points.position, whole.position, whole.count);
  double turned = farthest(cells.points.normal, whole.normal, whole.count);
  printf("cells against one piece: places %.1e, normals %.1e apart\n", moved, turned);
  CHECK(moved < 2e-7 && turned < 1e-6); /* sums in another order, rounded to floats */
  conic_splats_release(context, &whole);
  conic_splats_release(context, &cells.points);
  conic_surface_destroy(surface);
}

static void test_memory(const conic_splats *points, conic_clean_options options) {
  conic_context *first = check_context(1), *second = check_context(3);
  kept all = {0}, some = {0};
  feed from = {.points = points, .batch = SIZE_MAX}, bits = {.points = points, .batch = 777};
  CHECK_OK(clean(first, &from, &options, &all, NULL));
  options.memory_bytes = (size_t)15 << 20;
  options.scratch = "test-cells";
  CHECK_OK(clean(second, &bits, &options, &some, NULL));
  CHECK(all.points.count > 19900 && is_same(&all.points, &some.points));
  options.surface.isa = CONIC_ISA_SCALAR;
  CHECK_OK(clean(second, &bits, &options, &some, NULL));
  CHECK(is_same(&all.points, &some.points));
  conic_splats_release(second, &some.points);
  /* What cannot be */
  options.memory_bytes = (size_t)13 << 20;
  CHECK(clean(second, &bits, &options, &some, NULL) == CONIC_ERROR_MEMORY);
  options.memory_bytes = (size_t)15 << 20;
  options.scratch = "no such folder/test-cells";
  CHECK(clean(second, &bits, &options, &some, NULL) == CONIC_ERROR_IO);
  bits.n_more = 5000;
  options.memory_bytes = 0;
  CHECK(clean(second, &bits, &options, &some, NULL) == CONIC_ERROR_INPUT);
  bits.n_more = 0;
  options.surface.h = 0.0;
  CHECK(clean(second, &bits, &options, &some, NULL) == CONIC_ERROR_ARGUMENT);
  options.surface.h = 1e-12;
  CHECK(clean(second, &bits, &options, &some, NULL) == CONIC_ERROR_ARGUMENT);
  conic_splats_release(first, &all.points);
  conic_context_destroy(first);
  conic_context_destroy(second);
}

/* Bare points stay bare. Spheres find normals for them, and come as near to the one that is meant. */
static void test_bare(conic_context *context, const conic_splats *points, conic_clean_options options) {
  kept cells = {0};
  conic_splats bare = *points;
  feed from = {.points = &bare, .batch = 5000};
  for (int axis = 0; axis < 3; axis++)
    bare.normal[axis] = bare.color[axis] = NULL;
  CHECK_OK(clean(context, &from, &options, &cells, NULL));
  CHECK(cells.points.count > 19900 && conic_splats_fields(&cells.points) == 0);
  conic_splats_release(context, &cells.points);
  double squares[2] = {0.0, 0.0};
  size_t counts[2];
  options.surface.type = CONIC_SURFACE_APSS;
  for (int is_bare = 0; is_bare < 2; is_bare++) {
    from.points = is_bare ? &bare : points;
    cells = (kept){0};
    CHECK_OK(clean(context, &from, &options, &cells, NULL));
    CHECK(!(is_bare && conic_splats_fields(&cells.points)));
    counts[is_bare] = cells.points.count;
    for (size_t i = 0; i < cells.points.count; i++) {
      double r2 = 0.0;
      for (int axis = 0; axis < 3; axis++) {
        double d = (double)cells.points.position[axis][i] - 0.3 + 0.05 * axis;
        r2 += d * d;
      }
      squares[is_bare] += (sqrt(r2) - 1.0) * (sqrt(r2) - 1.0) / (double)cells.points.count;
    }
    conic_splats_release(context, &cells.points);
  }
  printf("spheres by cells: %zu points, off by %.2g rms, with normals, %zu, %.2g without\n", counts[0],
         sqrt(squares[0]), counts[1], sqrt(squares[1]));
  CHECK(counts[1] >= counts[0] * 99 / 100 && squares[1] < 1.4 * 1.4 * squares[0]);
}

/* By a team, of which one may fail as it reads. */
typedef struct cells_team {
  const conic_splats *points;
  const conic_clean_options *options;
  const kept *alone;
  const conic_surface_report *expected;
  int failing;
  conic_status statuses[THREAD_TEAM_MOST];
} cells_team;

static void clean_in_team(const conic_team *team, void *cookie) {
  cells_team *c = cookie;
  conic_context *context = check_context(1 + team->index % 2);
  conic_surface_report report;
  kept own = {0};
  feed from = {.points = c->points, .batch = 3000, .n_more = team->index == c->failing ? 1 : 0};
  conic_context_join(context, team);
  conic_status status = clean(context, &from, c->options, &own, &report);
  c->statuses[team->index] = conic_context_part(context, status);
  if (status == CONIC_OK)
    CHECK(memcmp(&report, c->expected, sizeof report) == 0);
  CHECK(team->index == 0 && status == CONIC_OK ? is_same(&own.points, &c->alone->points) : own.n == 0);
  conic_splats_release(context, &own.points);
  conic_context_destroy(context);
}

static void test_team(conic_context *context, const conic_splats *points, conic_clean_options options) {
  static const int counts[] = {2, 3, 7};
  conic_surface_report expected;
  kept alone = {0};
  feed from = {.points = points, .batch = 3000};
  CHECK_OK(clean(context, &from, &options, &alone, &expected));
  options.memory_bytes = (size_t)15 << 20;
  options.scratch = "test-cells";
  for (int i = 0; i < 4; i++) {
    int count = counts[i % 3];
    cells_team c = {points, &options, &alone, &expected, .failing = i < 3 ? -1 : 1};
    thread_team_run(count, clean_in_team, &c);
    for (int k = 0; k < count; k++)
      CHECK(c.statuses[k] == (i < 3 ? CONIC_OK : k == 1 ? CONIC_ERROR_INPUT : CONIC_ERROR_CANCELLED));
  }
  conic_splats_release(context, &alone.points);
}

int main(void) {
  conic_context *context = check_context(2);
  conic_splats points = make_points(context);
  conic_clean_options options;
  conic_clean_options_init(&options);
  options.surface.h = 0.04;
  options.surface.degree = 2;
  test_whole(context, &points, &options);
  options.surface.type = CONIC_SURFACE_APSS;
  test_whole(context, &points, &options);
  options.surface.type = CONIC_SURFACE_MLS;
  options.surface.plane = CONIC_PLANE_FAST;
  test_memory(&points, options);
  test_team(context, &points, options);
  test_bare(context, &points, options);
  conic_splats_release(context, &points);
  conic_context_destroy(context);
  return check_result();
}
