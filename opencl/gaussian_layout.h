/* What the host tells a device about a picture of Gaussians: read by both compilers. Footprints, rays and hits are the
 * records of gaussians/draw, whose layouts are the same in both. */
#pragma once

#include "gaussians/draw/gaussian_target.h"

/* Of CONIC_SHAPE_RAY, the bytes for an entry of a tile: 12 a pixel; three vectors and a word. */
enum { CONIC_PIXELS_ROOM = 12 * 256, CONIC_TILES_ROOM = 3 * 64 + 4 };

/* Some of its tiles, one after the other, whose entries alone are there. */
typedef struct conic_device_gaussians {
  conic_gaussian_rules rules;
  int32_t width, height, n_tiles_x, wants;
  uint32_t first_tile, n_tiles;
  uint64_t first_entry;
  float background[3];
} conic_device_gaussians;
