/* The loops that take the time of building and of choosing, as the instruction sets have them: all give the same. */
#ifndef CONIC_OCTREE_KERNELS_H
#define CONIC_OCTREE_KERNELS_H

#include "lod/octree/octree_cover.h"
#include "lod/octree/octree_fit.h"
#include "lod/octree/octree_view.h"

/* Puts the n chosen at `place` of a selection: leaves by their numbers, nodes with a bit more. With an eye, nodes are
 * turned towards it. */
#define CONIC_NODE_BIT (UINT32_C(1) << 31)
typedef void conic_put_function(const conic_octree *octree, const uint32_t *sources, size_t n, const float *eye,
                                const conic_splats *to, uint32_t *ids, size_t place);

typedef struct conic_octree_kernels {
  conic_cover_function *cover;
  conic_find_near_function *find_near;
  conic_add_reach_function *add_reach;
  conic_choose_ratio_function *choose_ratio;
  conic_measure_function *measure;
  conic_put_function *put;
} conic_octree_kernels;

extern conic_cover_function conic_cover_baseline, conic_cover_avx2, conic_cover_avx512;
extern conic_find_near_function conic_find_near_baseline, conic_find_near_avx2, conic_find_near_avx512;
extern conic_add_reach_function conic_add_reach_baseline, conic_add_reach_avx2, conic_add_reach_avx512;
extern conic_choose_ratio_function conic_choose_ratio_baseline, conic_choose_ratio_avx2, conic_choose_ratio_avx512;
extern conic_measure_function conic_measure_baseline, conic_measure_avx2, conic_measure_avx512;
extern conic_put_function conic_put_baseline, conic_put_avx2, conic_put_avx512;

/* The fastest that this machine has. */
conic_octree_kernels conic_octree_kernels_choose(void);

#endif
