/* Moments that are merged against moments that are computed at once, also in map coordinates; with the sums kept about
 * the world's origin, as Confetti has them, the latter would come out wrong. */
#include "lod/octree/octree_fit.h"
#include "tests/support/fixture.h"

enum { N = 4000 };

static double value_at(float *const arrays[3], int axis, size_t i) {
  return (double)arrays[axis][i];
}

/* Row a, column b of the six. */
static double entry(const double scatter[6], int a, int b) {
  static const int places[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  return scatter[places[a][b]];
}

/* Merges the splats begin … end, halved again and again. */
static conic_moments merge_halves(const conic_splats *splats, size_t begin, size_t end) {
  conic_moments sum, more;
  if (end - begin == 1) {
    conic_moments_of_splat(splats, begin, &sum);
    return sum;
  }
  sum = merge_halves(splats, begin, begin + (end - begin) / 3 + (end - begin < 3));
  more = merge_halves(splats, begin + (end - begin) / 3 + (end - begin < 3), end);
  conic_moments_merge(&sum, &more);
  return sum;
}

/* Returns the greatest error of the covariance that Σ p'p'ᵀ about the origin would give, relative to its trace. */
static double test_place(double x, double y, double z) {
  const double place[3] = {x, y, z};
  fixture f = fixture_open(1);
  uint64_t state = 1;
  fixture_splats(&f, N);
  for (size_t i = 0; i < N; i++)
    for (int axis = 0; axis < 3; axis++) { /* in steps that floats have there */
      f.splats.position[axis][i] = (float)(place[axis] + floor(64.0 * (axis + 1) * fixture_random(&state)));
      f.splats.tangent_u[axis][i] = (float)fixture_random(&state) - 0.5f;
      f.splats.tangent_v[axis][i] = (float)fixture_random(&state) - 0.5f;
      f.splats.color[axis][i] = (float)fixture_random(&state);
    }
  conic_moments merged = merge_halves(&f.splats, 0, N);
  double mean[3], trace = 0.0, worst = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    mean[axis] = 0.0;
    for (size_t i = 0; i < N; i++)
      mean[axis] += (value_at(f.splats.position, axis, i) - place[axis]) / N;
    mean[axis] += place[axis];
    CHECK_NEAR(merged.mean[axis], mean[axis], 1e-15 * fabs(mean[axis]) + 1e-12);
  }
  CHECK(merged.count == N);
  for (int a = 0; a < 3; a++)
    trace += entry(merged.scatter, a, a);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      double direct = 0.0, about_origin = 0.0;
      for (size_t i = 0; i < N; i++) {
        double own = value_at(f.splats.tangent_u, a, i) * value_at(f.splats.tangent_u, b, i) +
                     value_at(f.splats.tangent_v, a, i) * value_at(f.splats.tangent_v, b, i);
        direct += (value_at(f.splats.position, a, i) - mean[a]) * (value_at(f.splats.position, b, i) - mean[b]) + own;
        about_origin += value_at(f.splats.position, a, i) * value_at(f.splats.position, b, i) + own;
      }
      about_origin -= N * mean[a] * mean[b];
      CHECK_NEAR(entry(merged.scatter, a, b), direct, 1e-12 * trace);
      worst = fmax(worst, fabs(about_origin - direct) / trace);
    }
  fixture_close(&f);
  return worst;
}

/* Weights: the color is the mean by area and opacity, the normals add up by area. */
static void test_averages(void) {
  fixture f = fixture_open(1);
  const double p[3] = {0, 0, 0}, u[3] = {1, 0, 0}, v[3] = {0, 1, 0}, wide[3] = {0, 3, 0};
  conic_moments sum, more;
  fixture_splats(&f, 2);
  fixture_set(&f, 0, p, u, v, 1.0f, 0.0f, 0.5f);
  fixture_set(&f, 1, p, u, wide, 0.0f, 1.0f, 0.5f);
  conic_moments_of_splat(&f.splats, 0, &sum);
  conic_moments_of_splat(&f.splats, 1, &more);
  conic_moments_merge(&sum, &more);
  CHECK_NEAR(sum.color[0] / sum.weight, 0.25, 1e-15);
  CHECK_NEAR(sum.color[1] / sum.weight, 0.75, 1e-15);
  CHECK_NEAR(sum.color[2] / sum.weight, 0.5, 1e-15);
  CHECK_NEAR(sum.normal[2], 4.0, 1e-15);
  CHECK_NEAR(sum.area, 4.0, 1e-15);
  fixture_close(&f);
}

int main(void) {
  test_averages();
  test_place(0.0, 0.0, 0.0);
  CHECK(test_place(500000.0, 5400000.0, 300.0) > 1e-9); /* as metres of a UTM zone; the errata's row */
  return check_result();
}
