/* Confetti's formulas as printed against as corrected: each check fails with the one and holds with the other. */
#include "core/base/eigen.h"
#include "core/splats/ellipse.h"
#include "tests/support/check.h"
#include "tests/support/random_numbers.h"

enum { N_POINTS = 20000 };

static double points[N_POINTS][2];

/* Evenly spread in an ellipse with half axes 4 and 1, turned by 30°. */
static void fill_ellipse(void) {
  uint64_t state = 5;
  for (int i = 0; i < N_POINTS;) {
    double x = 2.0 * random_unit(&state) - 1.0, y = 2.0 * random_unit(&state) - 1.0;
    if (x * x + y * y > 1.0)
      continue;
    points[i][0] = 4.0 * x * sqrt(0.75) - y * 0.5;
    points[i++][1] = 4.0 * x * 0.5 + y * sqrt(0.75);
  }
}

/* §4.1 and §4.3: the eigenvalues are variances; the axes go as their roots, not as themselves. */
static void check_axes(void) {
  double covariance[3] = {0.0, 0.0, 0.0}, values[2], major[2];
  for (int i = 0; i < N_POINTS; i++)
    conic_ellipse_add(covariance, points[i][0], points[i][1]);
  conic_eigen2(covariance[0], covariance[1], covariance[2], values, major);
  double printed = values[1] / values[0], corrected = sqrt(values[1] / values[0]);
  CHECK(fabs(printed - 0.25) > 0.15);
  CHECK_NEAR(corrected, 0.25, 0.01);

  conic_ellipse ellipse = conic_ellipse_bound((const double(*)[2])points, N_POINTS, 1e-3);
  CHECK_NEAR(ellipse.ratio, 0.25, 0.01);
  CHECK_NEAR(ellipse.reach, 4.0, 0.1);
  CHECK_NEAR(ellipse.major[0], sqrt(0.75), 0.01);
  CHECK_NEAR(ellipse.major[1], 0.5, 0.01);
  /* It bounds every point, and tightly: one is on it. */
  double greatest = 0.0;
  for (int i = 0; i < N_POINTS; i++) {
    double along = points[i][0] * ellipse.major[0] + points[i][1] * ellipse.major[1];
    double across = points[i][1] * ellipse.major[0] - points[i][0] * ellipse.major[1];
    greatest = fmax(greatest, along * along + across * across / (ellipse.ratio * ellipse.ratio));
  }
  CHECK_NEAR(sqrt(greatest) / ellipse.reach, 1.0, 1e-12);
}

/* §4.3: the characteristic polynomial is λ² - trace·λ + det; with a plus it has the eigenvalues' negatives as roots. */
static void check_polynomial(void) {
  const double xx = 3.0, xy = 1.0, yy = 2.0, trace = xx + yy, det = xx * yy - xy * xy;
  double values[2], major[2];
  conic_eigen2(xx, xy, yy, values, major);
  for (int i = 0; i < 2; i++) {
    CHECK(fabs(values[i] * values[i] + trace * values[i] + det) > 1.0);
    CHECK_NEAR(values[i] * values[i] - trace * values[i] + det, 0.0, 1e-14);
    /* And it is an eigenvalue indeed: the matrix without it is singular. */
    CHECK_NEAR((xx - values[i]) * (yy - values[i]) - xy * xy, 0.0, 1e-14);
  }
}

static void printed_basis(const double n[3], double x[3], double y[3]) {
  y[0] = 0.0;
  y[1] = -n[2];
  y[2] = n[1];
  for (int axis = 0; axis < 3; axis++)
    x[axis] = y[(axis + 1) % 3] * n[(axis + 2) % 3] - y[(axis + 2) % 3] * n[(axis + 1) % 3];
}

/* How far (u, v, n) is from a right-handed orthonormal basis. */
static double basis_error(const double u[3], const double v[3], const double n[3]) {
  double uu = -1.0, vv = -1.0, uv = 0.0, error;
  for (int axis = 0; axis < 3; axis++) {
    uu += u[axis] * u[axis];
    vv += v[axis] * v[axis];
    uv += u[axis] * v[axis];
  }
  error = fmax(fmax(fabs(uu), fabs(vv)), fabs(uv));
  for (int axis = 0; axis < 3; axis++)
    error = fmax(error, fabs(u[(axis + 1) % 3] * v[(axis + 2) % 3] - u[(axis + 2) % 3] * v[(axis + 1) % 3] - n[axis]));
  return error;
}

/* §4.3: R_y = (0, -n_z, n_y) is not of unit length, and zero where n is along x. */
static void check_basis(void) {
  const double along_x[3] = {1.0, 0.0, 0.0}, slanted[3] = {0.6, 0.0, 0.8};
  double u[3], v[3];
  uint64_t state = 9;
  printed_basis(along_x, u, v);
  CHECK(basis_error(u, v, along_x) > 0.5);
  printed_basis(slanted, u, v);
  CHECK(basis_error(u, v, slanted) > 0.1);
  for (int i = 0; i < 20000; i++) {
    double n[3], length2 = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      /* Also right next to the poles, and on the axes. */
      n[axis] = (random_unit(&state) - 0.5) * (i % 4 == 0 && axis != i % 3 ? 1e-9 : 1.0) * (i % 7 == axis ? 0.0 : 1.0);
      length2 += n[axis] * n[axis];
    }
    if (length2 == 0.0)
      continue;
    for (int axis = 0; axis < 3; axis++)
      n[axis] /= sqrt(length2);
    conic_tangent_basis(n, u, v);
    CHECK(basis_error(u, v, n) < 1e-15);
  }
  const double poles[4][3] = {{0, 0, 1}, {0, 0, -1}, {-1, 0, 0}, {0, -1, -0.0}};
  for (int i = 0; i < 4; i++) {
    conic_tangent_basis(poles[i], u, v);
    CHECK(basis_error(u, v, poles[i]) < 1e-15);
  }
}

static double printed_kernel(double r, double a, double b, int n) {
  double power = pow(r - b, n);
  return exp(-a * power / (1.0 - power));
}

static double corrected_kernel(double r, double a, double b, int n) {
  double power = pow(r / b, n);
  return r < b ? exp(-a * power / (1.0 - power)) : 0.0;
}

/* Eq. 10: the text demands 1 at 0, within [0, 1], falling, and towards 0 at b. */
static int is_blending_kernel(double (*kernel)(double, double, double, int), double a, double b, int n) {
  double before = kernel(0.0, a, b, n);
  if (fabs(before - 1.0) > 1e-12 || kernel(b * (1.0 - 1e-9), a, b, n) > 1e-6)
    return 0;
  for (int i = 1; i < 1000; i++) {
    double here = kernel(b * i / 1000.0, a, b, n);
    if (!(here >= 0.0 && here <= before))
      return 0;
    before = here;
  }
  return 1;
}

static void check_kernel(void) {
  CHECK(!is_blending_kernel(printed_kernel, 4.0, 1.5, 5));
  CHECK_NEAR(printed_kernel(0.0, 4.0, 1.5, 5), 34.3, 0.1);
  CHECK(is_blending_kernel(corrected_kernel, 4.0, 1.5, 5));
  CHECK(is_blending_kernel(corrected_kernel, 1.0, 2.0, 1));
}

/* §4.2: the homogeneous covariance about the world's origin loses everything far from there; about a local one,
 * nothing. */
static void check_covariance(void) {
  const double far = 5e6;
  double about_world[3] = {0.0, 0.0, 0.0}, mean[2] = {0.0, 0.0}, about_local[3] = {0.0, 0.0, 0.0};
  double values_world[2], values_local[2], major[2];
  for (int i = 0; i < N_POINTS; i++) {
    double x = far + 1e-3 * points[i][0], y = far + 1e-3 * points[i][1];
    conic_ellipse_add(about_world, x, y);
    conic_ellipse_add(about_local, x - far, y - far);
    mean[0] += x / N_POINTS;
    mean[1] += y / N_POINTS;
  }
  conic_eigen2(about_world[0] / N_POINTS - mean[0] * mean[0], about_world[1] / N_POINTS - mean[0] * mean[1],
               about_world[2] / N_POINTS - mean[1] * mean[1], values_world, major);
  conic_eigen2(about_local[0] / N_POINTS, about_local[1] / N_POINTS, about_local[2] / N_POINTS, values_local, major);
  CHECK(fabs(values_world[0] / 4e-6 - 1.0) > 0.5);
  CHECK_NEAR(values_local[0], 4e-6, 1e-7); /* a quarter of the squared half axis */
}

int main(void) {
  fill_ellipse();
  check_axes();
  check_polynomial();
  check_basis();
  check_kernel();
  check_covariance();
  return check_result();
}
