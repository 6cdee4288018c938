/* Building a model of a part of a mesh. */
#ifndef CONIC_HYBRID_BUILD_H
#define CONIC_HYBRID_BUILD_H

#include "conic/hybrid.h"

/* conic_hybrid_build of the first n_own faces, without levels of the whole. The other faces lie beside these. They stay
 * as they are and are not in the model, but they are part of the surface: where they meet the model's faces, no vertex
 * is left out. Errors: as conic_hybrid_build. */
conic_status conic_hybrid_build_part(conic_context *context, conic_triangles *mesh, size_t n_own,
                                     const conic_hybrid_options *options, conic_hybrid **hybrid,
                                     conic_hybrid_report *report);

#endif
