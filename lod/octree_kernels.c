#include "lod/octree_kernels.h"

conic_octree_kernels conic_octree_kernels_choose(void) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2"))
    return (conic_octree_kernels){conic_cover_avx2, conic_find_inside_avx2};
#endif
  return (conic_octree_kernels){conic_cover_baseline, conic_find_inside_baseline};
}
