/* Samples sorted roughly: by the first bits of their keys, into buckets that are kept as chains of blocks. */
#ifndef CONIC_LAYERS_BUCKETS_H
#define CONIC_LAYERS_BUCKETS_H

#include "core/files/spool.h"
#include "lod/layers/build/layers_kept.h"
#include "lod/layers/build/layers_place.h"

/* The samples of a cell of the grid, or of those that coincide a part. */
typedef struct conic_layers_bucket {
  uint64_t key; /* the cell's first */
  uint64_t count;
  uint64_t last_block;                  /* where it is in the spool; each says where the one before it is */
  uint8_t n_bits;                       /* of a key, below those that the cell's have in common */
  uint8_t is_reversed;                  /* the last that came are the first in it */
  const conic_layers_kept_branch *kept; /* what has grown of them before, in place of the samples; null: it has not */
} conic_layers_bucket;

typedef struct conic_layers_buckets {
  conic_context *context;
  conic_spool spool;
  size_t block_samples, sample_bytes;
  size_t n, room;
  conic_layers_bucket *buckets; /* ascending by key; none is empty */
} conic_layers_buckets;

/* Keys, ascending, at which a bucket has to end if it has samples on both sides. */
typedef struct conic_layers_cuts {
  const uint64_t *keys;
  size_t n;
} conic_layers_cuts;

/* Sorts the samples that the feed has, until no bucket holds more than `most`. Samples that coincide are halved as
 * often as it takes. `path`: beside which the file lies; it must outlive the buckets. Errors: MEMORY, IO, the feed's.
 */
conic_status conic_layers_buckets_fill(conic_context *context, const char *path, const conic_layers_feed *feed,
                                       const conic_layers_plan *plan, const conic_layers_cuts *cuts,
                                       size_t memory_bytes, uint64_t most, conic_layers_buckets *buckets);
void conic_layers_buckets_end(conic_layers_buckets *buckets);

/* Adds those for branches that are kept, ascending, in whose places no bucket lies. Errors: MEMORY. */
conic_status conic_layers_buckets_add(conic_layers_buckets *buckets, const conic_layers_kept_branch *const *kept,
                                      size_t n);

/* Copies the samples of some buckets in a row, and sorts them by key, those of one key as they came; both arrays have
 * room for all of them, and the sorted ones are in *sorted, either. Several threads may do so. Errors: MEMORY, IO. */
conic_status conic_layers_buckets_load(const conic_layers_buckets *buckets, size_t first, size_t end,
                                       unsigned char *samples, unsigned char *scratch, unsigned char **sorted);

#endif
