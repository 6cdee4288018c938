/* The least error that so many primitives can give. */
#ifndef LOD_HYBRID_BUDGET_H
#define LOD_HYBRID_BUDGET_H

#include "lod/hybrid_choose.h"

/* Gives each of n patches, those in sight, the level of fewest primitives, from its first, whose error on the screen is
 * at most E: the least E for which they are no more than `budget` together. Infinite errors are the last to be taken.
 * `only_kind` as in conic_hybrid_view. Errors: ARGUMENT (the coarsest of all are more), MEMORY. */
conic_status conic_hybrid_fit_budget(const conic_hybrid *hybrid, const conic_hybrid_camera *view, int only_kind,
                                     uint64_t budget, const uint32_t *patches, size_t n, uint32_t *levels);

#endif
