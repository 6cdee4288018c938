#include "raster/tiles/texture_places.h"

void conic_texture_at_places(const conic_texture *texture, const conic_texture_places *places, uint32_t pixels,
                             float color[3][CONIC_BLOCK_PIXELS]) {
  for (uint32_t left = pixels; left; left &= left - 1) {
    int l = __builtin_ctz(left);
    const float uv[2] = {places->uv[0][l], places->uv[1][l]}, along[2] = {places->along[0][l], places->along[1][l]};
    const float across[2] = {places->across[0][l], places->across[1][l]};
    float texel[3];
    conic_texture_sample(texture, uv, along, across, texel);
    for (int channel = 0; channel < 3; channel++)
      color[channel][l] = texel[channel];
  }
}
