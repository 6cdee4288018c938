/* From sorted samples to a tree of clouds: bottom up, every node takes from its children the samples that stand for
 * all of its place, and what is left of the children's is their clouds (docs/reference/layers.md). */
#ifndef CONIC_LAYERS_TREE_H
#define CONIC_LAYERS_TREE_H

#include "core/files/pile.h"
#include "lod/layers/build/layers_thin.h"
#include "lod/layers/format/layers_code.h"

/* What is the same for all of a tree. */
typedef struct conic_layers_plan {
  conic_context *context;
  uint32_t bits, cloud_size;
  uint64_t n_samples;  /* of the whole tree */
  size_t sample_bytes; /* how far samples are apart: each is followed by bytes of its own */
  double quantum;
  double spacing;    /* sampling distance, where a leaf has too few samples to tell */
  int is_unoriented; /* some normals have no side */
  int has_bare;      /* some samples come without a normal */
  float cutoff;
  const conic_layers_schema *schema;
} conic_layers_plan;

/* A leaf holds up to three clouds' worth of samples, of which its ancestors take about half. */
static inline size_t conic_layers_most_in_leaf(const conic_layers_plan *plan) {
  return 3 * (size_t)plan->cloud_size;
}

/* Nodes whose clouds have been packed: two siblings, the first first, come behind all that is below them; of what is
 * below, that below the first comes first. Their clouds' bytes go to a pile. */
typedef struct conic_layers_shelf {
  conic_context *context;
  conic_pile *clouds;
  conic_layers_entry *nodes; /* parent and level unknown; child: whether there are any; the offset: in the pile */
  size_t n_nodes, node_room;
  unsigned char *bytes; /* of clouds that are not there yet */
  size_t n_bytes, byte_room;
  size_t n_put; /* nodes whose bytes are there */
  uint64_t part_bytes[CONIC_LAYERS_MOST_ATTRIBUTES];
} conic_layers_shelf;

/* Puts all bytes on the pile. Errors: IO. */
conic_status conic_layers_shelf_flush(conic_layers_shelf *shelf);
void conic_layers_shelf_release(conic_layers_shelf *shelf);

/* A node that waits for its parent to take samples from it. */
typedef struct conic_layers_branch conic_layers_branch;

struct conic_layers_waiting;

/* What working on branches needs; each thread has its own. */
typedef struct conic_layers_worker conic_layers_worker;

/* Errors: MEMORY, UNSUPPORTED. */
conic_status conic_layers_worker_create(const conic_layers_plan *plan, struct conic_layers_waiting *waiting,
                                        conic_layers_worker **worker);
void conic_layers_worker_destroy(conic_layers_worker *worker);

struct conic_layers_waiting *conic_layers_worker_waiting(const conic_layers_worker *worker);

/* How many samples have which outline at full resolution, by conic_layers_code_size: CONIC_LAYERS_OUTLINES counts. */
enum { CONIC_LAYERS_OUTLINES = 1 << 15 };
const uint64_t *conic_layers_worker_outlines(const conic_layers_worker *worker);
/* Adds what another has counted. */
void conic_layers_worker_add_outlines(conic_layers_worker *worker, const uint64_t *outlines);

/* What a worker takes, about. */
size_t conic_layers_worker_bytes(const conic_layers_plan *plan);

/* The tree of n > 0 samples, ascending by key; all nodes but its root go to the shelf. Bare samples get their normals.
 * Errors: MEMORY, IO. */
conic_status conic_layers_grow(conic_layers_worker *worker, unsigned char *samples, size_t n, conic_layers_shelf *shelf,
                               conic_layers_branch **branch);

/* The parent of two branches, which it takes over, on failure too: the first one's keys come first. `is_alone`: it may
 * use all threads. Errors: MEMORY, IO. */
conic_status conic_layers_join(conic_layers_worker *worker, conic_layers_branch *const children[2], int is_alone,
                               conic_layers_shelf *shelf, conic_layers_branch **parent);

/* Packs what the branch still has, as its cloud: the root's. Errors: MEMORY, IO. */
conic_status conic_layers_finish_root(conic_layers_worker *worker, const conic_layers_branch *branch,
                                      conic_layers_shelf *shelf);

/* The branch and all that hangs on it; null is allowed. */
void conic_layers_branch_destroy(conic_layers_branch *branch);

#endif
