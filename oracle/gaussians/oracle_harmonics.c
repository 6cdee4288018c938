/* Real spherical harmonics by their recurrences, of any degree, with the signs of 3D Gaussian splatting: that of
 * order m is (−1)^m of the usual real one. */
#include "oracle/gaussians/oracle_gaussian.h"
#include "oracle/oracle_math.h"

#define FOUR_PI 12.566370614359172953850573533118

/* √((2l + 1)/4π · (l − m)!/(l + m)!), times √2 but for m = 0. */
static double norm_of(int l, int m) {
  double ratio = 1.0;
  for (int k = l - m + 1; k <= l + m; k++)
    ratio /= k;
  return sqrt((2 * l + 1) / FOUR_PI * ratio * (m ? 2.0 : 1.0));
}

/* d^m/dz^m of Legendre's polynomial of degree l. */
static double legendre(int l, int m, double z) {
  double before = 0.0, here = m <= l ? 1.0 : 0.0;
  for (int k = 1; k < 2 * m; k += 2)
    here *= k;
  for (int k = m + 1; k <= l; k++) {
    double next = (z * (2 * k - 1) * here - (k + m - 1) * before) / (k - m);
    before = here;
    here = next;
  }
  return here;
}

/* The real and the imaginary part of (x + iy)^m. */
static void powers_about_z(int degree, const double direction[3], double cosine[5], double sine[5]) {
  cosine[0] = 1.0;
  sine[0] = 0.0;
  for (int m = 1; m <= degree; m++) {
    cosine[m] = direction[0] * cosine[m - 1] - direction[1] * sine[m - 1];
    sine[m] = direction[0] * sine[m - 1] + direction[1] * cosine[m - 1];
  }
}

void conic_oracle_harmonic_values(int degree, const double direction[3], double *y) {
  double cosine[5], sine[5];
  powers_about_z(degree, direction, cosine, sine);
  for (int l = 0; l <= degree; l++)
    for (int m = -l; m <= l; m++) {
      int order = m < 0 ? -m : m;
      double value = norm_of(l, order) * legendre(l, order, direction[2]) * (m < 0 ? sine[order] : cosine[order]);
      y[l * l + l + m] = order & 1 ? -value : value;
    }
}

void conic_oracle_harmonic_slopes(int degree, const double direction[3], double (*slopes)[3]) {
  double cosine[5], sine[5];
  powers_about_z(degree, direction, cosine, sine);
  for (int l = 0; l <= degree; l++)
    for (int m = -l; m <= l; m++) {
      const int order = m < 0 ? -m : m;
      const double *about = m < 0 ? sine : cosine, norm = (order & 1 ? -1.0 : 1.0) * norm_of(l, order);
      const double along = norm * legendre(l, order, direction[2]);
      double *slope = slopes[l * l + l + m];
      slope[0] = order ? along * order * about[order - 1] : 0.0;
      slope[1] = order ? along * order * (m < 0 ? cosine[order - 1] : -sine[order - 1]) : 0.0;
      slope[2] = norm * legendre(l, order + 1, direction[2]) * about[order];
    }
}

void conic_oracle_harmonics(const double *sh, int degree, const double direction[3], double color[3]) {
  double y[(CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1)];
  const int n = (degree + 1) * (degree + 1);
  conic_oracle_harmonic_values(degree, direction, y);
  for (int channel = 0; channel < 3; channel++) {
    color[channel] = 0.0;
    for (int k = 0; k < n; k++)
      color[channel] += y[k] * sh[3 * k + channel]; /* NOLINT(clang-analyzer-core.UndefinedBinaryOperatorResult) */
    color[channel] = oracle_max(color[channel] + 0.5, 0.0);
  }
}
