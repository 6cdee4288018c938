/* What a tile begins with, and how it comes to the picture. C and OpenCL C share this text. */
#pragma once

#include <string.h>

#include "gaussians/draw/gaussian_tile.h"

/* The picture: conic_gaussian_planes in a device's memory, or here. */
typedef struct conic_gaussian_target {
  int32_t width, height;
  float background[3];
  CONIC_STORED float *rgb, *transparency, *z, *median_z, *inverse_z, *normal;
  CONIC_STORED uint32_t *count, *id, *last;
} conic_gaussian_target;

static inline void conic_gaussian_tile_begin(conic_gaussian_tile *tile, int x, int y) {
  memset(tile, 0, sizeof *tile);
  for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++) {
    tile->T[at] = 1.0f;
    tile->id[at] = tile->last[at] = CONIC_NO_ID;
  }
  tile->x = x;
  tile->y = y;
}

static inline void conic_gaussian_put_number(CONIC_STORED float *plane, size_t pixel, float value) {
  if (plane)
    plane[pixel] = value;
}

static inline void conic_gaussian_put_word(CONIC_STORED uint32_t *plane, size_t pixel, uint32_t value) {
  if (plane)
    plane[pixel] = value;
}

static inline void conic_gaussian_put_pixel(const conic_gaussian_target *to, const conic_gaussian_tile *tile, size_t at,
                                            size_t pixel) {
  const float T = tile->T[at];
  conic_gaussian_put_number(to->transparency, pixel, T);
  conic_gaussian_put_number(to->z, pixel, tile->sum[at] > 0.0f ? tile->sum_of_z[at] / tile->sum[at] : 0.0f);
  conic_gaussian_put_number(to->median_z, pixel, tile->median_z[at]);
  conic_gaussian_put_number(to->inverse_z, pixel, tile->inverse_z[at]);
  conic_gaussian_put_word(to->count, pixel, tile->count[at]);
  conic_gaussian_put_word(to->id, pixel, tile->id[at]);
  conic_gaussian_put_word(to->last, pixel, tile->last[at]);
  for (size_t c = 0; c < 3; c++) {
    conic_gaussian_put_number(to->rgb, 3 * pixel + c, tile->rgb[c][at] + T * to->background[c]);
    conic_gaussian_put_number(to->normal, 3 * pixel + c, tile->normal[c][at]);
  }
}

static inline void conic_gaussian_tile_end(const conic_gaussian_target *to, const conic_gaussian_tile *tile) {
  for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++) {
    int x = tile->x + conic_gaussian_column(at), y = tile->y + conic_gaussian_row(at);
    if (x < to->width && y < to->height)
      conic_gaussian_put_pixel(to, tile, at, (size_t)y * (size_t)to->width + (size_t)x);
  }
}
