#include "gaussians/scene/harmonics.h"

#include "core/base/base.h"
#include "core/base/trigonometry.h"

void conic_harmonics_evaluate(const double direction[3], int degree, double *y) {
  double x = direction[0], v = direction[1], z = direction[2], xx = x * x, yy = v * v, zz = z * z;
  y[0] = 0.28209479177387814;
  if (degree < 1)
    return;
  y[1] = -0.48860251190291992 * v;
  y[2] = 0.48860251190291992 * z;
  y[3] = -0.48860251190291992 * x;
  if (degree < 2)
    return;
  y[4] = 1.0925484305920791 * x * v;
  y[5] = -1.0925484305920791 * v * z;
  y[6] = 0.31539156525252005 * (2.0 * zz - xx - yy);
  y[7] = -1.0925484305920791 * x * z;
  y[8] = 0.54627421529603959 * (xx - yy);
  if (degree < 3)
    return;
  y[9] = -0.59004358992664352 * v * (3.0 * xx - yy);
  y[10] = 2.8906114426405538 * x * v * z;
  y[11] = -0.45704579946446577 * v * (4.0 * zz - xx - yy);
  y[12] = 0.37317633259011546 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy);
  y[13] = -0.45704579946446577 * x * (4.0 * zz - xx - yy);
  y[14] = 1.4453057213202769 * z * (xx - yy);
  y[15] = -0.59004358992664352 * x * (xx - 3.0 * yy);
  if (degree < 4)
    return;
  y[16] = 2.5033429417967046 * x * v * (xx - yy);
  y[17] = -1.7701307697799304 * v * z * (3.0 * xx - yy);
  y[18] = 0.94617469575755997 * x * v * (7.0 * zz - 1.0);
  y[19] = -0.66904654355728917 * v * z * (7.0 * zz - 3.0);
  y[20] = 0.10578554691520431 * (zz * (35.0 * zz - 30.0) + 3.0);
  y[21] = -0.66904654355728917 * x * z * (7.0 * zz - 3.0);
  y[22] = 0.47308734787877998 * (xx - yy) * (7.0 * zz - 1.0);
  y[23] = -1.7701307697799304 * x * z * (xx - 3.0 * yy);
  y[24] = 0.62583573544917614 * (xx * (xx - 3.0 * yy) - yy * (3.0 * xx - yy));
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
