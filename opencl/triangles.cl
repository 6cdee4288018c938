/* Triangles, from records in the tiles' lists to pixels: a program of its own, built where the first is drawn, since it
 * needs double precision. What a triangle covers and looks like is plain C's own text. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#include "opencl/shared.h"

#include "opencl/layout.h"
#include "raster/tiles/shade.c"

#include "opencl/triangle_set.cl"

#include "core/image/texture_sample.c"
#include "raster/triangles/triangle_look.c"
#include "raster/triangles/triangle_pixel.h"

/* Where the nearest triangles are looked for. */
#define TRIANGLE_LISTS                                                                                                 \
  __constant conic_device_frame *frame_constants, __global const conic_triangle_record *records,                       \
      __global const conic_device_triangle_chunk *chunks, __global const uint *tile_begin,                             \
      __global const uint *entries, __global const float *columns, __global const float *rows

/* What the entries of a tile in a chunk's lists are: begin … end - 1. */
static void triangles_of_tile(const conic_device_frame *frame, uint i_chunk, uint tile,
                              __global const conic_device_triangle_chunk *chunks, __global const uint *tile_begin,
                              ulong *begin, ulong *end) {
  ulong n_tiles = (ulong)frame->n_tiles_x * (ulong)frame->n_tiles_y, at = i_chunk * (n_tiles + 1) + tile;
  *begin = chunks[i_chunk].first_entry + tile_begin[at];
  *end = chunks[i_chunk].first_entry + tile_begin[at + 1];
}

/* What the nearest triangles look like: the frame's records, and the set. */
#define TRIANGLE_SET                                                                                                   \
  __constant conic_view *frame_view, __constant conic_device_frame *frame_constants,                                   \
      __global const conic_triangle_record *records, __global const conic_triangle_piece *pieces,                      \
      __global const uint(*corners)[3], __global const uint(*normal_corners)[3],                                       \
      __global const uint(*texture_corners)[3], __global const uint *material, __global const float *px,               \
      __global const float *py, __global const float *pz, __global const float *red, __global const float *green,      \
      __global const float *blue, __global const float *nx, __global const float *ny, __global const float *nz,        \
      __global const float *u, __global const float *v, __global const conic_device_material *materials

#define TRIANGLE_SET_TAKEN                                                                                             \
  conic_view view = *frame_view;                                                                                       \
  conic_device_frame frame = *frame_constants;                                                                         \
  const conic_triangles set = {corners,      normal_corners, texture_corners,   {px, py, pz}, {red, green, blue},      \
                               {nx, ny, nz}, {u, v},         frame.n_materials, materials,    material};               \
  const conic_triangle_frame triangles = {&view, &set, records, pieces};

#include "opencl/gather_resolve.cl"
#include "opencl/gather_triangles.cl"

#include "opencl/lanes_tile.cl"

#include "opencl/lanes_resolve.cl"

#include "opencl/lanes_texture.cl"
#include "opencl/lanes_triangles.cl"
