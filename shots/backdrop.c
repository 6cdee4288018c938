#include "shots/backdrop.h"

void conic_backdrop_put(const float top[3], const float bottom[3], float exposure, conic_image *image) {
  float *rgba = image->planes[CONIC_PLANE_RGBA];
  for (int y = 0; y < image->height && rgba; y++) {
    float part = ((float)y + 0.5f) / (float)image->height, color[3];
    for (int c = 0; c < 3; c++)
      color[c] = (top[c] + (bottom[c] - top[c]) * part) * exposure;
    for (int x = 0; x < image->width; x++, rgba += 4) {
      for (int c = 0; c < 3; c++)
        rgba[c] += color[c] * (1.0f - rgba[3]);
      rgba[3] = 1.0f;
    }
  }
}
