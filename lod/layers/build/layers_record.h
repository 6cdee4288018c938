/* A branch that has grown, with all that hangs on it, as bytes that are kept: its nodes, their clouds, what was counted
 * of its samples, and what of it waits for its parent. */
#ifndef CONIC_LAYERS_RECORD_H
#define CONIC_LAYERS_RECORD_H

#include "lod/layers/build/layers_kept.h"
#include "lod/layers/build/layers_tree.h"

/* A branch and what its shelf has got of it: `outlines` and `part_bytes` are of its samples alone. */
typedef struct conic_layers_grown {
  conic_layers_branch *branch;
  conic_layers_entry *nodes; /* their offsets: in the pile */
  size_t n_nodes;
  uint64_t part_bytes[CONIC_LAYERS_MOST_ATTRIBUTES];
  const uint64_t *outlines; /* CONIC_LAYERS_OUTLINES */
} conic_layers_grown;

/* The caller releases *bytes, on failure too. Errors: MEMORY, IO. */
conic_status conic_layers_record_pack(const conic_layers_plan *plan, const conic_layers_grown *grown,
                                      const conic_pile *clouds, unsigned char **bytes, size_t *n_bytes);

/* The other way: the nodes go to the shelf, their clouds to its pile, what was counted to shelf and worker. Errors:
 * INPUT (the bytes are no branch of that place), MEMORY, IO. */
conic_status conic_layers_record_unpack(conic_layers_worker *worker, const unsigned char *bytes, size_t n_bytes,
                                        const conic_layers_kept_branch *place, conic_layers_shelf *shelf,
                                        conic_layers_branch **branch);

#endif
