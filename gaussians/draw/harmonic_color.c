#include "gaussians/draw/gaussian_footprint.h"

#include "core/base/vectors.h"
#include "gaussians/scene/half.h"
#include "gaussians/scene/harmonics.h"

int conic_harmonic_sum(const conic_gaussians *set, size_t i, int is_plain, const float *harmonics, size_t stride,
                       float color[3]) {
  const size_t n = (size_t)(set->sh_degree + 1) * (size_t)(set->sh_degree + 1), n_seen = is_plain ? 1 : n;
  float sum[3] = {0.0f, 0.0f, 0.0f};
  if (set->sh)
    for (size_t k = 0; k < n_seen; k++)
      for (size_t c = 0; c < 3; c++)
        sum[c] += harmonics[k * stride] * set->sh[(i * n + k) * 3 + c];
  else
    for (size_t k = 0; k < n_seen; k++)
      for (size_t c = 0; c < 3; c++)
        sum[c] += harmonics[k * stride] * conic_float_of_half(set->sh_half[(i * n + k) * 3 + c]);
  for (int c = 0; c < 3; c++) {
    sum[c] += 0.5f;
    color[c] = sum[c] > 0.0f ? sum[c] : 0.0f;
  }
  return sum[0] - sum[0] == 0.0f && sum[1] - sum[1] == 0.0f && sum[2] - sum[2] == 0.0f;
}

int conic_harmonic_color(const conic_gaussians *set, size_t i, int is_plain, const double from_eye[3], float color[3]) {
  double direction[3] = {from_eye[0], from_eye[1], from_eye[2]}, exact[CONIC_MOST_FUNCTIONS];
  float h[CONIC_MOST_FUNCTIONS];
  conic_normalize(direction);
  conic_harmonics_evaluate(direction, set->sh_degree, exact);
  for (int k = 0; k < (set->sh_degree + 1) * (set->sh_degree + 1); k++)
    h[k] = (float)exact[k];
  return conic_harmonic_sum(set, i, is_plain, h, 1, color);
}
