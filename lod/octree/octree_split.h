/* The structure of a point-octree: space split at the mean of each node's points (Confetti §3.2). */
#ifndef CONIC_OCTREE_SPLIT_H
#define CONIC_OCTREE_SPLIT_H

#include <stdint.h>

#include "conic/context.h"

typedef struct conic_split {
  float *position[3]; /* of n points; brought into the order of the leaves */
  uint32_t *index;    /* goes along */
  size_t n;
  uint8_t *children; /* result: of each inner node in preorder, n_direct | n_inner << 4; room for n */
  size_t n_nodes;
} conic_split;

/* Errors: MEMORY, CANCELLED. */
conic_status conic_octree_split(conic_context *context, conic_split *split);

#endif
