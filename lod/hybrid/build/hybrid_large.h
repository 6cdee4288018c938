/* Building models of meshes that are larger than memory. */
#ifndef CONIC_HYBRID_LARGE_H
#define CONIC_HYBRID_LARGE_H

#include "conic/hybrid.h"

/* About so many faces are simplified together. */
enum { CONIC_HYBRID_CELL_FACES = 200000 };

/* conic_hybrid_build_file with cells of about `most_faces`, on which the model depends. */
conic_status conic_hybrid_build_cells(conic_context *context, const char *mesh, const char *path,
                                      const conic_hybrid_options *options, const conic_hybrid_streaming *streaming,
                                      size_t most_faces, conic_hybrid **hybrid, conic_hybrid_report *report);

#endif
