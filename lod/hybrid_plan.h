/* The levels of all patches in sight together: what one is drawn as changes what its neighbours take. */
#ifndef LOD_HYBRID_PLAN_H
#define LOD_HYBRID_PLAN_H

#include "lod/hybrid_choose.h"

/* Gives each of n patches, those in sight, a level, from its first, whose error is at most error_px: triangles or
 * surfels, so that all together they take least, as far as a few rounds find it. Errors: MEMORY. */
conic_status conic_hybrid_plan(const conic_hybrid *hybrid, const conic_hybrid_camera *view, double error_px,
                               const uint32_t *patches, size_t n, uint32_t *levels);

#endif
