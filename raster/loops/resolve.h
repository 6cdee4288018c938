/* Pass 3: normalising, shading, and writing a band's pixels to the planes that the image has. */
#pragma once

#include "raster/tiles/finish.h"

/* `resolve` in plain C: everything, a pixel at a time. */
void conic_band_resolve(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, conic_image *image);

/* A band's finished pixels, row by row as they go to the image. */
typedef struct conic_band_rows {
  float rgba[CONIC_BLOCK_EDGE][4 * CONIC_GREATEST_TILE];
  float normal[CONIC_BLOCK_EDGE][3 * CONIC_GREATEST_TILE], albedo[CONIC_BLOCK_EDGE][3 * CONIC_GREATEST_TILE];
  float weight[CONIC_BLOCK_EDGE][CONIC_GREATEST_TILE], z[CONIC_BLOCK_EDGE][CONIC_GREATEST_TILE];
} conic_band_rows;

/* The planes that name splats: count and id. */
void conic_band_resolve_indices(const conic_band *band, conic_image *image);
