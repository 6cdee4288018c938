/* The octree's kernels in lanes; included by one file an instruction set. */
#include "lod/octree/octree_cover_body.h"
#include "lod/octree/octree_measure_body.h"
#include "lod/octree/octree_put_body.h"
#include "lod/octree/octree_reach_body.h"

CONIC_FILL_KERNELS(conic_octree_kernels) {
  *kernels = (conic_octree_kernels){find_cover, find_near, add_reach, choose_ratio, measure, put};
}
