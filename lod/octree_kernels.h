/* The loops that take the time of building, as the instruction sets have them: all give the same. */
#ifndef LOD_OCTREE_KERNELS_H
#define LOD_OCTREE_KERNELS_H

#include "lod/octree_cover.h"
#include "lod/octree_fit.h"

/* Which of the leaves first … first + CONIC_INSIDE_BATCH - 1 surely do not widen the reach, bit by bit. */
enum { CONIC_INSIDE_BATCH = 8 };
typedef unsigned conic_inside_function(const conic_splats *leaves, size_t first, double cutoff,
                                       const conic_node_frame *frame, const conic_leaf_reach *reach);

typedef struct conic_octree_kernels {
  conic_cover_function *cover;
  conic_inside_function *find_inside;
} conic_octree_kernels;

extern conic_cover_function conic_cover_baseline, conic_cover_avx2;
extern conic_inside_function conic_find_inside_baseline, conic_find_inside_avx2;

/* The fastest that this machine has. */
conic_octree_kernels conic_octree_kernels_choose(void);

#endif
