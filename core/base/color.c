#include "core/base/color.h"

#include <math.h>

#include "core/base/power.h"

static double fifth_root(double v) {
  double r = conic_root_guess(v, 5);
  for (int i = 0; i < 6; i++)
    r = r - (r - v / (r * r * (r * r))) / 5.0;
  return r;
}

double conic_srgb_decode(double encoded) {
  if (!(encoded > 0.04045))
    return encoded / 12.92;
  double y = (encoded + 0.055) / 1.055;
  return y * y * fifth_root(y * y); /* y^2.4 */
}

double conic_srgb_encode(double linear) {
  if (!(linear > 0.0031308))
    return linear * 12.92;
  if (!(linear < 1e60))
    return linear;
  double five_thirds = linear * conic_cube_root(linear * linear);
  return 1.055 * sqrt(sqrt(five_thirds)) - 0.055; /* linear^(5/12) */
}

void conic_oklab_of(const double linear[3], double lab[3]) {
  static const double cones[3][3] = {{0.4122214708, 0.5363325363, 0.0514459929},
                                     {0.2119034982, 0.6806995451, 0.1073969566},
                                     {0.0883024619, 0.2817188376, 0.6299787005}};
  static const double axes[3][3] = {{0.2104542553, 0.7936177850, -0.0040720468},
                                    {1.9779984951, -2.4285922050, 0.4505937099},
                                    {0.0259040371, 0.7827717662, -0.8086757660}};
  double roots[3];
  for (int i = 0; i < 3; i++) {
    double sum = 0.0;
    for (int k = 0; k < 3; k++)
      sum += cones[i][k] * (linear[k] > 0.0 ? linear[k] < 1.0 ? linear[k] : 1.0 : 0.0);
    roots[i] = sum > 0.0 ? conic_cube_root(sum) : 0.0;
  }
  for (int i = 0; i < 3; i++)
    lab[i] = axes[i][0] * roots[0] + axes[i][1] * roots[1] + axes[i][2] * roots[2];
}

void conic_srgb_decode_table(float table[256]) {
  for (int i = 0; i < 256; i++)
    table[i] = (float)conic_srgb_decode((double)i / 255.0);
}

void conic_srgb_thresholds(float thresholds[255]) {
  for (int i = 0; i < 255; i++)
    thresholds[i] = (float)conic_srgb_decode(((double)i + 0.5) / 255.0);
}

uint8_t conic_srgb_code(const float thresholds[255], float linear) {
  int low = 0, high = 255; /* the code is in [low, high] */
  while (low < high) {
    int middle = (low + high) / 2;
    if (linear >= thresholds[middle])
      low = middle + 1;
    else
      high = middle;
  }
  return (uint8_t)low;
}

float conic_exposure_factor(double stops) {
  double whole = floor(stops), rest = (stops - whole) * 0.69314718055994530942, term = 1.0, sum = 1.0;
  for (int n = 1; n < 20; n++) {
    term *= rest / (double)n;
    sum += term;
  }
  for (; whole > 0.0; whole -= 1.0)
    sum *= 2.0;
  for (; whole < 0.0; whole += 1.0)
    sum *= 0.5;
  return (float)sum;
}
