/* The least error that so many primitives can give. */
#ifndef CONIC_HYBRID_BUDGET_H
#define CONIC_HYBRID_BUDGET_H

#include "lod/hybrid/draw/hybrid_cut.h"

/* Gives each of n clusters, those in sight, the level of fewest primitives, from its first, whose error on the screen
 * is at most E; and nodes of fewer than their clusters together the level by which they stand for these, all others
 * NO_NODE: at the least E for which they are no more than `budget` together, with those that fit them to each other;
 * or, where that is less, of one kind alone. Infinite errors are the last to be taken.
 * `only_kind` as in conic_hybrid_view. Errors: ARGUMENT (the coarsest of all are more), MEMORY. */
conic_status conic_hybrid_fit_budget(const conic_hybrid *hybrid, const conic_hybrid_camera *view, int only_kind,
                                     uint64_t budget, const uint32_t *clusters, size_t n, uint32_t *levels,
                                     uint32_t *nodes);

#endif
