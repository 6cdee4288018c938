/* The levels of a file while it is built: clouds come in their order, and four at a time get one above them. */
#pragma once

#include "lod/blends/levels_format.h"

/* A cloud, whose arrays are owned. */
typedef struct conic_levels_cloud {
  size_t n;
  float *rows;
  conic_blend_parts *parts;
  uint32_t *numbers; /* of Gaussians as they came; of what is merged, which children have parts */
} conic_levels_cloud;

typedef struct conic_levels_tree conic_levels_tree;

/* The header's degree and cloud size are to be there; `to` is written from its header's end on. `n_at_once` clouds are
 * made at a time. Errors: MEMORY, UNSUPPORTED. */
conic_status conic_levels_tree_create(conic_context *context, const conic_levels_header *header, size_t n_at_once,
                                      FILE *to, const char *path, conic_levels_tree **tree);
void conic_levels_tree_destroy(conic_levels_tree *tree);

/* Room for n Gaussians. Errors: MEMORY. */
conic_status conic_levels_cloud_allocate(conic_context *context, size_t n, size_t n_row, conic_levels_cloud *cloud);

/* Takes a cloud of Gaussians as they came over, on failure too. Errors: MEMORY, IO, INPUT. */
conic_status conic_levels_tree_add(conic_levels_tree *tree, conic_levels_cloud *cloud);

/* Makes what is above, and writes the index; fills in the rest of the header. Errors: MEMORY, IO, INPUT. */
conic_status conic_levels_tree_end(conic_levels_tree *tree, conic_levels_header *header);
