/* Where everything but the chunks is in a .chy file. In the memory of a hybrid model it lies in the same way. */
#pragma once

#include "core/files/file_body.h"
#include "lod/hybrid/model/hybrid_model.h"

enum { CONIC_CHY_VERSION = 5 };

/* A material as the file has it: its texture's texels are codes[3 · first_texel …], row by row from the top; sRGB. */
typedef struct conic_chy_material {
  float color[3];
  uint32_t width, height; /* 0: no texture */
  uint32_t wrap;
  uint64_t first_texel;
} conic_chy_material;

/* The arrays by number; texels may be none. */
enum {
  CONIC_CHY_NODES,
  CONIC_CHY_CLUSTERS,
  CONIC_CHY_LEVELS,
  CONIC_CHY_MATERIAL_LIST,
  CONIC_CHY_TEXELS,
  CONIC_CHY_N_ARRAYS
};

/* The layout of the arrays; the chunks lie behind them. Counts are below 2³² each. */
conic_file_layout conic_chy_lay_out(const conic_hybrid *hybrid);

/* Points the model's arrays into `bytes`. */
void conic_chy_attach(unsigned char *bytes, conic_hybrid *hybrid);

/* Takes the arrays, behind the header in `index`, of a file of n_bytes, and checks all but the chunks. Errors: INPUT,
 * MEMORY. */
conic_status conic_chy_take_index(conic_hybrid *hybrid, const char *path, uint64_t n_bytes, unsigned char *index);

/* What .chy files are, for reading and writing their header. */
extern const conic_file_kind conic_chy_kind;

/* Makes the materials and their textures of what is attached. Errors: MEMORY. */
conic_status conic_chy_make_materials(conic_hybrid *hybrid);
