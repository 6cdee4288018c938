/* The octree's inside, shared by its parts. */
#pragma once

#include "conic/octree.h"
#include "core/files/mapping.h"
#include "lod/octree/octree_code.h"

#define CONIC_NO_CLIP UINT32_MAX

/* No inner node is deeper; splitting at the mean gives up well before (lod/octree/octree_split.c). */
enum { CONIC_OCTREE_DEPTH = 128 };

/* A quantised octree leaves out what cannot be drawn. That may be at most so many times what can, since otherwise a
 * small file would ask for much memory. */
enum { CONIC_OCTREE_MOST_LEFT_OUT = 15 };

/* Subtrees with no more inner nodes are walked by one thread. */
enum { CONIC_OCTREE_BLOCK = 1024 };

/* What is drawn of an inner node or a leaf: a line of the cache. */
typedef struct conic_drawn_node {
  float position[3], tangent_u[3], tangent_v[3], color[3], opacity;
  uint32_t id; /* of a leaf, its index in the input; of a node, n_points + its number */
  float dot;   /* 1 for a leaf that is turned to each camera */
  float unused;
} conic_drawn_node;

/* Measuring goes by groups of so many nodes; their arrays have room for a last one. */
enum { CONIC_OCTREE_GROUP = 16 };

/* Inner nodes are numbered in preorder, so that a subtree is a range. The leaves of a node are a range too: at first
 * its direct ones, then those of each inner child in turn. */
struct conic_octree {
  conic_context *context;

  uint32_t version, flags; /* of the file */
  uint64_t n_points, n_leaves, n_nodes, n_clips;
  conic_splats leaves;     /* n_points of them: those of the hierarchy, then those that cannot be drawn */
  uint32_t *index;         /* of each in the input */
  conic_clip *clips;       /* of the input, by index in it; the leaves' own are null */
  uint32_t *clip_of_point; /* record of each point of the input, or CONIC_NO_CLIP; null where there are no clip lines */
  uint8_t *codes;          /* CONIC_NODE_BYTES a node */

  /* What the codes give, once it is asked for. */
  conic_drawn_node *drawn;
  conic_drawn_node *drawn_leaves; /* the n_leaves again, only for choosing, which takes one here, one there */
  float *center[3], *radius, *error, *normal[3], *cone; /* apart from the rest, since choosing looks at them */
  float *excess;                                        /* the square of the error over what its size asks for */
  uint32_t *end;                                        /* the node after the subtree */
  uint32_t *first_leaf;                                 /* n_nodes + 1 */
  int n_levels;

  conic_code_scale scale;
  int is_quantized;
  int has_color_codes;   /* every leaf's colour is that of an 8-bit sRGB code */
  float low[3], high[3]; /* of the finite centres, from the origin */
  double splat_length, position_error;
  float cutoff;                    /* the scale's, as the file has it */
  uint64_t body_sum;               /* of the file, over the arrays' sums */
  const unsigned char *leaf_codes; /* a quantised octree's leaves as its file has them */

  /* Where all that lies: in memory of its own, or else in the file's; then these are null. */
  conic_splats owned;
  uint32_t *owned_index;
  conic_clip *owned_clips;
  unsigned char *owned_codes, *owned_leaf_codes;
  conic_mapping mapping;
};

/* Fills in what the codes give, from the leaves, where that has not been done. Building and writing do without, and
 * save two fifths of the memory. Errors: MEMORY. */
conic_status conic_octree_decode(conic_octree *octree);

/* The same, and the leaves once more. Errors: MEMORY. */
conic_status conic_octree_decode_all(conic_octree *octree);

/* What conic_default_near gives for the splats that it was built from. */
double conic_octree_near(const conic_octree *octree);

/* Finds has_color_codes. Errors: MEMORY. */
conic_status conic_octree_check_colors(conic_octree *octree);

/* Finds the clip lines of each point. Errors: MEMORY. */
conic_status conic_octree_index_clips(conic_octree *octree);

/* Leaves the clip lines of leaves that were rounded where they lay. */
void conic_octree_move_clips(conic_octree *octree, const conic_splats *before, const conic_splats *after);

/* How far the outline of a leaf that is a dot reaches on the screen, as a length in space; 0 where it is none. */
double conic_octree_dot_radius(const conic_octree *octree, size_t i_leaf);

/* The clip lines of leaf i, or null. */
static inline const conic_clip *conic_octree_clip(const conic_octree *octree, size_t i_leaf) {
  uint32_t i = octree->clip_of_point ? octree->clip_of_point[octree->index[i_leaf]] : CONIC_NO_CLIP;
  return i == CONIC_NO_CLIP ? NULL : &octree->clips[i];
}

/* The size of the file that holds it. */
uint64_t conic_octree_file_bytes(const conic_octree *octree);

/* Makes the sums in a file's bytes right, where all arrays that its header tells of are there. Tests and fuzzing would
 * otherwise see no further than the sums. */
void conic_octree_mend(unsigned char *bytes, size_t n_bytes);

/* Finds `end` and `first_leaf` from the codes. *wrong is what is wrong with their structure, or null. Errors: MEMORY.
 */
conic_status conic_octree_lay_out(conic_octree *octree, const char **wrong);

static inline int conic_octree_n_direct(const conic_octree *octree, size_t i_node) {
  return conic_code_n_direct(octree->codes + i_node * CONIC_NODE_BYTES);
}

/* --- structure --- */

typedef struct conic_split {
  float *position[3]; /* of n points; brought into the order of the leaves */
  uint32_t *index;    /* goes along */
  size_t n;
  uint8_t *children; /* result: of each inner node in preorder, n_direct | n_inner << 4; room for n */
  size_t n_nodes;
} conic_split;

/* Errors: MEMORY, CANCELLED. */
conic_status conic_octree_split(conic_context *context, conic_split *split);
