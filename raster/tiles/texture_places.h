/* Where a block's pixels see a texture. */
#ifndef CONIC_TEXTURE_PLACES_H
#define CONIC_TEXTURE_PLACES_H

#include <stdint.h>

#include "conic/texture.h"
#include "raster/tiles/band.h"

/* As conic_texture_sample takes them, by the order of a block's pixels. */
typedef struct conic_texture_places {
  float uv[2][CONIC_BLOCK_PIXELS], along[2][CONIC_BLOCK_PIXELS], across[2][CONIC_BLOCK_PIXELS];
} conic_texture_places;

/* `at_places` in plain C. */
void conic_texture_at_places(const conic_texture *texture, const conic_texture_places *places, uint32_t pixels,
                             float color[3][CONIC_BLOCK_PIXELS]);

#endif
