/* From the ways to draw each cluster to a model, all in one piece of memory. */
#ifndef CONIC_HYBRID_PACK_H
#define CONIC_HYBRID_PACK_H

#include "lod/hybrid/build/hybrid_levels.h"

/* Makes the model of all that was found. The caller owns what there is of *hybrid, on failure too. Errors: ARGUMENT
 * (too much for a file), MEMORY. */
conic_status conic_hybrid_pack(const conic_ways_job *ways, conic_hybrid **hybrid);

#endif
