/* The least error that so many primitives can give. */
#ifndef CONIC_HYBRID_BUDGET_H
#define CONIC_HYBRID_BUDGET_H

#include "lod/hybrid/draw/hybrid_cut.h"

/* Finds the least error E on the screen for which the picture has no more than `budget` primitives, with those that fit
 * clusters to each other; of one kind alone where that gives a smaller E. Each of the n clusters in sight gets the
 * level, from its first, of fewest primitives with an error of at most E. A node of fewer primitives than its clusters
 * together gets the level by which it stands for them; all others get NO_NODE. Infinite errors are the last to be
 * taken. `only_kind` as in conic_hybrid_view. Errors: ARGUMENT (the coarsest of all are more), MEMORY. */
conic_status conic_hybrid_fit_budget(const conic_hybrid *hybrid, const conic_hybrid_camera *view, int only_kind,
                                     uint64_t budget, const uint32_t *clusters, size_t n, uint32_t *levels,
                                     uint32_t *nodes);

#endif
