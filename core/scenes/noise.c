#include "core/scenes/noise.h"

#include <math.h>

#include "core/base/random.h"

/* The weight of a cell's far side, 6t⁵ − 15t⁴ + 10t³, and its derivatives. */
typedef struct fade {
  double value, first, second;
} fade;

static fade fade_at(double t) {
  double s = t - 1.0;
  return (fade){t * t * t * (t * (6.0 * t - 15.0) + 10.0), 30.0 * t * t * s * s, 60.0 * t * s * (2.0 * t - 1.0)};
}

static fade opposite(fade far) {
  return (fade){1.0 - far.value, -far.first, -far.second};
}

/* Adds a corner's plane through zero, of random slope in [-1, 1)², times the product of its weights. */
static void add_corner(uint64_t seed, int64_t i, int64_t j, double dx, double dy, fade wx, fade wy, conic_jet *jet) {
  uint64_t bits = conic_random_bits(seed, (uint64_t)i, (uint64_t)j);
  double gx = (double)(bits >> 32) * 0x1p-31 - 1.0, gy = (double)(bits & 0xffffffff) * 0x1p-31 - 1.0;
  double plane = gx * dx + gy * dy;
  double w = wx.value * wy.value, w_x = wx.first * wy.value, w_y = wx.value * wy.first;
  jet->value += w * plane;
  jet->gradient[0] += w_x * plane + w * gx;
  jet->gradient[1] += w_y * plane + w * gy;
  jet->xx += wx.second * wy.value * plane + 2.0 * w_x * gx;
  jet->xy += wx.first * wy.first * plane + w_x * gy + w_y * gx;
  jet->yy += wx.value * wy.second * plane + 2.0 * w_y * gy;
}

void conic_noise(uint64_t seed, double x, double y, conic_jet *jet) {
  double x_floor = floor(x), y_floor = floor(y);
  double dx = x - x_floor, dy = y - y_floor;
  int64_t i = (int64_t)x_floor, j = (int64_t)y_floor;
  fade far_x = fade_at(dx), far_y = fade_at(dy), near_x = opposite(far_x), near_y = opposite(far_y);
  *jet = (conic_jet){0};
  add_corner(seed, i, j, dx, dy, near_x, near_y, jet);
  add_corner(seed, i + 1, j, dx - 1.0, dy, far_x, near_y, jet);
  add_corner(seed, i, j + 1, dx, dy - 1.0, near_x, far_y, jet);
  add_corner(seed, i + 1, j + 1, dx - 1.0, dy - 1.0, far_x, far_y, jet);
}
