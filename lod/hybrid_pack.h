/* From the ways to draw each patch to a model, all in one piece of memory. */
#ifndef LOD_HYBRID_PACK_H
#define LOD_HYBRID_PACK_H

#include "lod/hybrid_levels.h"

/* `ways` are those of the mesh's patches, `chains` lie between them; `cutoff` is that of the surfels. What there is of
 * *hybrid is the caller's, on failure too. Errors: ARGUMENT (too much for a file), MEMORY. */
conic_status conic_hybrid_pack(conic_context *context, const conic_patch_mesh *mesh, const conic_patch_ways *ways,
                               const conic_patch_chains *chains, float cutoff, conic_hybrid **hybrid);

#endif
