/* The projection: it meets its definition, a second time it stays, and nothing changes its bits. */
#include "core/base/eigen.h"
#include "core/estimate/neighbours.h"
#include "tests/support/sanitized.h"
#include "tests/support/surface_shapes.h"

/* --- the definition, by plain sums over all samples --- */

typedef struct reference {
  const conic_splats *samples;
  double h, neglect;
} reference;

static double weight_of(const reference *r, const double q[3], size_t i, double offset[3]) {
  double d2 = 0.0, c2 = r->neglect * r->neglect;
  for (int axis = 0; axis < 3; axis++) {
    offset[axis] = (double)r->samples->position[axis][i] - q[axis];
    d2 += offset[axis] * offset[axis];
  }
  double s = d2 / (r->h * r->h);
  return s < c2 ? exp(-s) - exp(-c2) * (1.0 + c2 - s) : 0.0;
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double energy_at(const reference *r, const double q[3], const double n[3]) {
  double sum = 0.0, offset[3];
  for (size_t i = 0; i < r->samples->count; i++) {
    double w = weight_of(r, q, i, offset), height = dot(n, offset);
    sum += w * height * height;
  }
  return sum;
}

static void axes_across(const double n[3], double u[3], double v[3]) {
  const double helper[3] = {fabs(n[0]) < 0.6, fabs(n[0]) >= 0.6, 0.0};
  double along = dot(helper, n), length;
  for (int axis = 0; axis < 3; axis++)
    u[axis] = helper[axis] - along * n[axis];
  length = sqrt(dot(u, u));
  for (int axis = 0; axis < 3; axis++)
    u[axis] /= length;
  for (int axis = 0; axis < 3; axis++)
    v[axis] = n[(axis + 1) % 3] * u[(axis + 2) % 3] - n[(axis + 2) % 3] * u[(axis + 1) % 3];
}

/* At q, n has the least energy of all planes through q; along n, q has less than what is around. */
static void check_foot(const reference *r, const conic_surface_point *point) {
  double u[3], v[3], least = energy_at(r, point->foot, point->plane_normal), d = 1e-3;
  axes_across(point->plane_normal, u, v);
  for (int k = 0; k < 8; k++) {
    double a = d * cos(0.785398 * k), b = d * sin(0.785398 * k), n[3];
    for (int axis = 0; axis < 3; axis++)
      n[axis] = (point->plane_normal[axis] + a * u[axis] + b * v[axis]) / sqrt(1.0 + d * d);
    CHECK(energy_at(r, point->foot, n) > least);
  }
  for (int side = -1; side <= 1; side += 2) {
    double q[3];
    for (int axis = 0; axis < 3; axis++)
      q[axis] = point->foot[axis] + side * d * r->h * point->plane_normal[axis];
    CHECK(energy_at(r, q, point->plane_normal) > least);
  }
}

/* The quadratic over the plane by normal equations, in plain elimination. */
static double quadratic_at(const reference *r, const double q[3], const double n[3]) {
  double m[6][7] = {{0}}, u[3], v[3], offset[3];
  axes_across(n, u, v);
  for (size_t i = 0; i < r->samples->count; i++) {
    double w = weight_of(r, q, i, offset), x = dot(u, offset) / r->h, y = dot(v, offset) / r->h;
    const double row[7] = {1.0, x, y, x * x, x * y, y * y, dot(n, offset)};
    for (int j = 0; j < 6; j++)
      for (int k = 0; k < 7; k++)
        m[j][k] += w * row[j] * row[k];
  }
  for (int j = 5; j > 0; j--) /* from the last, so that the first is left alone */
    for (int i = 0; i < j; i++) {
      double share = m[i][j] / m[j][j];
      for (int k = 0; k < 7; k++)
        m[i][k] -= share * m[j][k];
    }
  return m[0][6] / m[0][0];
}

static void check_definition(conic_context *context) {
  conic_surface_options options;
  conic_splats samples = shape_sample(context, SHAPE_TORUS, 3000, 0.2, 3);
  reference r = {&samples, 3.0 * shape_spacing(SHAPE_TORUS, 3000), 2.0};
  conic_surface_options_init(&options);
  options.h = r.h = (double)(float)r.h;
  options.degree = 2;
  conic_surface *surface = shape_surface(context, &samples, &options);
  conic_surface_point *points;
  size_t n = shape_project(surface, &samples, 60, &points), n_done = 0;
  for (size_t i = 0; i < n; i++) {
    double n_side[3];
    if (points[i].outcome != CONIC_SURFACE_DONE)
      continue;
    n_done++;
    check_foot(&r, &points[i]);
    double value = quadratic_at(&r, points[i].foot, points[i].plane_normal), off = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      n_side[axis] = points[i].position[axis] - points[i].foot[axis];
      double expected = value * points[i].plane_normal[axis];
      off += fabs(n_side[axis] - expected);
    }
    CHECK_NEAR(off, 0.0, 1e-9 * r.h);
  }
  CHECK(n_done > n - n / 20);
  free(points);
  conic_surface_destroy(surface);
  conic_splats_release(context, &samples);
}

/* --- projecting twice --- */

static void check_again(conic_surface *surface, const conic_surface_point *points, size_t n, const char *what) {
  double(*positions)[3] = malloc(n * sizeof *positions), worst = 0.0;
  conic_surface_point *again = malloc(n * sizeof *again);
  size_t n_done = 0, n_lost = 0;
  for (size_t i = 0; i < n; i++)
    memcpy(positions[i], points[i].position, sizeof positions[i]);
  CHECK_OK(conic_surface_project(surface, n, (const double(*)[3])positions, again));
  for (size_t i = 0; i < n; i++) {
    double apart2 = 0.0;
    if (points[i].outcome != CONIC_SURFACE_DONE)
      continue;
    n_done++;
    n_lost += again[i].outcome != CONIC_SURFACE_DONE;
    for (int axis = 0; axis < 3; axis++)
      apart2 += (again[i].position[axis] - positions[i][axis]) * (again[i].position[axis] - positions[i][axis]);
    worst = sqrt(apart2) / points[i].h > worst ? sqrt(apart2) / points[i].h : worst;
  }
  printf("%s: %zu of %zu projected; a second time they move by %.2g h at most\n", what, n_done, n, worst);
  CHECK(n_lost == 0);
  CHECK(worst <= 1e-6);
  CHECK(n_done > n / 2);
  free(positions);
  free(again);
}

static void check_projection(conic_context *context, const conic_splats *samples, double h, const char *what) {
  conic_surface_options options;
  conic_surface_options_init(&options);
  options.h = h;
  for (int type = CONIC_SURFACE_MLS; type <= CONIC_SURFACE_APSS; type++)
    for (int weight = CONIC_WEIGHT_GAUSS; weight <= CONIC_WEIGHT_COMPACT; weight++) {
      conic_surface_point *points;
      options.type = (conic_surface_type)type;
      options.weight = (conic_surface_weight)weight;
      options.degree = 2 + weight;
      conic_surface *surface = shape_surface(context, samples, &options);
      size_t n = shape_project(surface, samples, 1 + samples->count / 20000, &points);
      check_again(surface, points, n, what);
      free(points);
      conic_surface_destroy(surface);
    }
}

/* --- bits --- */

static uint64_t hash_of(const void *bytes, size_t n, uint64_t hash) {
  const unsigned char *b = bytes;
  for (size_t i = 0; i < n; i++)
    hash = (hash ^ b[i]) * UINT64_C(1099511628211);
  return hash;
}

static uint64_t clean_hash(const conic_splats *samples, const conic_surface_options *options, int threads) {
  conic_context *context = check_context(threads);
  conic_surface *surface = shape_surface(context, samples, options);
  conic_splats projected;
  conic_surface_report report;
  CHECK_OK(conic_surface_clean(surface, &projected, &report));
  uint64_t hash = hash_of(&report, sizeof report, UINT64_C(14695981039346656037));
  for (int axis = 0; axis < 3; axis++) {
    hash = hash_of(projected.position[axis], projected.count * sizeof(float), hash);
    hash = hash_of(projected.normal[axis], projected.count * sizeof(float), hash);
    hash = hash_of(projected.color[axis], projected.count * sizeof(float), hash);
  }
  conic_splats_release(context, &projected);
  conic_surface_destroy(surface);
  conic_context_destroy(context);
  return hash;
}

static void check_bits(const conic_splats *samples) {
  conic_surface_options options;
  conic_surface_options_init(&options);
  for (int variant = 0; variant < 4; variant++) {
    options.type = variant == 2 ? CONIC_SURFACE_APSS : CONIC_SURFACE_MLS;
    options.plane = variant == 1 ? CONIC_PLANE_FAST : CONIC_PLANE_FULL;
    options.cluster = variant == 3 ? 0.2 : 0.0;
    options.isa = CONIC_ISA_SCALAR;
    uint64_t plain = clean_hash(samples, &options, 1);
    for (int threads = 1; threads <= 5; threads += 2)
      for (int isa = CONIC_ISA_AUTO; isa < CONIC_N_ISAS; isa++) {
        options.isa = (conic_isa)isa;
        if (isa <= (int)conic_isa_best())
          CHECK(clean_hash(samples, &options, threads) == plain);
      }
  }
}

/* Own points and points that a caller brings go the same way, but for the float that a set holds. */
static void check_own_points(conic_context *context, const conic_splats *samples) {
  conic_surface_options options;
  conic_splats projected;
  conic_surface_point *points;
  conic_surface_options_init(&options);
  conic_surface *surface = shape_surface(context, samples, &options);
  size_t n = shape_project(surface, samples, 1, &points), n_kept = 0;
  CHECK_OK(conic_surface_clean(surface, &projected, NULL));
  for (size_t i = 0; i < n && n_kept < projected.count; i++) {
    if (points[i].outcome != CONIC_SURFACE_DONE)
      continue;
    for (int axis = 0; axis < 3; axis++) {
      CHECK(projected.position[axis][n_kept] == (float)points[i].position[axis]);
      CHECK(projected.normal[axis][n_kept] == (float)points[i].normal[axis]);
      CHECK(projected.color[axis][n_kept] == (float)points[i].color[axis]);
    }
    n_kept++;
  }
  CHECK(n_kept == projected.count && n_kept > n - n / 20);
  free(points);
  conic_splats_release(context, &projected);
  conic_surface_destroy(surface);
}

/* Map coordinates lose nothing: what is done is done from the set's origin. */
static void check_far(conic_context *context, const conic_splats *samples) {
  conic_splats far = *samples, near_out, far_out;
  conic_surface_options options;
  conic_surface_options_init(&options);
  far.origin[0] = 4.5e6;
  far.origin[1] = -1e7;
  conic_surface *a = shape_surface(context, samples, &options), *b = shape_surface(context, &far, &options);
  CHECK_OK(conic_surface_clean(a, &near_out, NULL));
  CHECK_OK(conic_surface_clean(b, &far_out, NULL));
  CHECK(far_out.count == near_out.count && far_out.origin[1] == -1e7);
  for (int axis = 0; axis < 3; axis++)
    CHECK(memcmp(near_out.position[axis], far_out.position[axis], near_out.count * sizeof(float)) == 0);
  conic_splats_release(context, &near_out);
  conic_splats_release(context, &far_out);
  conic_surface_destroy(a);
  conic_surface_destroy(b);
}

/* --- a scan with noise --- */

static double median_nearest(conic_context *context, const conic_splats *samples) {
  conic_neighbours tree;
  double distances[1001];
  CHECK_OK(conic_neighbours_build(context, (const float *const *)samples->position, samples->count, &tree));
  for (size_t i = 0; i < 1001; i++) {
    size_t slot = i * tree.n_slots / 1001, j = i;
    const double query[3] = {(double)tree.position[0][slot], (double)tree.position[1][slot],
                             (double)tree.position[2][slot]};
    uint32_t nearest;
    double distance2;
    conic_neighbours_nearest(&tree, query, (uint32_t)slot, 1, HUGE_VAL, &nearest, &distance2);
    for (; j > 0 && distances[j - 1] > distance2; j--)
      distances[j] = distances[j - 1];
    distances[j] = distance2;
  }
  conic_neighbours_release(context, &tree);
  return sqrt(distances[500]);
}

/* The RMS of the offset along the clean normals, in spacings. */
static double offset_of(conic_context *context, const conic_splats *noisy, const conic_splats *clean, double spacing,
                        const conic_surface_options *options) {
  enum { STEP = 4 };
  conic_surface *surface = shape_surface(context, noisy, options);
  conic_surface_point *points;
  size_t n = shape_project(surface, noisy, STEP, &points), n_done = 0;
  double sum2 = 0.0;
  for (size_t k = 0; k < n; k++) {
    const size_t i = k * STEP;
    double normal[3], offset = 0.0, length2 = 0.0;
    if (points[k].outcome != CONIC_SURFACE_DONE)
      continue;
    for (int axis = 0; axis < 3; axis++) {
      int next = (axis + 1) % 3, last = (axis + 2) % 3;
      normal[axis] = (double)clean->tangent_u[next][i] * (double)clean->tangent_v[last][i] -
                     (double)clean->tangent_u[last][i] * (double)clean->tangent_v[next][i];
      length2 += normal[axis] * normal[axis];
      offset += normal[axis] * (points[k].position[axis] - clean->origin[axis] - (double)clean->position[axis][i]);
    }
    n_done++;
    sum2 += offset * offset / length2;
  }
  free(points);
  conic_surface_destroy(surface);
  CHECK(n_done > n - n / 20);
  return sqrt(sum2 / (double)n_done) / spacing;
}

/* PCL's own neighbourhood, of 4 spacings and 26 neighbours, with weights that are as even as they can be and yet end
 * smoothly. */
static void check_flat(conic_context *context, const conic_splats *noisy, const conic_splats *clean, double spacing) {
  conic_surface_options options;
  conic_surface_report report;
  conic_splats moved;
  conic_surface_options_init(&options);
  options.weight = CONIC_WEIGHT_FLAT;
  options.neglect = 1.0;
  options.h = 4.0 * spacing;
  options.degree = 2;
  double offset = offset_of(context, noisy, clean, spacing, &options);
  options.degree = 3;
  conic_surface *surface = shape_surface(context, clean, &options);
  CHECK_OK(conic_surface_clean(surface, &moved, &report));
  printf("flat weights, %.1f neighbours: %.3f spacings off; as it is moved by %.3f, %zu of %zu failed\n",
         report.mean_neighbours, offset, report.moved_rms / spacing, report.n_in - report.n_out, report.n_in);
  CHECK(offset <= 0.30 && report.moved_rms <= 0.13 * spacing && report.mean_neighbours < 29.0);
  CHECK(report.n_out > report.n_in - report.n_in / 14);
  conic_surface_destroy(surface);
  conic_splats_release(context, &moved);
}

static void check_scan(conic_context *context, const char *source_folder) {
  conic_surface_options options;
  conic_surface_report report;
  conic_splats moved;
  conic_model clean, noisy;
  char path[4096];
  uint64_t state = 1;
  snprintf(path, sizeof path, "%s/../shared/bench/nefertiti.ply", source_folder);
  FILE *file = fopen(path, "rb");
  if (!file) {
    fprintf(stderr, "skipped: %s is not there\n", path);
    return;
  }
  fclose(file);
  CHECK_OK(conic_model_read(context, path, NULL, &clean));
  CHECK_OK(conic_model_read(context, path, NULL, &noisy));
  double spacing = median_nearest(context, &clean.points);
  for (size_t i = 0; i < noisy.points.count; i++)
    for (int axis = 0; axis < 3; axis++)
      noisy.points.position[axis][i] += (float)(0.5 * spacing * shape_deviate(&state));
  conic_surface_options_init(&options);
  options.h = 2.5 * spacing; /* neglected from 5 spacings on */
  options.degree = 2;
  double offset = offset_of(context, &noisy.points, &clean.points, spacing, &options);
  printf("nefertiti with noise of 0.5 spacings: %.3f spacings off after projection\n", offset);
  CHECK(offset <= 0.30);
  check_projection(context, &noisy.points, options.h, "noisy nefertiti");
  options.degree = 3;
  conic_surface *surface = shape_surface(context, &clean.points, &options);
  CHECK_OK(conic_surface_clean(surface, &moved, &report));
  printf("nefertiti as it is: moved by %.3f spacings, %zu of %zu failed\n", report.moved_rms / spacing,
         report.n_in - report.n_out, report.n_in);
  CHECK(report.moved_rms <= 0.13 * spacing);
  CHECK(report.n_out > report.n_in - report.n_in / 20);
  check_projection(context, &clean.points, options.h, "nefertiti");
  conic_surface_destroy(surface);
  conic_splats_release(context, &moved);
  check_flat(context, &noisy.points, &clean.points, spacing);
  conic_model_release(context, &clean);
  conic_model_release(context, &noisy);
}

/* Clusters: what they change is bounded by their size; with none allowed, nothing. */
static void check_clusters(conic_context *context) {
  conic_splats samples = shape_sample(context, SHAPE_TORUS, 20000, 0.0, 5);
  conic_surface_options options;
  conic_surface_point *exact, *summed;
  conic_surface_options_init(&options);
  options.h = 12.0 * shape_spacing(SHAPE_TORUS, samples.count);
  options.degree = 2;
  conic_surface *surface = shape_surface(context, &samples, &options);
  const size_t step = IS_SANITIZED ? 500 : 100;
  size_t n = shape_project(surface, &samples, step, &exact);
  conic_surface_destroy(surface);
  double before = 0.0;
  for (options.cluster = 0.2; options.cluster < 0.45; options.cluster += 0.1) {
    double sum2 = 0.0, neighbours = 0.0, all = 0.0;
    surface = shape_surface(context, &samples, &options);
    CHECK(shape_project(surface, &samples, step, &summed) == n);
    for (size_t i = 0; i < n; i++) {
      for (int axis = 0; axis < 3; axis++)
        sum2 +=
            (summed[i].position[axis] - exact[i].position[axis]) * (summed[i].position[axis] - exact[i].position[axis]);
      neighbours += summed[i].n_neighbours;
      all += exact[i].n_neighbours;
    }
    double error = sqrt(sum2 / (double)n) / options.h;
    printf("clusters of %.1f: %.0f neighbours for %.0f, %.2g h off\n", options.cluster, neighbours / (double)n,
           all / (double)n, error);
    CHECK(error > before && error <= 0.01 * options.cluster * options.cluster);
    CHECK(neighbours < all);
    before = error;
    free(summed);
    conic_surface_destroy(surface);
  }
  free(exact);
  conic_splats_release(context, &samples);
}

int main(int argc, char **argv) {
  conic_context *context = check_context(2);
  conic_splats noisy = shape_sample(context, SHAPE_TORUS, IS_SANITIZED ? 800 : 4000, 0.3, 9);
  check_definition(context);
  check_projection(context, &noisy, 0.0, "noisy torus");
  check_bits(&noisy);
  check_own_points(context, &noisy);
  check_far(context, &noisy);
  check_clusters(context);
  if (argc > 1 && !IS_SANITIZED)
    check_scan(context, argv[1]);
  conic_splats_release(context, &noisy);
  conic_context_destroy(context);
  return check_result();
}
