/* From buckets to the whole tree, and from the tree to a file. Groups of chunks grow by themselves, on all threads,
 * chunk by chunk of what fits into memory; then the groups are merged, and a team's parts. */
#pragma once

#include "lod/layers/build/layers_parts.h"

/* All nodes, in the order of conic_layers_packed, and their clouds' bytes. With a team, the first process has all
 * entries, and every process the bytes of the clouds that it packed: the upper bits of an offset are its index. */
typedef struct conic_layers_tree {
  conic_spool entries; /* conic_layers_entry each; the last is the root's */
  conic_pile clouds;
  uint64_t attribute_bytes[CONIC_LAYERS_MOST_ATTRIBUTES];
  double outline; /* the lower median over all samples at full resolution */
} conic_layers_tree;

/* Where the index of the process stands in an offset. */
enum { CONIC_LAYERS_TEAM_SHIFT = 48 };

/* What growing may take. */
typedef struct conic_layers_growth {
  int n_workers;      /* at a time */
  uint64_t most;      /* samples of a chunk, where a leaf has no more */
  size_t pool_bytes;  /* of nodes that wait for their parents, beyond which they go to a file */
  size_t entry_bytes; /* likewise entries */
  conic_layers_kept *kept;
} conic_layers_growth;

/* Grows this process's parts and merges them; with a team, which makes it collective, also all processes' parts.
 * Errors: MEMORY, IO, UNSUPPORTED, CANCELLED. */
conic_status conic_layers_tree_grow(const conic_layers_plan *plan, const conic_layers_buckets *buckets,
                                    const conic_layers_parts *parts, const conic_layers_growth *growth,
                                    conic_layers_tree *tree);
void conic_layers_tree_end(conic_layers_tree *tree);

/* Merges the parts of all processes: nodes go from one process to the next. It takes over the *n nodes that are this
 * process's parts; part_ends[i] is how many entries the tree has when part i has grown. Afterwards the first process's
 * tree has all entries. Collective, also for a process whose `status` is a failure. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_merge_parts(const conic_layers_parts *parts, conic_status status, conic_layers_worker *worker,
                                      conic_layers_packed *packed, conic_layers_node **nodes, size_t *n,
                                      const uint64_t *part_ends, conic_layers_tree *tree);

/* Adds up, in the first process, what all workers have counted. Collective; a null team is allowed. */
void conic_layers_merge_counts(const conic_team *team, conic_layers_worker *worker, conic_layers_tree *tree);

/* Writes the file. `header` says what does not follow from the clouds; the rest is filled in. With a team it is
 * collective: the first process writes the index and fills the header in, and every process writes its own clouds. All
 * write to one file under its temporary name, so all have to see the same disk. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_write(conic_context *context, const char *path, const conic_team *team,
                                const conic_layers_tree *tree, conic_layers_header *header);
