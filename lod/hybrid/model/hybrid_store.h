/* The chunks in memory of a hybrid model that is read by ranges. What was not used for longest goes first. */
#ifndef CONIC_HYBRID_STORE_H
#define CONIC_HYBRID_STORE_H

#include "conic/layers_draw.h"
#include "lod/hybrid/model/hybrid_model.h"
#include "lod/ranges/ranges.h"

typedef struct conic_hybrid_store conic_hybrid_store;

/* Takes over an open file, on failure too; `data_at` is where its first chunk lies. At most cache_bytes are kept, not
 * counting what is held; 0: any number. Errors: MEMORY. */
conic_status conic_hybrid_store_open(const conic_hybrid *hybrid, const char *name, conic_ranges *ranges,
                                     uint64_t data_at, uint64_t cache_bytes, conic_hybrid_store **store);
void conic_hybrid_store_close(conic_hybrid_store *store); /* null is allowed */

/* Brings chunks into memory, where they stay until they are let go. Without a store there is nothing to do. On failure
 * none is held. Errors: INPUT (damaged), IO, MEMORY, CANCELLED. */
conic_status conic_hybrid_store_hold(const conic_hybrid *hybrid, const uint32_t *chunks, size_t n);
void conic_hybrid_store_let_go(const conic_hybrid *hybrid, const uint32_t *chunks, size_t n);

/* How many bytes may be held together; infinite without a store. */
uint64_t conic_hybrid_store_room(const conic_hybrid *hybrid);

/* A chunk that is held. */
const unsigned char *conic_hybrid_store_bytes(const conic_hybrid_store *store, uint32_t chunk);

/* Since the file was opened. */
typedef struct conic_hybrid_traffic {
  uint64_t n_chunks;     /* that were read */
  uint64_t n_bytes;      /* of these, and of what lies before the first chunk */
  uint64_t n_received;   /* bytes that came over the network */
  uint64_t n_kept_bytes; /* of all chunks that are in memory now */
} conic_hybrid_traffic;

conic_hybrid_traffic conic_hybrid_store_traffic(const conic_hybrid *hybrid);

#endif
