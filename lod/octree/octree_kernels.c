#include "lod/octree/octree_kernels.h"

#include "core/lanes/processor.h"

conic_octree_kernels conic_octree_kernels_choose(void) {
#if defined(__x86_64__)
  if (conic_has_avx512())
    return (conic_octree_kernels){conic_cover_avx512,        conic_find_near_avx512, conic_add_reach_avx512,
                                  conic_choose_ratio_avx512, conic_measure_avx512,   conic_put_avx512};
  if (conic_has_avx2())
    return (conic_octree_kernels){conic_cover_avx2,        conic_find_near_avx2, conic_add_reach_avx2,
                                  conic_choose_ratio_avx2, conic_measure_avx2,   conic_put_avx2};
#endif
  return (conic_octree_kernels){conic_cover_baseline,        conic_find_near_baseline, conic_add_reach_baseline,
                                conic_choose_ratio_baseline, conic_measure_baseline,   conic_put_baseline};
}
