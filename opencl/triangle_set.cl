/* A frame's triangles as a device has them, under the names by which plain C knows them. All that a set holds is in
 * global memory; where plain C keeps a pointer there, a distance in bytes stands for it. */
#define CONIC_STORED __global

#define conic_texture conic_texture_of_host
#define conic_texture_sample conic_texture_sample_of_host
#include "conic/texture.h"
#undef conic_texture
#undef conic_texture_sample

/* core/image/texture_levels.h */
#define CONIC_TEXTURE_LEVELS_H
typedef __global conic_device_texture conic_texture;
typedef __global conic_device_texture_level conic_texture_level;
typedef __global float conic_texel;

static const conic_texel *conic_texels_of(const conic_texture_level *level) {
  return (const conic_texel *)((__global const char *)level + level->texels);
}

/* conic/triangles.h */
#define CONIC_TRIANGLES_H
typedef struct conic_triangles {
  __global const uint (*corners)[3], (*normal_corners)[3], (*texture_corners)[3];
  __global const float *position[3], *color[3], *normal[3], *texture_coordinate[2];
  uint n_materials;
  __global const conic_device_material *materials;
  __global const uint *material;
} conic_triangles;

typedef conic_device_material conic_material;

/* raster/triangles/triangle_frame.h */
#define CONIC_TRIANGLE_FRAME_H
#include "raster/triangles/triangle.h"

typedef struct conic_triangle_frame {
  const conic_view *view;
  const conic_triangles *triangles;
  __global const conic_triangle_record *records;
  __global const conic_triangle_piece *pieces;
} conic_triangle_frame;

static const conic_texture *conic_material_texture(__global const conic_material *material) {
  return material->has_texture ? (const conic_texture *)((__global const char *)material + material->texture) : 0;
}
