/* Models that are put together of others. Their chunks lie in a file without a name until they are written. */
#ifndef CONIC_HYBRID_PILE_H
#define CONIC_HYBRID_PILE_H

#include "core/files/pile.h"
#include "lod/hybrid/model/hybrid_model.h"

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
void conic_hybrid_pile_end_node(conic_hybrid_pile *pile, uint32_t node);

/* Gives the pile to a model, the rest of which is known. Errors: IO, MEMORY. */
conic_status conic_hybrid_pile_finish(conic_hybrid_pile *pile, conic_hybrid *hybrid);

void conic_hybrid_pile_release(conic_context *context, conic_hybrid_pile *pile); /* null is allowed */

/* Gives back the memory of what was read. */
void conic_hybrid_pile_rest(const conic_hybrid_pile *pile);

#endif
