/* The leaves of a quantised octree: 12 bytes each, 3 more with colours, 1 more with opacities, and 24 for each block of
 * 64 leaves. A block's leaves share a box in which their positions are counted. Neighbours in the order of the tree are
 * neighbours in space, so the boxes are small. */
#ifndef CONIC_LEAF_CODE_H
#define CONIC_LEAF_CODE_H

#include "conic/splats.h"
#include "lod/octree/octree_code.h"

enum { CONIC_LEAF_BLOCK = 64, CONIC_LEAF_BLOCK_BYTES = 24 };

/* The bytes of one leaf, and of all: the blocks' first, then the leaves'. */
size_t conic_leaf_code_bytes(int has_colors, int has_opacities);
size_t conic_leaf_codes_bytes(size_t n_leaves, int has_colors, int has_opacities);

/* Encodes all leaves in the arrays. */
void conic_leaf_encode(conic_context *context, const conic_code_scale *scale, const conic_splats *leaves,
                       unsigned char *codes);
/* Fills the arrays with what the codes give. */
void conic_leaf_decode(conic_context *context, const conic_code_scale *scale, const unsigned char *codes,
                       conic_splats *leaves);

#endif
