/* From sorted samples to a tree of clouds: bottom up, every node takes from its children the samples that stand for
 * all of its place, and what is left of the children's is their clouds (docs/reference/layers.md). */
#ifndef CONIC_LAYERS_TREE_H
#define CONIC_LAYERS_TREE_H

#include "lod/layers/build/layers_thin.h"
#include "lod/layers/format/layers_code.h"

/* What is the same for all of a tree. */
typedef struct conic_layers_plan {
  conic_context *context;
  uint32_t bits, cloud_size;
  uint64_t n_samples; /* of the whole tree */
  double quantum;
  double spacing;                /* sampling distance, where a leaf has too few samples to tell */
  int has_colors, is_unoriented; /* the latter: some samples come without a normal */
} conic_layers_plan;

/* A leaf holds up to three clouds' worth of samples, of which its ancestors take about half. */
static inline size_t conic_layers_most_in_leaf(const conic_layers_plan *plan) {
  return 3 * (size_t)plan->cloud_size;
}

#define CONIC_LAYERS_NO_NODE UINT32_MAX

/* A node whose cloud has been packed. */
typedef struct conic_layers_node {
  conic_layers_entry entry; /* but for parent, child and level; the offset is that in the bytes it went to */
  uint32_t children[2];     /* or CONIC_LAYERS_NO_NODE */
} conic_layers_node;

/* Nodes and their clouds' bytes, one after the other. */
typedef struct conic_layers_shelf {
  conic_context *context;
  conic_layers_node *nodes;
  size_t n_nodes, node_room;
  unsigned char *bytes;
  size_t n_bytes, byte_room;
  uint64_t part_bytes[CONIC_LAYERS_PARTS];
} conic_layers_shelf;

void conic_layers_shelf_release(conic_layers_shelf *shelf);

/* A node that waits for its parent to take samples from it. */
typedef struct conic_layers_branch conic_layers_branch;

/* What working on branches needs; each thread has its own. */
typedef struct conic_layers_worker conic_layers_worker;

/* Errors: MEMORY, UNSUPPORTED. */
conic_status conic_layers_worker_create(const conic_layers_plan *plan, conic_layers_worker **worker);
void conic_layers_worker_destroy(conic_layers_worker *worker);

/* The tree of n > 0 samples, ascending by key; all nodes but its root go to the shelf. Bare samples get their normals.
 * Errors: MEMORY. */
conic_status conic_layers_grow(conic_layers_worker *worker, conic_layers_sample *samples, size_t n,
                               conic_layers_shelf *shelf, conic_layers_branch **branch);

/* The parent of two branches, which it takes over, on failure too: the first one's keys come first. Errors: MEMORY.
 */
conic_status conic_layers_join(conic_layers_worker *worker, conic_layers_branch *const children[2],
                               conic_layers_shelf *shelf, conic_layers_branch **parent);

/* Packs what the branch still has, as its cloud: the root's. Errors: MEMORY. */
conic_status conic_layers_finish_root(conic_layers_worker *worker, conic_layers_branch *branch,
                                      conic_layers_shelf *shelf);

/* The branch and all that hangs on it; null is allowed. */
void conic_layers_branch_destroy(conic_context *context, conic_layers_branch *branch);

#endif
