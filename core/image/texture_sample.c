/* Elliptical filtering of a texture (docs/reference/picture.md, Textures): a Gaussian over a footprint, on two levels
 * of the pyramid, with a bounded number of texels. */
#include <math.h>

#include "core/image/texture_filter.h"
#include "core/image/texture_levels.h"
#include "core/splats/kernel.h"

/* A footprint's variance in texels². */
typedef struct footprint {
  float xx, xy, yy;
} footprint;

static float finite_or_zero(float value) {
  return value >= -CONIC_TEXTURE_FARTHEST && value <= CONIC_TEXTURE_FARTHEST ? value : 0.0f;
}

/* One component of a footprint's side, in texels. */
static float side_of(float value, int size) {
  float side = finite_or_zero(value) * (float)size;
  side = side > -CONIC_TEXTURE_WIDEST ? side : -CONIC_TEXTURE_WIDEST;
  return side < CONIC_TEXTURE_WIDEST ? side : CONIC_TEXTURE_WIDEST;
}

/* The place within the picture, in [0, 1). */
static float place_in(float value, conic_texture_wrap wrap) {
  value = finite_or_zero(value);
  if (wrap == CONIC_WRAP_REPEAT)
    return value - floorf(value);
  return value > 0.0f ? value < 1.0f ? value : 1.0f : 0.0f;
}

static int wrapped(int i, int n, conic_texture_wrap wrap) {
  if (i >= 0 && i < n)
    return i;
  if (wrap == CONIC_WRAP_CLAMP)
    return i < 0 ? 0 : n - 1;
  i %= n;
  return i < 0 ? i + n : i;
}

/* The eigenvalues of a variance. */
static void extents_of(const footprint *v, float *greater, float *smaller) {
  float mean = 0.5f * (v->xx + v->yy), half = 0.5f * (v->xx - v->yy);
  float spread = sqrtf(half * half + v->xy * v->xy);
  *greater = mean + spread;
  *smaller = mean > spread ? mean - spread : 0.0f;
}

/* The pixel's variance in texels of the first level, widened where it is too narrow. */
static footprint footprint_of(const conic_texture_level *level, const float along[2], const float across[2]) {
  float ax = side_of(along[0], level->width), ay = side_of(along[1], level->height), greater, smaller;
  float bx = side_of(across[0], level->width), by = side_of(across[1], level->height);
  footprint v = {CONIC_FILTER_VARIANCE * (ax * ax + bx * bx), CONIC_FILTER_VARIANCE * (ax * ay + bx * by),
                 CONIC_FILTER_VARIANCE * (ay * ay + by * by)};
  v.xy = -v.xy; /* rows go down, v goes up */
  extents_of(&v, &greater, &smaller);
  float least = greater / (CONIC_FILTER_RATIO * CONIC_FILTER_RATIO);
  if (smaller < least) {
    v.xx += least - smaller;
    v.yy += least - smaller;
  }
  return v;
}

/* Filters on one level. Where the picture is one texel wide, all texels along that side are the same, and a shrinking
 * footprint does no harm. */
static void filter(const conic_texture *texture, int i_level, const float place[2], const footprint *of_pixel,
                   float color[4]) {
  const conic_texture_level *level = &texture->levels[i_level];
  if (i_level == texture->n_levels - 1) {
    for (int channel = 0; channel < 4; channel++)
      color[channel] = conic_texels_of(level)[channel];
    return;
  }
  float shrunk = 1.0f / (float)(1 << i_level), scale = shrunk * shrunk;
  float xx = of_pixel->xx * scale + CONIC_FILTER_VARIANCE, xy = of_pixel->xy * scale;
  float yy = of_pixel->yy * scale + CONIC_FILTER_VARIANCE;
  float x = place[0] * (float)level->width - 0.5f, y = (1.0f - place[1]) * (float)level->height - 0.5f;
  float determinant = xx * yy - xy * xy, inverse = 1.0f / determinant;
  float reach_x = sqrtf(CONIC_FILTER_SUPPORT * xx), reach_y = sqrtf(CONIC_FILTER_SUPPORT * yy);
  float sum[4] = {0.0f, 0.0f, 0.0f, 0.0f}, weights = 0.0f;
  int x_begin = (int)floorf(x - reach_x) + 1, x_end = (int)floorf(x + reach_x) + 1;
  int y_begin = (int)floorf(y - reach_y) + 1, y_end = (int)floorf(y + reach_y) + 1;
  for (int j = y_begin; j < y_end; j++) {
    const conic_texel *row =
        conic_texels_of(level) + 4 * (size_t)wrapped(j, level->height, texture->wrap) * (size_t)level->width;
    float dy = (float)j - y;
    for (int i = x_begin; i < x_end; i++) {
      float dx = (float)i - x;
      float q = ((yy * dx - 2.0f * xy * dy) * dx + xx * dy * dy) * inverse;
      if (!(q < CONIC_FILTER_SUPPORT))
        continue;
      float weight = conic_exp_negative(-0.5f * q) - CONIC_FILTER_END;
      const conic_texel *texel = row + 4 * (size_t)wrapped(i, level->width, texture->wrap);
      for (int channel = 0; channel < 4; channel++)
        sum[channel] += weight * texel[channel];
      weights += weight;
    }
  }
  for (int channel = 0; channel < 4; channel++)
    color[channel] = sum[channel] / weights;
}

/* The level on which the footprint is wide enough, and how far it is to the next one. */
static int level_of(const conic_texture *texture, const footprint *v, float *beyond) {
  float greater, smaller;
  extents_of(v, &greater, &smaller);
  float width = 2.0f * sqrtf(smaller); /* the ellipse's half width, at two standard deviations */
  int i = 0;
  for (; width >= 2.0f * CONIC_FILTER_WIDTH && i < texture->n_levels - 1; i++)
    width *= 0.5f;
  *beyond = i == texture->n_levels - 1 || width < CONIC_FILTER_WIDTH
                ? 0.0f
                : (width - CONIC_FILTER_WIDTH) / CONIC_FILTER_WIDTH;
  return i;
}

void conic_texture_sample_channels(const conic_texture *texture, const float uv[2], const float along[2],
                                   const float across[2], float color[4]) {
  float place[2] = {place_in(uv[0], texture->wrap), place_in(uv[1], texture->wrap)}, beyond, coarse[4];
  footprint v = footprint_of(&texture->levels[0], along, across);
  int i = level_of(texture, &v, &beyond);
  filter(texture, i, place, &v, color);
  if (!(beyond > 0.0f))
    return;
  filter(texture, i + 1, place, &v, coarse);
  for (int channel = 0; channel < 4; channel++)
    color[channel] += beyond * (coarse[channel] - color[channel]);
}

void conic_texture_sample(const conic_texture *texture, const float uv[2], const float along[2], const float across[2],
                          float color[3]) {
  float channels[4];
  conic_texture_sample_channels(texture, uv, along, across, channels);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = channels[channel];
}
