#include "lod/octree/octree_loops.h"

CONIC_DEFINE_LOOPS(conic_octree_loops)
