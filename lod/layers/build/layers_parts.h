/* Samples on their way to where the tree grows. With a team, each process grows parts of the tree, and gets their
 * samples from the others; the same parts are found in every process. Then samples are sorted roughly into buckets. */
#pragma once

#include "lod/layers/build/layers_raws.h"

/* A part of the tree that one process grows: one of the largest places that are one process's alone. Parts come as
 * numbers do in reverse Polish notation, and merging is the operation. */
typedef struct conic_layers_part {
  uint64_t key;      /* of its place, or less, but more than any before it */
  int owner;         /* the process, by its index */
  unsigned n_merges; /* with what comes before, behind it */
} conic_layers_part;

typedef struct conic_layers_parts {
  conic_context *context;
  const conic_team *team; /* null: one process grows all, as one part */
  size_t n_cells;
  uint64_t *cells; /* the first keys of places in a row, ascending, which are all that hold samples */
  int *owners;     /* of each */
  size_t n, room;
  conic_layers_part *list;
  uint64_t *own_keys; /* of this process's parts, ascending */
  size_t n_own;
} conic_layers_parts;

/* `least`: places with no more samples are not split. Collective. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_parts_find(const conic_team *team, const conic_layers_grid *grid,
                                     const conic_layers_plan *plan, uint64_t least, conic_layers_parts *parts);
void conic_layers_parts_end(conic_layers_parts *parts); /* zero is allowed */

/* The process that grows the place in which a key lies. */
int conic_layers_parts_owner(const conic_layers_parts *parts, uint64_t key);

/* Samples that came together from one process. */
typedef struct conic_layers_message {
  int from;
  uint64_t at; /* in the spool */
  size_t n;
} conic_layers_message;

/* What has come, in memory up to a bound. */
typedef struct conic_layers_received {
  conic_context *context;
  conic_spool spool;
  size_t sample_bytes;
  size_t n, room;
  conic_layers_message *list;
  uint64_t n_samples, sent_bytes;
} conic_layers_received;

/* Sends every sample to its owner, and puts aside what comes. `path`: beside which the file lies; it must outlive
 * `received`. Collective. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_send_samples(const conic_layers_parts *parts, const conic_layers_grid *grid, const char *path,
                                       size_t memory_bytes, conic_layers_received *received);
void conic_layers_received_end(conic_layers_received *received); /* zero is allowed */

/* A feed's `run`, from conic_layers_received: in the order in which one process would have read all. Errors: MEMORY,
 * IO, the receiver's. */
conic_status conic_layers_received_run(const void *received, conic_layers_take *take, void *to);

/* The samples of a cell of the grid; or a share of them, where they coincide. */
typedef struct conic_layers_bucket {
  uint64_t key; /* the cell's first */
  uint64_t count;
  uint64_t last_block;                  /* where it is in the spool; each says where the one before it is */
  uint8_t n_bits;                       /* of a key, below those that the cell's have in common */
  uint8_t is_reversed;                  /* the last that came are the first in it */
  const conic_layers_kept_branch *kept; /* what has grown of it before, in place of the samples; null: nothing has */
} conic_layers_bucket;

/* Buckets by the first bits of keys, kept as chains of blocks. */
typedef struct conic_layers_buckets {
  conic_context *context;
  conic_spool spool;
  size_t block_samples, sample_bytes;
  size_t n, room;
  conic_layers_bucket *buckets; /* ascending by key; none is empty */
} conic_layers_buckets;

/* Keys, ascending, at which a bucket has to end if it has samples on both sides. */
typedef struct conic_layers_borders {
  const uint64_t *keys;
  size_t n;
} conic_layers_borders;

/* Sorts the samples that the feed has, until no bucket holds more than `most`. Samples that coincide are halved as
 * often as it takes. `path`: beside which the file lies; it must outlive the buckets. Errors: MEMORY, IO, the feed's.
 */
conic_status conic_layers_buckets_fill(conic_context *context, const char *path, const conic_layers_feed *feed,
                                       const conic_layers_plan *plan, const conic_layers_borders *borders,
                                       size_t memory_bytes, uint64_t most, conic_layers_buckets *buckets);
void conic_layers_buckets_end(conic_layers_buckets *buckets);

/* Adds those for branches that are kept, ascending; no bucket lies in their places. Errors: MEMORY. */
conic_status conic_layers_buckets_add(conic_layers_buckets *buckets, const conic_layers_kept_branch *const *kept,
                                      size_t n);

/* Copies the samples of some buckets in a row, sorted by key, and those of one key as they came. Both arrays have room
 * for all of them; *sorted is the one that has them. Several threads may do so. Errors: MEMORY, IO. */
conic_status conic_layers_buckets_load(const conic_layers_buckets *buckets, size_t first, size_t end,
                                       unsigned char *samples, unsigned char *scratch, unsigned char **sorted);
