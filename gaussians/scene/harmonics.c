#include "gaussians/scene/harmonics.h"

#include "core/base/base.h"
#include "core/base/trigonometry.h"

#define NUMBER double
#include "gaussians/scene/harmonics_body.h"

void conic_harmonics_evaluate(const double direction[3], int degree, double *y) {
  evaluate_harmonics(direction, degree, y);
}

static double whole_where_near(double value) {
  for (int whole = -1; whole <= 1; whole++)
    if (fabs(value - whole) < 1e-13)
      return whole;
  return value;
}

/* turn[j][k] = ∫ Y_j(d) Y_k(Rᵀd) over the sphere, by a rule that is exact for products of degree 8: Gauss's five
 * heights, and ten places about the axis at each. */
void conic_harmonics_find_turn(const double rotation[3][3], conic_harmonics_turn turn) {
  static const double heights[5] = {-0.90617984593866399, -0.53846931010568309, 0.0, 0.53846931010568309,
                                    0.90617984593866399};
  static const double weights[5] = {0.23692688505618909, 0.47862867049936647, 0.56888888888888889, 0.47862867049936647,
                                    0.23692688505618909};
  enum { AROUND = 10, N = (CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1) };
  memset(turn, 0, sizeof(conic_harmonics_turn));
  for (int i = 0; i < 5 * AROUND; i++) {
    double azimuth = 2.0 * CONIC_PI * ((i % AROUND) + 0.25) / AROUND, z = heights[i / AROUND], r = sqrt(1.0 - z * z);
    double direction[3] = {r * conic_cos(azimuth), r * conic_sin(azimuth), z}, back[3], y[N], y_back[N];
    double weight = weights[i / AROUND] * 2.0 * CONIC_PI / AROUND;
    for (int k = 0; k < 3; k++)
      back[k] = rotation[0][k] * direction[0] + rotation[1][k] * direction[1] + rotation[2][k] * direction[2];
    conic_harmonics_evaluate(direction, CONIC_MAX_SH_DEGREE, y);
    conic_harmonics_evaluate(back, CONIC_MAX_SH_DEGREE, y_back);
    for (int degree = 0; degree <= CONIC_MAX_SH_DEGREE; degree++)
      for (int j = 0; j < 2 * degree + 1; j++)
        for (int k = 0; k < 2 * degree + 1; k++)
          turn[degree][j][k] += weight * y[degree * degree + j] * y_back[degree * degree + k];
  }
  for (int degree = 0; degree <= CONIC_MAX_SH_DEGREE; degree++)
    for (int j = 0; j < CONIC_MOST_ORDERS; j++)
      for (int k = 0; k < CONIC_MOST_ORDERS; k++)
        turn[degree][j][k] = whole_where_near(turn[degree][j][k]);
}

void conic_harmonics_apply(conic_harmonics_turn turn, int degree, float *sh) {
  for (int l = 1; l <= degree; l++) {
    float *of_degree = sh + (ptrdiff_t)(3 * l * l), old[3 * CONIC_MOST_ORDERS];
    memcpy(old, of_degree, 3 * (size_t)(2 * l + 1) * sizeof *old);
    for (int j = 0; j < 2 * l + 1; j++)
      for (int channel = 0; channel < 3; channel++) {
        double sum = 0.0;
        int is_begun = 0; /* so that -0 stays what it is */
        for (int k = 0; k < 2 * l + 1; k++)
          if (turn[l][j][k] != 0.0) {
            double term = turn[l][j][k] * (double)old[3 * k + channel];
            sum = is_begun ? sum + term : term;
            is_begun = 1;
          }
        of_degree[3 * j + channel] = (float)sum;
      }
  }
}
