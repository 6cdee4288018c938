/* Textures a block at a time, a pixel a lane. */

/* The texels that the lanes name. */
static void fetch_texels(const conic_texel *texels, index_lanes which, lanes color[3]) {
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    float4 texel = vload4(((const uint *)&which)[lane], texels);
    ((float *)&color[0])[lane] = texel.x;
    ((float *)&color[1])[lane] = texel.y;
    ((float *)&color[2])[lane] = texel.z;
  }
}

#include "raster/triangles/texture_filter_body.h"

/* Each pixel on its own level: nearly always they are all on one. */
static void lanes_filter_levels(const texture_part *p, int16 levels, int16 mask, lanes color[3]) {
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    int i_level = ((const int *)&levels)[lane];
    if (!((const int *)&mask)[lane])
      continue;
    int16 same = mask & (levels == i_level);
    filter_level(p, i_level, same, color);
    mask &= ~same;
  }
}

/* The texture's colours where the mask holds. */
static void lanes_sample_texture(const conic_texture *texture, const lanes uv[2], const lanes along[2],
                                 const lanes across[2], int16 mask, lanes color[3]) {
  lanes coarse[3] = {0.0f, 0.0f, 0.0f}, beyond;
  texture_part p;
  begin_part(texture, uv, along, across, &p);
  int16 levels = ints_of_indices(levels_of(&p, &beyond));
  lanes_filter_levels(&p, levels, mask, color);
  lanes_filter_levels(&p, levels + 1, mask & (beyond > 0.0f), coarse);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = beyond > 0.0f ? color[channel] + beyond * (coarse[channel] - color[channel]) : color[channel];
}
