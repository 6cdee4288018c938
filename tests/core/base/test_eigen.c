/* The eigen-solvers against what eigenvalues and eigenvectors are. */
#include "core/base/eigen.h"
#include "tests/support/check.h"
#include "tests/support/random_numbers.h"

static void check_eigen2(double xx, double xy, double yy) {
  double values[2], major[2], size = fabs(xx) + fabs(xy) + fabs(yy), bound = 4e-16 * size;
  conic_eigen2(xx, xy, yy, values, major);
  CHECK(values[0] >= values[1]);
  CHECK_NEAR(values[0] + values[1], xx + yy, bound);
  CHECK_NEAR(values[0] * values[1], xx * yy - xy * xy, bound * size);
  CHECK_NEAR(major[0] * major[0] + major[1] * major[1], 1.0, 1e-15);
  CHECK(major[0] > 0.0 || (major[0] == 0.0 && major[1] > 0.0));
  CHECK_NEAR(xx * major[0] + xy * major[1], values[0] * major[0], 2.0 * bound);
  CHECK_NEAR(xy * major[0] + yy * major[1], values[0] * major[1], 2.0 * bound);
}

static void check_eigen3(const double m[6]) {
  const double full[3][3] = {{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
  double values[3], vectors[3][3], size = 0.0;
  for (int i = 0; i < 6; i++)
    size += fabs(m[i]);
  conic_eigen3(m, values, vectors);
  CHECK(values[0] >= values[1] && values[1] >= values[2]);
  for (int i = 0; i < 3; i++) {
    double greatest = 0.0;
    for (int row = 0; row < 3; row++) {
      double product = 0.0;
      for (int column = 0; column < 3; column++)
        product += full[row][column] * vectors[i][column];
      CHECK_NEAR(product, values[i] * vectors[i][row], 4e-15 * size);
      if (fabs(vectors[i][row]) > fabs(greatest))
        greatest = vectors[i][row];
    }
    CHECK(greatest > 0.0);
    for (int j = 0; j < 3; j++) {
      double product = 0.0;
      for (int axis = 0; axis < 3; axis++)
        product += vectors[i][axis] * vectors[j][axis];
      CHECK_NEAR(product, i == j ? 1.0 : 0.0, 4e-15);
    }
  }
}

int main(void) {
  uint64_t state = 3;
  double values[2], major[2];
  const double scales[3] = {1.0, 1e-40, 1e60};
  for (int i = 0; i < 3000; i++) {
    double m[6], scale = scales[i % 3];
    for (int j = 0; j < 6; j++)
      m[j] = scale * (random_unit(&state) - 0.5);
    check_eigen2(m[0], m[1], m[2]);
    check_eigen3(m);
    /* Flat: a plane's covariance. */
    double a[3] = {m[0], m[1], m[2]}, b[3] = {m[3], m[4], m[5]};
    const double flat[6] = {a[0] * a[0] + b[0] * b[0], a[0] * a[1] + b[0] * b[1], a[0] * a[2] + b[0] * b[2],
                            a[1] * a[1] + b[1] * b[1], a[1] * a[2] + b[1] * b[2], a[2] * a[2] + b[2] * b[2]};
    check_eigen3(flat);
  }
  check_eigen2(1.0, 0.0, 1.0);
  check_eigen2(1.0, 0.0, 2.0);
  check_eigen2(2.0, -1.0, 2.0);
  check_eigen2(1.0, 1.0, 1.0);
  conic_eigen2(0.0, 0.0, 0.0, values, major);
  CHECK(values[0] == 0.0 && values[1] == 0.0 && major[0] == 1.0 && major[1] == 0.0);
  const double special[][6] = {{0, 0, 0, 0, 0, 0}, {1, 0, 0, 1, 0, 1}, {1, 0, 0, 2, 0, 3},    {3, 0, 0, 2, 0, 1},
                               {1, 1, 1, 1, 1, 1}, {0, 1, 0, 0, 0, 0}, {1, 1e-12, 0, 1, 0, 1}};
  for (size_t i = 0; i < sizeof special / sizeof special[0]; i++)
    check_eigen3(special[i]);
  return check_result();
}
