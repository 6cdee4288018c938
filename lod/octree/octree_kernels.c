#include "lod/octree/octree_kernels.h"

CONIC_DEFINE_KERNELS(conic_octree_kernels)
