/* The octree's kernels in lanes; included by one file an instruction set. */
#include "lod/octree/octree_cover_body.h"
#include "lod/octree/octree_measure_body.h"
#include "lod/octree/octree_put_body.h"
#include "lod/octree/octree_reach_body.h"

void CONIC_KERNELS_OF_THIS_ISA(conic_octree_kernels)(conic_octree_kernels *kernels) {
  *kernels = (conic_octree_kernels){find_cover, find_near, add_reach, choose_ratio, measure, put};
}
