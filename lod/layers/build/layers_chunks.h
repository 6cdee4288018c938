/* From buckets to the whole tree: what fits into memory grows by itself, on all threads; then the pieces are joined. */
#ifndef CONIC_LAYERS_CHUNKS_H
#define CONIC_LAYERS_CHUNKS_H

#include "lod/layers/build/layers_buckets.h"
#include "lod/layers/build/layers_tree.h"

/* All nodes, their clouds' bytes put aside. */
typedef struct conic_layers_forest {
  conic_layers_shelf shelf; /* its bytes are those that the spool has not yet */
  conic_spool spool;
  uint32_t root; /* the last node */
} conic_layers_forest;

/* Chunks of up to `most` samples, not below a leaf's, grow at a time, one on each thread. Errors: MEMORY, IO,
 * UNSUPPORTED, CANCELLED. */
conic_status conic_layers_forest_grow(const conic_layers_plan *plan, const conic_layers_buckets *buckets, uint64_t most,
                                      size_t memory_bytes, conic_layers_forest *forest);
void conic_layers_forest_end(conic_layers_forest *forest);

#endif
