/* Octrees of all kinds of sets: every bound holds, found independently; degenerate sets end; threads change no byte. */
#include "tests/support/octree_fixture.h"
#include "tests/support/sanitized.h"

typedef struct vector {
  double x, y, z;
} vector;

static vector at(float *const arrays[3], size_t i) {
  return (vector){(double)arrays[0][i], (double)arrays[1][i], (double)arrays[2][i]};
}

static vector of(const float v[3]) {
  return (vector){(double)v[0], (double)v[1], (double)v[2]};
}

static double dot(vector a, vector b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vector plus(vector a, double s, vector b) {
  return (vector){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static vector cross(vector a, vector b) {
  return (vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* Cosines and sines around the circle: of 40 and of 12 places. */
static double fortieths[40][2], twelfths[12][2];

static void fill_circle(double (*places)[2], int n) {
  for (int k = 0; k < n; k++) {
    places[k][0] = cos(k * 2.0 * 3.14159265358979 / n);
    places[k][1] = sin(k * 2.0 * 3.14159265358979 / n);
  }
}

/* The nearest that points of the outline and inside of a disc come to p, by trying 200 of them. */
static double distance_to_disc(vector p, vector center, vector u, vector v) {
  double nearest2 = HUGE_VAL;
  for (int ring = 0; ring <= 5; ring++)
    for (int k = 0; k < 40; k++) {
      double r = 1.5 * ring / 5.0;
      vector apart = plus(p, -1.0, plus(plus(center, r * fortieths[k][0], u), r * fortieths[k][1], v));
      double distance2 = dot(apart, apart);
      nearest2 = distance2 < nearest2 ? distance2 : nearest2;
    }
  return sqrt(nearest2);
}

/* Node i against the outlines of its leaves, sampled: the projection in the ellipse, all in sphere and cone, and no
 * leaf farther from the disc than the error. */
static int check_node(const conic_octree *octree, size_t i) {
  const conic_drawn_node *node = &octree->drawn[i];
  vector center = of(node->position), u = of(node->tangent_u), v = of(node->tangent_v), n = cross(u, v);
  double radius = (double)octree->radius[i], error = (double)octree->error[i], slack = 1e-5 * radius;
  int wrong = 0;
  n = plus((vector){0, 0, 0}, 1.0 / sqrt(dot(n, n)), n);
  for (size_t k = octree->first_leaf[i]; k < octree->first_leaf[octree->end[i]]; k++) {
    vector tu = at(octree->leaves.tangent_u, k), tv = at(octree->leaves.tangent_v, k), facing = cross(tu, tv);
    wrong += !(dot(facing, n) >= ((double)octree->cone[i] - 1e-5) * sqrt(dot(facing, facing)));
    for (int step = 0; step < 12; step++) {
      const double *turn = twelfths[step];
      vector p = plus(plus(at(octree->leaves.position, k), 1.5 * turn[0], tu), 1.5 * turn[1], tv);
      vector d = plus(p, -1.0, center);
      double a = dot(d, u) / dot(u, u), b = dot(d, v) / dot(v, v);
      wrong += !(sqrt(a * a + b * b) <= 1.5 * (1.0 + 1e-5)) + !(sqrt(dot(d, d)) <= radius + slack) +
               !(fabs(dot(d, n)) <= error + slack);
    }
  }
  return wrong;
}

/* The other way round: no point of the node's disc is farther from all leaves, of other nodes too. */
static int check_overshoot(const conic_octree *octree, size_t i) {
  const conic_drawn_node *node = &octree->drawn[i];
  vector center = of(node->position), u = of(node->tangent_u), v = of(node->tangent_v);
  /* the trial points leave gaps of a sixth of a leaf's outline */
  double allowed = (double)octree->error[i] * (1.0 + 1e-5) + 0.2 * octree->splat_length;
  double reach = (double)octree->radius[i] + allowed;
  size_t *near = malloc(octree->n_leaves * sizeof *near), n_near = 0;
  int wrong = 0;
  if (!near)
    exit(1);
  for (size_t k = 0; k < octree->n_leaves; k++) {
    vector apart = plus(at(octree->leaves.position, k), -1.0, center), tu = at(octree->leaves.tangent_u, k);
    vector tv = at(octree->leaves.tangent_v, k);
    if (sqrt(dot(apart, apart)) <= reach + 1.5 * sqrt(dot(tu, tu) + dot(tv, tv)))
      near[n_near++] = k;
  }
  for (int ring = 1; ring <= 3; ring++)
    for (int step = 0; step < 16; step++) {
      double angle = step * 3.14159265358979 / 8.0, nearest = HUGE_VAL, r = 1.5 * ring / 3.0;
      vector p = plus(plus(center, r * cos(angle), u), r * sin(angle), v);
      for (size_t k = 0; k < n_near && !(nearest <= allowed); k++)
        nearest = fmin(nearest,
                       distance_to_disc(p, at(octree->leaves.position, near[k]), at(octree->leaves.tangent_u, near[k]),
                                        at(octree->leaves.tangent_v, near[k])));
      wrong += !(nearest <= allowed);
    }
  free(near);
  return wrong;
}

/* Every splat is a leaf once, with its own values. */
static void check_leaves(const conic_octree *octree, const conic_splats *splats) {
  conic_splats leaves;
  CHECK_OK(conic_octree_leaves(octree, &leaves));
  CHECK(leaves.count == splats->count);
  for (int axis = 0; axis < 3; axis++) {
    CHECK(memcmp(leaves.position[axis], splats->position[axis], splats->count * sizeof(float)) == 0);
    CHECK(memcmp(leaves.tangent_u[axis], splats->tangent_u[axis], splats->count * sizeof(float)) == 0);
    CHECK(memcmp(leaves.tangent_v[axis], splats->tangent_v[axis], splats->count * sizeof(float)) == 0);
    CHECK(memcmp(leaves.color[axis], splats->color[axis], splats->count * sizeof(float)) == 0);
  }
  conic_splats_release(octree->context, &leaves);
}

/* The bounds of every node, or, of large sets, of every 97th with few leaves and of all with many. */
static void check_bounds(conic_octree *octree) {
  int wrong = 0, overshot = 0;
  for (size_t i = 0; i < octree->n_nodes; i++) {
    size_t n_leaves = octree->first_leaf[octree->end[i]] - octree->first_leaf[i];
    if (octree->n_leaves <= 3000 || i % 97 == 0 || (n_leaves > 1000 && n_leaves < 100000))
      wrong += check_node(octree, i) != 0;
    if (n_leaves <= 60 && i % (octree->n_leaves > 3000 ? 397 : 11) == 0)
      overshot += check_overshoot(octree, i);
  }
  CHECK(wrong == 0);
  CHECK(overshot == 0);
  octree_check_sound(octree);
}

static void test_scene(conic_scene_type type, size_t count) {
  fixture f = fixture_open(2);
  fixture_scene(&f, type, count);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  CHECK(octree->n_leaves == count);
  double ratio = (double)octree->n_nodes / (double)count;
  if (count >= 2000)
    CHECK(ratio > 0.25 && ratio < 0.5);
  check_leaves(octree, &f.splats);
  check_bounds(octree);
  conic_octree_destroy(octree);
  octree = octree_build(f.context, &f.splats, 1);
  check_bounds(octree);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

/* What --check says of a node that was spoiled. */
static void test_check(void) {
  fixture f = fixture_open(1);
  conic_octree_defects found;
  fixture_scene(&f, CONIC_SCENE_SPHERE, 500);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  octree->radius[3] *= 0.5f;
  octree->cone[5] = 1.0f;
  octree->error[7] *= 1e-4f;
  for (int axis = 0; axis < 3; axis++)
    octree->drawn[9].tangent_v[axis] *= 0.5f;
  CHECK_OK(conic_octree_check(octree, &found));
  CHECK(found.spheres == 1 && found.cones == 1 && found.errors == 1 && found.ellipses == 1 && found.splats == 0);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

/* One thread and five give the same bytes. */
static void test_threads(void) {
  fixture f = fixture_open(1), g = fixture_open(5);
  fixture_scene(&f, CONIC_SCENE_KNOT, 60000);
  for (int quantize = IS_SANITIZED; quantize < 2; quantize++) {
    conic_octree *a = octree_build(f.context, &f.splats, quantize), *b = octree_build(g.context, &f.splats, quantize);
    CHECK(a->n_nodes == b->n_nodes && a->splat_length == b->splat_length && a->position_error == b->position_error);
    CHECK(memcmp(a->codes, b->codes, a->n_nodes * CONIC_NODE_BYTES) == 0);
    CHECK(memcmp(a->index, b->index, a->leaves.count * sizeof *a->index) == 0);
    for (int axis = 0; axis < 3; axis++)
      CHECK(memcmp(a->leaves.tangent_v[axis], b->leaves.tangent_v[axis], a->leaves.count * sizeof(float)) == 0);
    conic_octree_destroy(a);
    conic_octree_destroy(b);
  }
  fixture_close(&f);
  fixture_close(&g);
}

/* Sets that do not split as they should: `place` gives the i-th of n points. */
static void test_degenerate(const char *what, size_t n, void (*place)(size_t i, double p[3])) {
  fixture f = fixture_open(2);
  const double u[3] = {0.01, 0, 0}, v[3] = {0, 0.008, 0.002};
  int before = check_failures;
  fixture_splats(&f, n);
  for (size_t i = 0; i < n; i++) {
    double p[3];
    place(i, p);
    fixture_set(&f, i, p, u, v, 0.5f, 0.5f, 0.5f);
  }
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  CHECK(octree->n_levels <= CONIC_OCTREE_DEPTH && octree->n_leaves == n);
  octree_check_sound(octree);
  check_leaves(octree, &f.splats);
  conic_octree_destroy(octree);
  if (check_failures > before)
    fprintf(stderr, "  with %s\n", what);
  fixture_close(&f);
}

static void all_the_same(size_t i, double p[3]) {
  (void)i;
  p[0] = p[1] = p[2] = 0.3;
}

static void in_a_row(size_t i, double p[3]) {
  p[0] = (double)i * 0.001;
  p[1] = p[2] = 0.0;
}

/* Towards 0 by halves: a mean splits off a few at a time. */
static void crowding(size_t i, double p[3]) {
  p[0] = p[1] = p[2] = pow(0.5, (double)(i % 140)) * (i % 3 ? 1.0 : -1.0);
}

static void two_places(size_t i, double p[3]) {
  p[0] = i % 2 ? 1.0 : (double)(1.0f - 0x1p-24f);
  p[1] = p[2] = 5.0;
}

/* Along the normal: each ellipse is as small as a splat, the spheres are not. */
static void in_a_stack(size_t i, double p[3]) {
  p[0] = p[1] = 0.0;
  p[2] = (double)i;
}

/* Two sheets, back to back, whose normals cancel. */
static void test_two_sides(void) {
  fixture f = fixture_open(1);
  fixture_splats(&f, 800);
  for (size_t i = 0; i < 800; i++) {
    const double p[3] = {(double)(i / 2 % 20), (double)(i / 40), i % 2 ? 0.01 : 0.0}, u[3] = {0.8, 0, 0};
    const double v[3] = {0, i % 2 ? -0.8 : 0.8, 0};
    fixture_set(&f, i, p, u, v, 1.0f, i % 2 ? 0.0f : 1.0f, 0.0f);
  }
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  check_bounds(octree);
  CHECK(octree->cone[0] < -0.99f);
  CHECK(fabsf(octree->normal[2][0]) > 0.999f); /* from the covariance */
  conic_octree_destroy(octree);
  fixture_close(&f);
}

/* What cannot be drawn is kept beside the hierarchy, and what there is nothing of is refused. */
static void test_loose(void) {
  fixture f = fixture_open(1);
  fixture_scene(&f, CONIC_SCENE_TORUS, 1000);
  f.splats.position[1][17] = NAN;
  f.splats.tangent_u[0][400] = INFINITY;
  for (int axis = 0; axis < 3; axis++)
    f.splats.tangent_v[axis][999] = 0.0f;
  f.splats.color[2][3] = NAN;
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  CHECK(octree->n_points == 1000 && octree->n_leaves == 996);
  CHECK(octree->index[996] == 3 && octree->index[997] == 17 && octree->index[998] == 400 && octree->index[999] == 999);
  octree_check_sound(octree);
  check_leaves(octree, &f.splats);
  conic_octree_destroy(octree);
  octree = octree_build(f.context, &f.splats, 1);
  CHECK(octree->leaves.count == 996);
  octree_check_sound(octree);
  conic_octree_destroy(octree);
  for (size_t i = 0; i < 1000; i++)
    f.splats.position[0][i] = NAN;
  conic_splats copy = octree_copy(f.context, &f.splats);
  conic_octree_options options;
  conic_octree_options_init(&options);
  CHECK(conic_octree_build(f.context, &copy, &options, &octree) == CONIC_ERROR_INPUT && !octree);
  fixture_splats(&f, 1);
  const double far[3] = {1e16, 0, 0}, u[3] = {1, 0, 0}, v[3] = {0, 1, 0};
  fixture_set(&f, 0, far, u, v, 1, 1, 1);
  copy = octree_copy(f.context, &f.splats);
  CHECK(conic_octree_build(f.context, &copy, &options, &octree) == CONIC_ERROR_INPUT && !octree);
  fixture_close(&f);
}

static void test_few(void) {
  for (size_t n = 1; n <= 20; n++)
    test_degenerate("few", n, in_a_row);
}

int main(int argc, char **argv) {
  fill_circle(fortieths, 40);
  fill_circle(twelfths, 12);
  const char *source_folder = argc > 1 ? argv[1] : ".";
  test_scene(CONIC_SCENE_SPHERE, 2000);
  test_scene(CONIC_SCENE_GYROID, 3000);
  if (!IS_SANITIZED)
    test_scene(CONIC_SCENE_TERRAIN, 10000);
  test_check();
  test_threads();
  test_few();
  test_degenerate("all in one place", 5000, all_the_same);
  test_degenerate("a row", 5000, in_a_row);
  test_degenerate("crowding", 3000, crowding);
  test_degenerate("two places", 3000, two_places);
  test_degenerate("a stack", 3000, in_a_stack);
  test_two_sides();
  test_loose();
  fixture f = fixture_open(0);
  if (!IS_SANITIZED && octree_read_scan(&f, source_folder, "lion.ply")) {
    conic_octree *octree = octree_build(f.context, &f.splats, 0);
    check_bounds(octree);
    conic_octree_destroy(octree);
  }
  fixture_close(&f);
  return check_result();
}
