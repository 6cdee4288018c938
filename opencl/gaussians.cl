/* A tile of Gaussians on a device: what lies where, and its list, for the entries of gaussian_tiles.cl and
 * gaussian_pixels.cl. How Gaussians meet pixels, and are composited, is plain C's own text. */
#define double ulong /* of rules and scenes: never looked at */
#define CONIC_STORED __global
#include "opencl/shared.h"

#define CONIC_INSTRUCTION_SETS_H
#include "opencl/gaussian_layout.h"

#include "gaussians/draw/gaussian_tile.c"

#define GAUSSIAN_ARGUMENTS                                                                                             \
  __constant conic_device_gaussians *given, __global const ulong *tile_begin, __global const uint *entries,            \
      __global const conic_gaussian_footprint *footprints, __global const conic_gaussian_ray *rays,                    \
      __global const float(*normals)[3], __global uchar *room, __global float *rgb,                       \
      __global float *transparency, __global float *z, __global float *median_z, __global float *inverse_z,            \
      __global float *normal, __global uint *count, __global uint *id, __global uint *last

#define GAUSSIAN_TARGET                                                                                                \
  {                                                                                                                    \
    picture.width, picture.height, {picture.background[0], picture.background[1], picture.background[2]}, rgb,         \
        transparency, z, median_z, inverse_z, normal, count, id, last                                                  \
  }

/* The list of a tile. */
#define GAUSSIAN_LIST(tile)                                                                                            \
  {                                                                                                                    \
    &picture.rules, footprints, rays, normals, picture.wants, entries + (tile_begin[tile] - picture.first_entry),  \
        tile_begin[tile + 1] - tile_begin[tile], 0                                                                     \
  }
