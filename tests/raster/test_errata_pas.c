/* Perspective Accurate Splatting as printed and as corrected: each row of docs/notes/errata.md is shown to be wrong
 * as printed and right as corrected, against sampled contours and a numerical convolution. Independent of the renderer.
 */
#include "tests/support/check.h"

typedef double matrix3[3][3];

/* One splat that looks like nothing special: tilted, off the axis, with an anisotropic kernel. */
static const double cutoff = 1.5;
static const double variance_u = 1.7, variance_v = 0.4; /* of the kernel R_k, in tangent units */
static const matrix3 m = {{0.11, 0.02, 0.07}, {-0.03, 0.09, 0.02}, {0.4, -0.3, 1.6}}; /* rows t_u, t_v, p */

static void invert(const matrix3 a, matrix3 inverse) {
  double determinant = 0.0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      inverse[j][i] = a[(i + 1) % 3][(j + 1) % 3] * a[(i + 2) % 3][(j + 2) % 3] -
                      a[(i + 1) % 3][(j + 2) % 3] * a[(i + 2) % 3][(j + 1) % 3];
  for (int j = 0; j < 3; j++)
    determinant += a[0][j] * inverse[j][0];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      inverse[i][j] /= determinant;
}

/* A point of the contour u R_k⁻¹ uᵀ = F_g² in the plane z = 1. */
static void contour_point(double angle, double xy[2]) {
  double u = cutoff * sqrt(variance_u) * cos(angle), v = cutoff * sqrt(variance_v) * sin(angle), at[3];
  for (int j = 0; j < 3; j++)
    at[j] = u * m[0][j] + v * m[1][j] + m[2][j];
  xy[0] = at[0] / at[2];
  xy[1] = at[1] / at[2];
}

/* Q' = M⁻¹ diag(qu, qv, -F_g²) M⁻ᵀ. */
static void map_conic(double qu, double qv, matrix3 q) {
  const double diagonal[3] = {qu, qv, -cutoff * cutoff};
  matrix3 inverse;
  invert(m, inverse);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      q[i][j] = 0.0;
      for (int k = 0; k < 3; k++)
        q[i][j] += inverse[i][k] * diagonal[k] * inverse[j][k];
    }
}

static double conic_value(const matrix3 q, const double xy[2]) {
  const double x[3] = {xy[0], xy[1], 1.0};
  double sum = 0.0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      sum += x[i] * q[i][j] * x[j];
  return sum / fabs(q[2][2]);
}

static double worst_conic_value(const matrix3 q) {
  double worst = 0.0, xy[2];
  for (int i = 0; i < 1000; i++) {
    contour_point(i * 0.0062831853, xy);
    worst = fmax(worst, fabs(conic_value(q, xy)));
  }
  return worst;
}

static void test_isocontour_matrix(void) {
  matrix3 printed, corrected;
  map_conic(variance_u, variance_v, printed);
  map_conic(1.0 / variance_u, 1.0 / variance_v, corrected);
  CHECK(worst_conic_value(printed) > 0.1);
  CHECK(worst_conic_value(corrected) < 1e-12);
}

/* The central conic of Eqs. 7, 10 and 11. */
typedef struct central {
  double x_t, y_t;
  double q_xx, q_xy, q_yy; /* Q''' */
} central;

static central center_conic(void) {
  matrix3 q;
  central c;
  map_conic(1.0 / variance_u, 1.0 / variance_v, q);
  double a = q[0][0], b = q[0][1], cc = q[1][1], d = q[0][2], e = q[1][2], f = -q[2][2];
  double delta = a * cc - b * b;
  c.x_t = (b * e - cc * d) / delta;
  c.y_t = (b * d - a * e) / delta;
  double scale = cutoff * cutoff / (f - d * c.x_t - e * c.y_t);
  c.q_xx = a * scale;
  c.q_xy = b * scale;
  c.q_yy = cc * scale;
  return c;
}

/* Eqs. 7 to 9: printed right. */
static void test_center_and_box(void) {
  central c = center_conic();
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, xy[2];
  double determinant = c.q_xx * c.q_yy - c.q_xy * c.q_xy;
  double half_x = cutoff * sqrt(c.q_yy / determinant), half_y = cutoff * sqrt(c.q_xx / determinant);
  for (int i = 0; i < 200001; i++) {
    contour_point(i * 2.0 * 3.14159265358979 / 200001.0, xy);
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], xy[k]);
      high[k] = fmax(high[k], xy[k]);
    }
  }
  CHECK_NEAR(c.x_t - half_x, low[0], 1e-8);
  CHECK_NEAR(c.x_t + half_x, high[0], 1e-8);
  CHECK_NEAR(c.y_t - half_y, low[1], 1e-8);
  CHECK_NEAR(c.y_t + half_y, high[1], 1e-8);
}

/* Eq. 11: Q''' is an inverse variance. As a variance, its own isocontour is nowhere near F_g². */
static void test_variance_or_inverse(void) {
  central c = center_conic();
  double determinant = c.q_xx * c.q_yy - c.q_xy * c.q_xy, xy[2];
  for (int i = 0; i < 1000; i++) {
    contour_point(i * 0.0062831853, xy);
    double dx = xy[0] - c.x_t, dy = xy[1] - c.y_t;
    double as_variance = (c.q_yy * dx * dx - 2.0 * c.q_xy * dx * dy + c.q_xx * dy * dy) / determinant;
    double as_inverse = c.q_xx * dx * dx + 2.0 * c.q_xy * dx * dy + c.q_yy * dy * dy;
    CHECK(as_variance < 0.01);
    CHECK_NEAR(as_inverse, cutoff * cutoff, 1e-10);
  }
}

/* Eq. 3: a unit-peak kernel of variance R', convolved with a unit-area Gaussian of variance H, at its centre. */
static double convolve_at_center(double r, double h) {
  double sum = 0.0, area = 0.0, step = 0.02;
  for (double y = -9.0; y <= 9.0; y += step)
    for (double x = -9.0; x <= 9.0; x += step) {
      double squared = x * x + y * y;
      sum += exp(-0.5 * squared / r) * exp(-0.5 * squared / h);
      area += exp(-0.5 * squared / h);
    }
  return sum / area;
}

static void test_amplitude(void) {
  const double pi = 3.14159265358979324, h = 1.0;
  const double sizes[] = {0.04, 0.3, 1.0, 4.0}; /* standard deviation squared, px² */
  double before = 0.0;
  for (int i = 0; i < 4; i++) {
    double r = sizes[i], exact = convolve_at_center(r, h);
    double corrected = sqrt(r * r / ((r + h) * (r + h)));
    double printed = 1.0 / r / (2.0 * pi * (r + h));
    CHECK_NEAR(corrected, exact, 1e-9);
    CHECK(fabs(printed - exact) > 0.01);
    CHECK(corrected > before && corrected < 1.0); /* a smaller splat weighs less */
    before = corrected;
  }
}

/* §4.4: the mapping agrees on the outline only. The kernel's centre projects elsewhere than the conic's. */
static void test_interior_is_shifted(void) {
  central c = center_conic();
  double px = m[2][0] / m[2][2], py = m[2][1] / m[2][2];
  CHECK(hypot(c.x_t - px, c.y_t - py) > 1e-4);
}

int main(void) {
  test_isocontour_matrix();
  test_center_and_box();
  test_variance_or_inverse();
  test_amplitude();
  test_interior_is_shifted();
  return check_result();
}
