/* The octree's loops in lanes; included by one file an instruction set. */
#include "lod/octree/octree_cover_body.h"
#include "lod/octree/octree_measure_body.h"
#include "lod/octree/octree_put_body.h"
#include "lod/octree/octree_reach_body.h"

CONIC_FILL_LOOPS(conic_octree_loops) {
  *loops = (conic_octree_loops){find_cover, find_near, add_reach, choose_ratio, measure, put};
}
