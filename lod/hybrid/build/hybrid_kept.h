/* Splats that a hybrid model keeps as what they are, beside the surface that others became. */
#ifndef CONIC_HYBRID_KEPT_H
#define CONIC_HYBRID_KEPT_H

#include "lod/clusters/cluster_sample.h"
#include "lod/hybrid/model/hybrid_model.h"

/* Puts the kept splats into clusters of their own, of up to 64 that lie near each other, in place of their faces'
 * clusters. Errors: MEMORY. */
conic_status conic_hybrid_group_kept(conic_context *context, const conic_kept_splats *kept,
                                     conic_mesh_clusters *clusters);

/* conic_hybrid_build of a mesh whose last faces stand for splats; `kept` may be null. */
conic_status conic_hybrid_build_with(conic_context *context, conic_triangles *mesh, const conic_kept_splats *kept,
                                     const conic_hybrid_options *options, conic_hybrid **hybrid,
                                     conic_hybrid_report *report);

#endif
