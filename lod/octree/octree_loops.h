/* The loops that take the time of building and of choosing. */
#pragma once

#include "core/lanes/instruction_sets.h"
#include "lod/octree/octree_cover.h"
#include "lod/octree/octree_fit.h"
#include "lod/octree/octree_view.h"

/* Puts n sources at `place` of a selection: leaves by their numbers, nodes by theirs with NODE_BIT. With an eye, nodes
 * are turned towards it. */
#define CONIC_NODE_BIT (UINT32_C(1) << 31)
typedef void conic_put_function(const conic_octree *octree, const uint32_t *sources, size_t n, const float *eye,
                                const conic_splats *to, uint32_t *ids, size_t place);

typedef struct conic_octree_loops {
  conic_cover_function *cover;
  conic_find_near_function *find_near;
  conic_add_reach_function *add_reach;
  conic_choose_ratio_function *choose_ratio;
  conic_measure_function *measure;
  conic_put_function *put;
} conic_octree_loops;

CONIC_DECLARE_LOOPS(conic_octree_loops);
