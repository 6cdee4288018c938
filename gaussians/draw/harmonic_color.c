#include "gaussians/draw/gaussian_footprint.h"

#include "core/base/vectors.h"
#include "gaussians/scene/gaussian_set.h"
#include "gaussians/scene/harmonics.h"

int conic_harmonic_sum(const conic_gaussians *set, size_t i, int is_plain, const float *harmonics, size_t stride,
                       float color[3]) {
  float room[CONIC_MOST_HARMONICS], sum[3] = {0.0f, 0.0f, 0.0f};
  const float *sh = conic_gaussians_harmonics(set, i, room);
  const size_t n = is_plain ? 3 : conic_harmonics_of_degree(set->sh_degree);
  for (size_t k = 0; k < n; k += 3, harmonics += stride)
    for (size_t c = 0; c < 3; c++)
      sum[c] += *harmonics * sh[k + c];
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
