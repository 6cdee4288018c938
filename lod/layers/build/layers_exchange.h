/* Samples on their way from the process that read them to the one that grows their branch. */
#ifndef CONIC_LAYERS_EXCHANGE_H
#define CONIC_LAYERS_EXCHANGE_H

#include "core/files/spool.h"
#include "lod/layers/build/layers_shares.h"

/* Samples that came together from one process. */
typedef struct conic_layers_arrival {
  int from;
  uint64_t at; /* in the spool */
  size_t n;
} conic_layers_arrival;

/* What has come, in memory up to a bound. */
typedef struct conic_layers_arrivals {
  conic_context *context;
  conic_spool spool;
  size_t sample_bytes;
  size_t n, room;
  conic_layers_arrival *list;
  uint64_t n_samples, sent_bytes;
} conic_layers_arrivals;

/* Sends every sample to its owner, and puts aside what comes. `path`: beside which the file lies; it must outlive
 * this. Collective. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_exchange(const conic_layers_shares *shares, const conic_layers_placing *placing,
                                   const char *path, size_t memory_bytes, conic_layers_arrivals *arrivals);
void conic_layers_arrivals_end(conic_layers_arrivals *arrivals); /* zero is allowed */

/* A feed's `run`, from conic_layers_arrivals: in the order in which one process would have read all. Errors: MEMORY,
 * IO, the receiver's. */
conic_status conic_layers_arrivals_run(const void *arrivals, conic_layers_take *take, void *to);

#endif
