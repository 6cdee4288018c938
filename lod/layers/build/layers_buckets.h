/* Samples sorted roughly: by the first bits of their keys, into buckets that are kept as chains of blocks. */
#ifndef CONIC_LAYERS_BUCKETS_H
#define CONIC_LAYERS_BUCKETS_H

#include "lod/layers/build/layers_intake.h"
#include "lod/layers/build/layers_tree.h"

/* The samples of a cell of the grid. */
typedef struct conic_layers_bucket {
  uint64_t key;    /* the cell's first */
  unsigned n_bits; /* of a key, below those that the cell's have in common */
  uint64_t count;
  uint64_t *blocks; /* where they are in the spool, in the order in which they came */
  size_t n_blocks, block_room;
  conic_layers_sample *open; /* the block that is being filled, or null */
  size_t n_open;
} conic_layers_bucket;

typedef struct conic_layers_buckets {
  conic_context *context;
  conic_spool spool;
  size_t block_samples;
  size_t n, room;
  conic_layers_bucket *buckets; /* ascending by key; none is empty */
} conic_layers_buckets;

/* Gives every sample of the intake its key on the grid and sorts them, until no bucket holds more than `most`, but for
 * those that lie in one cell of the grid. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_buckets_fill(const conic_layers_intake *intake, const conic_layers_plan *plan,
                                       const double origin[3], size_t memory_bytes, uint64_t most,
                                       conic_layers_buckets *buckets);
void conic_layers_buckets_end(conic_layers_buckets *buckets);

/* Copies the samples of some buckets in a row, and sorts them by key, those of one key as they came; both arrays have
 * room for all of them, and the sorted ones are in the first. Several threads may do so. Errors: IO. */
conic_status conic_layers_buckets_load(const conic_layers_buckets *buckets, size_t first, size_t end,
                                       conic_layers_sample *samples, conic_layers_sample *scratch);

#endif
