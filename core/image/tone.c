/* Tone curves: map light without bound to colours that a screen can show. Only + − × ÷ √ are used, so that the bits are
 * the same everywhere. */
#include <float.h>

#include "conic/image.h"
#include "core/base/base.h"
#include "core/base/color.h"

CONIC_DEFINE_NAMES(conic_tone_name, conic_tone, CONIC_N_TONES, "srgb", "filmic", "aces", "agx")

/* Hable's ((x·(A·x + C·B) + D·E)/(x·(A·x + B) + D·F)) − E/F with A to F = 0.15, 0.5, 0.1, 0.2, 0.02, 0.3, as one
 * fraction: this way black is exactly 0. */
static double hable(double x) {
  return x * (0.042 * x + 0.005) / (0.3 * (x * (0.15 * x + 0.5) + 0.06));
}

static void map_filmic(double color[3]) {
  enum { EXPOSURE = 2 }; /* exposure before the curve; after that, 11.2 is white: both are Hable's */
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

/* The base-2 logarithm of a normal number above 0, to 1e-13: with m from √½ to √2, the logarithm of m to base e is 2·(t
 * + t³/3 + …), t = (m - 1)/(m + 1). */
static double stops_of(double x) {
  static const double root = 1.4142135623730951, stops_of_e = 1.4426950408889634;
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  double whole = (double)(int)(bits >> 52) - 1023.0, m;
  bits = (bits & ((UINT64_C(1) << 52) - 1)) | UINT64_C(1023) << 52;
  memcpy(&m, &bits, sizeof m);
  if (m > root) {
    m *= 0.5;
    whole += 1.0;
  }
  double t = (m - 1.0) / (m + 1.0), tt = t * t, sum = 0.0;
  for (int k = 15; k > 0; k -= 2)
    sum = sum * tt + 1.0 / k;
  return whole + 2.0 * stops_of_e * (t * sum);
}

/* Sobotka's AgX: stops about middle grey go through Wrensch's polynomial for its sigmoid, between matrices that move
 * bright colours towards white. The results are screen codes. */
static void map_agx(double color[3]) {
  static const double inset[3][3] = {{0.842479062253094, 0.0784335999999992, 0.0792237451477643},
                                     {0.0423282422610123, 0.878468636469772, 0.0791661274605434},
                                     {0.0423756549057051, 0.0784336, 0.879142973793104}};
  static const double outset[3][3] = {{1.19687900512017, -0.0980208811401368, -0.0990297440797205},
                                      {-0.0528968517574562, 1.15190312990417, -0.0989611768448433},
                                      {-0.0529716355144438, -0.0980434501171241, 1.15107367264116}};
  static const double lowest = -12.47393, highest = 4.026069, least = 0x1p-20;
  multiply_color(inset, color);
  for (int c = 0; c < 3; c++) {
    double x = conic_unit((stops_of(color[c] > least ? color[c] : least) - lowest) / (highest - lowest));
    color[c] = (((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x + 0.1191) * x - 0.00232;
  }
  multiply_color(outset, color);
  for (int c = 0; c < 3; c++)
    color[c] = conic_srgb_decode(conic_unit(color[c]));
}

void conic_tone_map(conic_tone tone, const float linear[3], float mapped[3]) {
  double color[3];
  static void (*const maps[CONIC_N_TONES])(double color[3]) = {
      [CONIC_TONE_FILMIC] = map_filmic, [CONIC_TONE_ACES] = map_aces, [CONIC_TONE_AGX] = map_agx};
  if (tone <= CONIC_TONE_SRGB || tone >= CONIC_N_TONES) {
    memmove(mapped, linear, 3 * sizeof *mapped);
    return;
  }
  for (int c = 0; c < 3; c++) /* NaN becomes 0; infinities, whose quotient is NaN, become the largest float */
    color[c] = linear[c] > 0.0f ? linear[c] < FLT_MAX ? (double)linear[c] : (double)FLT_MAX : 0.0;
  maps[tone](color);
  for (int c = 0; c < 3; c++)
    mapped[c] = (float)conic_unit(color[c]);
}
