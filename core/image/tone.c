/* Tone curves: light without bound, as colours that a screen can show. Only + − × ÷, so that the bits are the same
 * everywhere. */
#include <float.h>
#include <string.h>

#include "conic/image.h"

const char *conic_tone_name(conic_tone tone) {
  static const char *const names[CONIC_N_TONES] = {"srgb", "filmic", "aces"};
  return (int)tone >= 0 && tone < CONIC_N_TONES ? names[tone] : NULL;
}

static double limit_to_screen(double v) {
  return v > 0.0 ? v < 1.0 ? v : 1.0 : 0.0; /* NaN is 0 */
}

/* Hable's ((x·(A·x + C·B) + D·E)/(x·(A·x + B) + D·F)) − E/F with A to F = 0.15, 0.5, 0.1, 0.2, 0.02, 0.3, as one
 * fraction: this way black is exactly 0. */
static double hable(double x) {
  return x * (0.042 * x + 0.005) / (0.3 * (x * (0.15 * x + 0.5) + 0.06));
}

static void map_filmic(double color[3]) {
  enum { EXPOSURE = 2 }; /* before the curve, and 11.2 after that is white: both as he has it */
  for (int c = 0; c < 3; c++)
    color[c] = hable(EXPOSURE * color[c]) / hable(11.2);
}

static void multiply_color(const double matrix[3][3], double color[3]) {
  const double old[3] = {color[0], color[1], color[2]};
  for (int i = 0; i < 3; i++)
    color[i] = matrix[i][0] * old[0] + matrix[i][1] * old[1] + matrix[i][2] * old[2];
}

static void map_aces(double color[3]) {
  static const double to_rendering[3][3] = {
      {0.59719, 0.35458, 0.04823}, {0.07600, 0.90834, 0.01566}, {0.02840, 0.13383, 0.83777}};
  static const double to_screen[3][3] = {
      {1.60475, -0.53108, -0.07367}, {-0.10208, 1.10813, -0.00605}, {-0.00327, -0.07276, 1.07602}};
  multiply_color(to_rendering, color);
  for (int c = 0; c < 3; c++) {
    double v = color[c];
    color[c] = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
  }
  multiply_color(to_screen, color);
}

void conic_tone_map(conic_tone tone, const float linear[3], float mapped[3]) {
  double color[3];
  if (tone != CONIC_TONE_FILMIC && tone != CONIC_TONE_ACES) {
    memmove(mapped, linear, 3 * sizeof *mapped);
    return;
  }
  for (int c = 0; c < 3; c++) /* NaN is 0, and no infinities, whose quotient would be none */
    color[c] = linear[c] > 0.0f ? linear[c] < FLT_MAX ? (double)linear[c] : (double)FLT_MAX : 0.0;
  if (tone == CONIC_TONE_FILMIC)
    map_filmic(color);
  else
    map_aces(color);
  for (int c = 0; c < 3; c++)
    mapped[c] = (float)limit_to_screen(color[c]);
}
