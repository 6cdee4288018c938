/* Random numbers by number, noise and the terrain made of it, with their derivatives. */
#include "core/base/random.h"
#include "core/scenes/noise.h"
#include "core/scenes/scene_terrain.h"
#include "tests/support/check.h"

/* A derivative against a difference quotient. */
static void test_noise_derivatives(void) {
  const double h = 1e-5;
  for (int i = 0; i < 500; i++) {
    double x = 9.0 * conic_random_uniform(1, (uint64_t)i, 0) - 4.5,
           y = 9.0 * conic_random_uniform(1, (uint64_t)i, 1) - 4.5;
    conic_jet at, left, right, below, above;
    conic_noise(5, x, y, &at);
    conic_noise(5, x - h, y, &left);
    conic_noise(5, x + h, y, &right);
    conic_noise(5, x, y - h, &below);
    conic_noise(5, x, y + h, &above);
    CHECK(fabs(at.value) < 1.0);
    CHECK_NEAR(at.gradient[0], (right.value - left.value) / (2.0 * h), 1e-8);
    CHECK_NEAR(at.gradient[1], (above.value - below.value) / (2.0 * h), 1e-8);
    CHECK_NEAR(at.xx, (right.gradient[0] - left.gradient[0]) / (2.0 * h), 1e-6);
    CHECK_NEAR(at.xy, (above.gradient[0] - below.gradient[0]) / (2.0 * h), 1e-6);
    CHECK_NEAR(at.yy, (above.gradient[1] - below.gradient[1]) / (2.0 * h), 1e-6);
  }
}

static void test_terrain_slopes(void) {
  size_t n_land = 0;
  for (int i = 0; i < 2000; i++) {
    double x = 2.0 * conic_random_uniform(2, (uint64_t)i, 0) - 1.0,
           z = 2.0 * conic_random_uniform(2, (uint64_t)i, 1) - 1.0;
    conic_terrain_place at, left, right, behind, before;
    conic_terrain_at(3, x, z, &at);
    conic_terrain_at(3, x - 1e-6, z, &left);
    conic_terrain_at(3, x + 1e-6, z, &right);
    conic_terrain_at(3, x, z - 1e-6, &behind);
    conic_terrain_at(3, x, z + 1e-6, &before);
    if (fabs(at.ground) < 1e-4)
      continue;
    n_land += at.ground > 0.0;
    CHECK_NEAR(at.slope[0], (right.height - left.height) / 2e-6, 1e-4);
    CHECK_NEAR(at.slope[1], (before.height - behind.height) / 2e-6, 1e-4);
  }
  CHECK(n_land > 300 && n_land < 1700);
}

static void test_random(void) {
  enum { COUNT = 200000 };
  double mean = 0.0, square = 0.0, fourth = 0.0, uniform = 0.0, product = 0.0;
  for (uint64_t i = 0; i < COUNT; i++) {
    double u = conic_random_uniform(9, i, 0), g = conic_random_gaussian(9, i, 2);
    CHECK(u >= 0.0 && u < 1.0);
    uniform += u / COUNT;
    product += (u - 0.5) * (conic_random_uniform(9, i, 1) - 0.5) / COUNT;
    mean += g / COUNT;
    square += g * g / COUNT;
    fourth += g * g * g * g / COUNT;
  }
  CHECK_NEAR(uniform, 0.5, 5.0 * sqrt(1.0 / 12.0 / COUNT));
  CHECK_NEAR(product, 0.0, 5.0 / 12.0 / sqrt(COUNT));
  CHECK_NEAR(mean, 0.0, 5.0 / sqrt(COUNT));
  CHECK_NEAR(square, 1.0, 5.0 * sqrt(2.0 / COUNT));
  CHECK_NEAR(fourth, 2.9, 0.1); /* twelve uniforms have 2.9 where the Gaussian has 3 */
  CHECK(conic_random_bits(1, 2, 3) != conic_random_bits(2, 2, 3) &&
        conic_random_bits(1, 2, 3) != conic_random_bits(1, 3, 2));
}

int main(void) {
  test_random();
  test_noise_derivatives();
  test_terrain_slopes();
  return check_result();
}
