/* What branches of a growing tree keep while they wait for their parents: in memory up to a bound, which all threads
 * share, beyond it in a file. */
#ifndef CONIC_LAYERS_WAITING_H
#define CONIC_LAYERS_WAITING_H

#include "core/files/pile.h"
#include "lod/layers/build/layers_branch.h"

struct conic_layers_waiting {
  conic_context *context;
  size_t sample_bytes, most_drawn; /* of a branch's samples */
  unsigned key_bits;
  conic_pile pile;
  atomic_size_t n_held; /* bytes in memory */
  size_t most_held;
};

/* `path`: beside which the file lies; it must outlive this. Errors: MEMORY, IO. */
conic_status conic_layers_waiting_begin(const conic_layers_plan *plan, const char *path, size_t memory_bytes,
                                        conic_layers_waiting *waiting);
void conic_layers_waiting_end(conic_layers_waiting *waiting); /* zero is allowed */

/* Gives a branch memory for its samples, keys and facets; the latter two go together. Errors: MEMORY. */
conic_status conic_layers_hold(conic_layers_waiting *waiting, conic_layers_branch *branch);
void conic_layers_drop_samples(conic_layers_branch *branch);
void conic_layers_drop_keys(conic_layers_branch *branch);

/* Moves branches' samples and keys, and those of all that hangs on them, to the file, the first branch's first, until
 * memory is within the bound. Errors: IO. */
conic_status conic_layers_put_away(conic_layers_branch *const *branches, size_t n);

/* Copies a branch's samples, or some of its keys or facets, from wherever they are. Errors: IO. */
conic_status conic_layers_fetch_samples(const conic_layers_branch *branch, unsigned char *samples);
conic_status conic_layers_fetch_keys(const conic_layers_branch *branch, size_t first, size_t n, uint64_t *keys);
conic_status conic_layers_fetch_facets(const conic_layers_branch *branch, size_t first, size_t n,
                                       conic_layers_facet *facets);

#endif
