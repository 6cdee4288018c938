/* The kd-tree against looking at every point: ties, duplicates, points that are nowhere, tiny sets. */
#include "core/estimate/neighbours.h"
#include "tests/support/check.h"
#include "tests/support/random_numbers.h"

enum { MAX_POINTS = 3000, MAX_K = 64 };

static float positions[3][MAX_POINTS];
static const float *const arrays[3] = {positions[0], positions[1], positions[2]};

static int is_finite_point(size_t i) {
  return isfinite(positions[0][i]) && isfinite(positions[1][i]) && isfinite(positions[2][i]);
}

static int coincide(size_t a, size_t b) {
  return positions[0][a] == positions[0][b] && positions[1][a] == positions[1][b] && positions[2][a] == positions[2][b];
}

/* Which points stand for themselves: finite, and none before at the same place. */
static void find_first(size_t n, char *is_first) {
  for (size_t i = 0; i < n; i++) {
    is_first[i] = (char)is_finite_point(i);
    for (size_t j = 0; j < i && is_first[i]; j++)
      if (is_first[j] && coincide(i, j))
        is_first[i] = 0;
  }
}

static double distance2(size_t i, const double query[3]) {
  double x = (double)positions[0][i] - query[0], y = (double)positions[1][i] - query[1],
         z = (double)positions[2][i] - query[2];
  return x * x + y * y + z * z;
}

static int is_nearer(size_t a, size_t b, const double query[3]) {
  double da = distance2(a, query), db = distance2(b, query);
  if (da != db)
    return da < db;
  for (int axis = 0; axis < 3; axis++)
    if (positions[axis][a] != positions[axis][b])
      return positions[axis][a] < positions[axis][b];
  return 0;
}

static size_t search_all(size_t n, const char *is_first, const double query[3], size_t except, size_t k, double limit2,
                         size_t *found) {
  size_t n_found = 0;
  for (size_t i = 0; i < n; i++) {
    if (!is_first[i] || i == except || !(distance2(i, query) <= limit2))
      continue;
    size_t at = n_found;
    if (n_found == k) {
      if (!is_nearer(i, found[k - 1], query))
        continue;
      at--;
    } else
      n_found++;
    for (; at > 0 && is_nearer(i, found[at - 1], query); at--)
      found[at] = found[at - 1];
    found[at] = i;
  }
  return n_found;
}

static void check_query(const conic_neighbours *tree, const char *is_first, const double query[3], size_t except,
                        size_t k, double limit2) {
  size_t expected[MAX_K] = {0};
  uint32_t slots[MAX_K];
  double distances2[MAX_K];
  uint32_t except_slot = except < tree->n_points ? tree->slot_of_point[except] : CONIC_NO_SLOT;
  size_t n = search_all(tree->n_points, is_first, query, except, k, limit2, expected);
  size_t n_found = conic_neighbours_nearest(tree, query, except_slot, k, limit2, slots, distances2);
  CHECK(n_found == n);
  for (size_t i = 0; i < n && i < n_found; i++) {
    CHECK(tree->point_of_slot[slots[i]] == expected[i]);
    CHECK(distances2[i] == distance2(expected[i], query));
  }
}

/* Slot after slot, what a leaf's have in common changes nothing. */
static void check_slots(const conic_neighbours *tree, size_t k) {
  uint32_t expected[MAX_K], slots[MAX_K];
  double expected2[MAX_K], distances2[MAX_K];
  conic_neighbours_around around = {0};
  size_t n_listed = 0;
  for (size_t slot = 0; slot < tree->n_slots; slot++) {
    const double query[3] = {(double)tree->position[0][slot], (double)tree->position[1][slot],
                             (double)tree->position[2][slot]};
    size_t n_expected = conic_neighbours_nearest(tree, query, (uint32_t)slot, k, HUGE_VAL, expected, expected2);
    size_t n = conic_neighbours_of_slot(tree, slot, k, &around, slots, distances2);
    CHECK(n == n_expected && memcmp(slots, expected, n * sizeof *slots) == 0);
    CHECK(memcmp(distances2, expected2, n * sizeof *distances2) == 0);
    n_listed += around.n_known > 1;
  }
  CHECK(n_listed > tree->n_slots / 2 || tree->n_slots < 300);
}

static void check_set(conic_context *context, size_t n, size_t k) {
  static char is_first[MAX_POINTS];
  conic_neighbours tree;
  size_t n_first = 0, n_nowhere = 0;
  uint64_t state = 7;
  find_first(n, is_first);
  for (size_t i = 0; i < n; i++) {
    n_first += (size_t)is_first[i];
    n_nowhere += !is_finite_point(i);
  }
  CHECK_OK(conic_neighbours_build(context, arrays, n, &tree));
  CHECK(tree.n_slots == n_first && tree.n_not_finite == n_nowhere && tree.n_duplicates == n - n_first - n_nowhere);
  for (size_t i = 0; i < n; i++)
    CHECK(is_finite_point(i) ? tree.slot_of_point[i] < n_first : tree.slot_of_point[i] == CONIC_NO_SLOT);
  for (size_t i = 0; i < n; i += 1 + n / 97) {
    if (!is_first[i])
      continue;
    double query[3] = {(double)positions[0][i], (double)positions[1][i], (double)positions[2][i]};
    check_query(&tree, is_first, query, i, k, HUGE_VAL);
    check_query(&tree, is_first, query, SIZE_MAX, k, 0.01);
    for (int axis = 0; axis < 3; axis++)
      query[axis] += 3.0 * random_unit(&state) - 1.5;
    check_query(&tree, is_first, query, SIZE_MAX, k, HUGE_VAL);
  }
  check_slots(&tree, k);
  check_slots(&tree, 1); /* of two that are each other's nearest, one bounds the other */
  conic_neighbours_release(context, &tree);
}

static void fill_random(size_t n, double scale) {
  uint64_t state = 1;
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++)
      positions[axis][i] = (float)(scale * (random_unit(&state) - 0.5));
}

/* Small whole numbers: ties everywhere, and duplicates. */
static void fill_lattice(size_t n, int side) {
  uint64_t state = 2;
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++)
      positions[axis][i] = (float)((int)(random_unit(&state) * side) - side / 2);
}

static void check_threads(void) {
  conic_neighbours trees[3];
  conic_context *contexts[3] = {check_context(1), check_context(2), check_context(7)};
  fill_lattice(MAX_POINTS, 12);
  for (int i = 0; i < 3; i++)
    CHECK_OK(conic_neighbours_build(contexts[i], arrays, MAX_POINTS, &trees[i]));
  for (int i = 1; i < 3; i++)
    CHECK(trees[i].n_slots == trees[0].n_slots &&
          memcmp(trees[i].point_of_slot, trees[0].point_of_slot, trees[0].n_slots * sizeof(uint32_t)) == 0);
  for (int i = 0; i < 3; i++) {
    conic_neighbours_release(contexts[i], &trees[i]);
    conic_context_destroy(contexts[i]);
  }
}

/* On a square grid the eight nearest lie within √2 spacings: √(π·2/8) of one. */
static void test_median_spacing(void) {
  conic_context *context = check_context(2);
  conic_splats splats;
  double spacing;
  CHECK_OK(conic_splats_allocate(context, 10000, 0, &splats));
  for (size_t i = 0; i < 10000; i++) {
    splats.position[0][i] = 0.25f * (float)(i % 100);
    splats.position[1][i] = 0.25f * (float)(i / 100);
    splats.position[2][i] = 7.0f;
  }
  CHECK_OK(conic_splats_spacing(context, &splats, &spacing));
  CHECK_NEAR(spacing, 0.25 * sqrt(3.14159265358979 * 2.0 / 8.0), 1e-12);
  splats.count = 1;
  CHECK_OK(conic_splats_spacing(context, &splats, &spacing));
  CHECK(spacing == 0.0);
  splats.count = 10000;
  conic_splats_release(context, &splats);
  conic_context_destroy(context);
}

int main(void) {
  conic_context *context = check_context(2);
  fill_random(MAX_POINTS, 2.0);
  check_set(context, MAX_POINTS, 20);
  check_set(context, 3, 6); /* more neighbours asked for than there are */
  check_set(context, 1, 6);
  check_set(context, 0, 6);
  fill_random(500, 1e30);
  check_set(context, 500, 8);
  fill_random(500, 1e-30);
  check_set(context, 500, 8);

  fill_lattice(MAX_POINTS, 6); /* 216 places for 3000 points */
  check_set(context, MAX_POINTS, 20);
  fill_lattice(MAX_POINTS, 30);
  check_set(context, MAX_POINTS, 13);
  fill_lattice(MAX_POINTS, 1); /* one place */
  check_set(context, MAX_POINTS, 6);

  fill_lattice(1000, 8);
  positions[0][0] = positions[1][17] = NAN;
  positions[2][300] = HUGE_VALF;
  positions[0][999] = -HUGE_VALF;
  positions[0][5] = 0.0f; /* the two zeros are one place */
  positions[0][6] = -0.0f;
  positions[1][5] = positions[1][6] = positions[2][5] = positions[2][6] = 0.5f;
  check_set(context, 1000, 20);
  for (size_t i = 0; i < 100; i++)
    positions[1][i] = NAN;
  check_set(context, 100, 6);
  conic_context_destroy(context);
  check_threads();
  test_median_spacing();
  return check_result();
}
