/* The chunks in memory of a hybrid model that is read by ranges. What was not used for longest goes first. */
#pragma once

#include "core/files/pile.h"
#include "lod/hybrid/model/hybrid_model.h"
#include "lod/ranges/ranges.h"

/* --- models that are put together of others --- */

typedef struct conic_hybrid_pile {
  conic_pile file;
  void *map; /* of it, once it is whole */
  size_t map_bytes;
  conic_hybrid_level *levels; /* of clusters, */
  conic_hybrid_level *joined; /* and of nodes, which go behind these */
  conic_hybrid_cluster *clusters;
  conic_hybrid_node *nodes;
  size_t n_levels, n_joined, n_clusters, n_nodes, levels_room, joined_room, clusters_room, nodes_room;
} conic_hybrid_pile;

/* Adds a model's clusters, its chunks, and its nodes. The levels of nodes are numbered from the first of all nodes' on.
 * Errors: IO, MEMORY, ARGUMENT (too much for a file). */
conic_status conic_hybrid_pile_add(conic_context *context, conic_hybrid_pile *pile, const conic_hybrid *part);

/* Adds a node over those that are added next. When all of these are there, ending it drops it again if there are fewer
 * than two. */
conic_status conic_hybrid_pile_begin_node(conic_context *context, conic_hybrid_pile *pile, uint32_t *node);
void conic_hybrid_pile_end_node(conic_hybrid_pile *p, uint32_t i);

/* Gives the pile to a model; the rest of the model is known. Errors: IO, MEMORY. */
conic_status conic_hybrid_pile_finish(conic_hybrid_pile *pile, conic_hybrid *hybrid);

void conic_hybrid_pile_release(conic_context *context, conic_hybrid_pile *pile); /* null is allowed */

/* Gives back the memory of what was read. */
void conic_hybrid_pile_rest(const conic_hybrid_pile *pile);

typedef struct conic_hybrid_store conic_hybrid_store;

/* Takes over an open file, on failure too; `data_at` is where its first chunk lies. At most cache_bytes are kept, not
 * counting what is held; 0: any number. Errors: MEMORY. */
conic_status conic_hybrid_store_open(const conic_hybrid *h, const char *name, conic_ranges *ranges, uint64_t data_at,
                                     uint64_t cache_bytes, conic_hybrid_store **made);
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
