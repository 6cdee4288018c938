/* Where everything is in a .chy file, and in the memory of a hybrid model, which is the same. */
#ifndef CONIC_HYBRID_LAYOUT_H
#define CONIC_HYBRID_LAYOUT_H

#include "core/files/file_body.h"
#include "lod/hybrid/hybrid_model.h"

enum { CONIC_CHY_VERSION = 4 };

enum {
  CONIC_CHY_NORMALS = 1,
  CONIC_CHY_COLORS = 2,
  CONIC_CHY_TEXTURE_COORDINATES = 4,
  CONIC_CHY_MATERIALS = 8, /* each triangle names one */
  CONIC_CHY_ALL_FLAGS = 15
};

/* Each member is little-endian in the file, one after the other, after the 8 bytes that say what it is. */
typedef struct conic_chy_header {
  uint32_t version, flags;
  uint64_t n_vertices, n_triangles, n_listed, n_surfels, n_levels, n_clusters, n_nodes, n_materials, n_texels;
  double origin[3];
  float low[3], high[3];
  double splat_length;
  float cutoff;
  uint32_t zero;
  uint64_t body_sum; /* over the arrays' sums */
  uint64_t n_slots, n_borders;
} conic_chy_header;

/* A material as the file has it: its texture's texels are codes[3 · first_texel …], row by row from the top; sRGB. */
typedef struct conic_chy_material {
  float color[3];
  uint32_t width, height; /* 0: no texture */
  uint32_t wrap;
  uint64_t first_texel;
} conic_chy_material;

/* The arrays by number. */
enum {
  CONIC_CHY_NODES,
  CONIC_CHY_CLUSTERS,
  CONIC_CHY_LEVELS,
  CONIC_CHY_CORNERS,
  CONIC_CHY_LISTED,
  CONIC_CHY_MATERIAL_OF, /* empty without the flag, as all that may be absent */
  CONIC_CHY_MATERIAL_LIST,
  CONIC_CHY_TEXELS,
  CONIC_CHY_POSITION,
  CONIC_CHY_NORMAL = CONIC_CHY_POSITION + 3,
  CONIC_CHY_COLOR = CONIC_CHY_NORMAL + 3,
  CONIC_CHY_TEXTURE = CONIC_CHY_COLOR + 3,
  CONIC_CHY_SURFELS = CONIC_CHY_TEXTURE + 2,
  CONIC_CHY_SLOTS = CONIC_CHY_SURFELS + 12,
  CONIC_CHY_BORDERS,
  CONIC_CHY_N_ARRAYS
};

/* Counts are below 2³² each. */
conic_file_layout conic_chy_lay_out(const conic_chy_header *header);

/* Points the model's arrays into `bytes`, and takes the header's numbers. */
void conic_chy_attach(const conic_chy_header *header, unsigned char *bytes, conic_hybrid *hybrid);

/* Makes the materials and their textures of what is attached. Errors: MEMORY. */
conic_status conic_chy_make_materials(conic_hybrid *hybrid);

#endif
