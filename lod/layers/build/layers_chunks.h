/* From buckets to the whole tree: parts grow by themselves, on all threads, each chunk by chunk of what fits into
 * memory; then the parts are joined. */
#ifndef CONIC_LAYERS_CHUNKS_H
#define CONIC_LAYERS_CHUNKS_H

#include "lod/layers/build/layers_buckets.h"
#include "lod/layers/build/layers_shares.h"

/* All nodes, in the order of a shelf, and their clouds' bytes. Of several processes the first has all nodes, and every
 * one the bytes of those that it packed: offsets in its pile then have its number in their upper bits. */
typedef struct conic_layers_forest {
  conic_spool nodes; /* conic_layers_entry each; the last is the root */
  conic_pile clouds;
  uint64_t part_bytes[CONIC_LAYERS_MOST_ATTRIBUTES];
  double outline; /* the lower median over all samples at full resolution */
} conic_layers_forest;

/* What growing may take. */
typedef struct conic_layers_growth {
  int n_workers;        /* at a time */
  uint64_t most;        /* samples of a chunk, where a leaf has no more */
  size_t waiting_bytes; /* of branches that wait, beyond which they go to a file */
  size_t node_bytes;    /* likewise nodes */
  conic_layers_kept *kept;
} conic_layers_growth;

/* Where the number of the process stands in an offset. */
enum { CONIC_LAYERS_RANK_SHIFT = 48 };

/* Grows the limbs that are this process's own and joins them, together with the others of the team where there is one:
 * then it is collective. Errors: MEMORY, IO, UNSUPPORTED, CANCELLED. */
conic_status conic_layers_forest_grow(const conic_layers_plan *plan, const conic_layers_buckets *buckets,
                                      const conic_layers_shares *shares, const conic_layers_growth *growth,
                                      conic_layers_forest *forest);
void conic_layers_forest_end(conic_layers_forest *forest);

#endif
