#include "gaussians/draw/harmonic_color.h"

#include <math.h>

#include "gaussians/scene/half.h"

enum { MOST_HARMONICS = (CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1) };

/* The harmonics of a unit direction, up to the degree; the constants are those of 3D Gaussian splatting. */
static void evaluate_harmonics(float x, float y, float z, int degree, float *h) {
  float xx = x * x, yy = y * y, zz = z * z;
  h[0] = 0.28209479177387814f;
  if (degree < 1)
    return;
  h[1] = -0.4886025119029199f * y;
  h[2] = 0.4886025119029199f * z;
  h[3] = -0.4886025119029199f * x;
  if (degree < 2)
    return;
  h[4] = 1.0925484305920792f * (x * y);
  h[5] = -1.0925484305920792f * (y * z);
  h[6] = 0.31539156525252005f * (2.0f * zz - xx - yy);
  h[7] = -1.0925484305920792f * (x * z);
  h[8] = 0.5462742152960396f * (xx - yy);
  if (degree < 3)
    return;
  h[9] = -0.5900435899266435f * (y * (3.0f * xx - yy));
  h[10] = 2.890611442640554f * (x * y * z);
  h[11] = -0.4570457994644658f * (y * (4.0f * zz - xx - yy));
  h[12] = 0.3731763325901154f * (z * (2.0f * zz - 3.0f * xx - 3.0f * yy));
  h[13] = -0.4570457994644658f * (x * (4.0f * zz - xx - yy));
  h[14] = 1.445305721320277f * (z * (xx - yy));
  h[15] = -0.5900435899266435f * (x * (xx - 3.0f * yy));
  if (degree < 4)
    return;
  h[16] = 2.5033429417967046f * (x * y * (xx - yy));
  h[17] = -1.770130769779931f * (y * z * (3.0f * xx - yy));
  h[18] = 0.9461746957575601f * (x * y * (7.0f * zz - 1.0f));
  h[19] = -0.6690465435572892f * (y * z * (7.0f * zz - 3.0f));
  h[20] = 0.10578554691520431f * (zz * (35.0f * zz - 30.0f) + 3.0f);
  h[21] = -0.6690465435572892f * (x * z * (7.0f * zz - 3.0f));
  h[22] = 0.47308734787878004f * ((xx - yy) * (7.0f * zz - 1.0f));
  h[23] = -1.770130769779931f * (x * z * (xx - 3.0f * yy));
  h[24] = 0.6258357354491761f * (xx * (xx - 3.0f * yy) - yy * (3.0f * xx - yy));
}

int conic_harmonic_color(const conic_gaussians *set, size_t i, const double from_eye[3], float color[3]) {
  const size_t n = (size_t)(set->sh_degree + 1) * (size_t)(set->sh_degree + 1);
  float h[MOST_HARMONICS];
  double squares = from_eye[0] * from_eye[0] + from_eye[1] * from_eye[1] + from_eye[2] * from_eye[2];
  double one_over = squares > 0.0 ? 1.0 / sqrt(squares) : 0.0;
  evaluate_harmonics((float)(from_eye[0] * one_over), (float)(from_eye[1] * one_over), (float)(from_eye[2] * one_over),
                     set->sh_degree, h);
  float sum[3] = {0.0f, 0.0f, 0.0f};
  if (set->sh)
    for (size_t k = 0; k < n; k++)
      for (size_t c = 0; c < 3; c++)
        sum[c] += h[k] * set->sh[(i * n + k) * 3 + c];
  else
    for (size_t k = 0; k < n; k++)
      for (size_t c = 0; c < 3; c++)
        sum[c] += h[k] * conic_float_of_half(set->sh_half[(i * n + k) * 3 + c]);
  for (int c = 0; c < 3; c++) {
    sum[c] += 0.5f;
    color[c] = sum[c] > 0.0f ? sum[c] : 0.0f;
  }
  return sum[0] - sum[0] == 0.0f && sum[1] - sum[1] == 0.0f && sum[2] - sum[2] == 0.0f;
}
