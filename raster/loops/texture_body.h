/* The slot `texture` in lanes. Included by raster_loops_body.h. */
#include "core/image/texture_levels.h"
#include "core/lanes/lanes_store.h"
#include "raster/tiles/tile_loops.h"

/* The texels that the lanes name. */
CONIC_INLINE void fetch_texels(const conic_texel *texels, index_lanes which, lanes color[3]) {
  uint32_t at[CONIC_LANES];
  lanes_store_indices(at, which);
#if defined(__AVX512F__)
  lanes quads[4];
  __m512 rows[4];
  for (int row = 0; row < 4; row++) {
    __m512 four = _mm512_castps128_ps512(_mm_loadu_ps(texels + (size_t)at[row] * 4));
    four = _mm512_insertf32x4(four, _mm_loadu_ps(texels + (size_t)at[4 + row] * 4), 1);
    four = _mm512_insertf32x4(four, _mm_loadu_ps(texels + (size_t)at[8 + row] * 4), 2);
    quads[row] = (lanes)_mm512_insertf32x4(four, _mm_loadu_ps(texels + (size_t)at[12 + row] * 4), 3);
  }
  lanes_pixels(quads, rows);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = (lanes)rows[channel];
#else
  for (int column = 0; column < CONIC_LANES / 4; column++) {
    quad rows[4];
    for (int row = 0; row < 4; row++)
      memcpy(&rows[row], texels + (size_t)at[4 * column + row] * 4, sizeof rows[row]);
    quad_transpose(rows);
    for (int channel = 0; channel < 3; channel++)
      memcpy((char *)&color[channel] + sizeof(quad) * (size_t)column, &rows[channel], sizeof rows[channel]);
  }
#endif
}

#include "raster/triangles/texture_filter_body.h"

/* Each pixel on its own level: nearly always they are all on one. */
CONIC_INLINE void filter_levels(const texture_part *p, index_lanes levels, unsigned bits, lanes color[3]) {
  uint32_t level[CONIC_LANES];
  lanes_store_indices(level, levels);
  while (bits) {
    uint32_t i_level = level[__builtin_ctz(bits)];
    unsigned same = bits & ~lanes_bits(lanes_has_bits(levels ^ i_level, ~0u));
    filter_level(p, (int)i_level, lanes_mask_of(same), color);
    bits &= ~same;
  }
}

static void texture_at_places(const conic_texture *texture, const conic_texture_places *places, uint32_t pixels,
                              float color[3][CONIC_BLOCK_PIXELS]) {
  for (int at = 0; at < CONIC_BLOCK_PIXELS; at += CONIC_LANES) {
    unsigned bits = pixels >> at & ((1u << CONIC_LANES) - 1);
    lanes fine[3] = {lanes_of(0.0f), lanes_of(0.0f), lanes_of(0.0f)}, coarse[3], beyond;
    texture_part p;
    if (!bits)
      continue;
    lanes uv[2], along[2], across[2];
    for (int axis = 0; axis < 2; axis++) {
      uv[axis] = lanes_load(places->uv[axis] + at);
      along[axis] = lanes_load(places->along[axis] + at);
      across[axis] = lanes_load(places->across[axis] + at);
    }
    begin_part(texture, uv, along, across, &p);
    index_lanes levels = levels_of(&p, &beyond);
    lanes_mask is_between = lanes_less(lanes_of(0.0f), beyond);
    filter_levels(&p, levels, bits, fine);
    memcpy(coarse, fine, sizeof coarse);
    filter_levels(&p, levels + 1, bits & lanes_bits(is_between), coarse);
    for (int channel = 0; channel < 3; channel++) {
      lanes mixed = fine[channel] + beyond * (coarse[channel] - fine[channel]);
      lanes_replace(color[channel] + at, lanes_mask_of(bits), lanes_select(is_between, mixed, fine[channel]));
    }
  }
}
