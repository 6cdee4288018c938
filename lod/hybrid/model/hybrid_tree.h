/* The hierarchy over the clusters. */
#ifndef CONIC_HYBRID_TREE_H
#define CONIC_HYBRID_TREE_H

#include "lod/hybrid/model/hybrid_model.h"

/* The most clusters in a node without children. */
enum { CONIC_HYBRID_LEAF = 4 };

/* How many of n clusters are in the first half, where they are split. */
size_t conic_hybrid_half(size_t n);

/* How many nodes there are over so many clusters. */
size_t conic_hybrid_count_nodes(size_t n_clusters);

/* Orders clusters with the given bounds so that neighbours are near each other; order[k] is the number of the k-th.
 * Where `kinds` is not null, those of kind 0 come before those of kind 1. Errors: MEMORY. */
conic_status conic_hybrid_order(conic_context *context, const conic_hybrid_bound *bounds, const uint8_t *kinds,
                                size_t n_clusters, uint32_t *order);

/* Fills in the nodes, without their levels and points, over ordered clusters with the given bounds; reach[k] is how far
 * the surfels of cluster k may stand out of its sphere. */
void conic_hybrid_fill_nodes(const conic_hybrid_bound *bounds, const float *reach, size_t n_clusters,
                             conic_hybrid_node *nodes);

/* A sphere and a cone that hold both; a cone of more than half of all directions becomes all of them, -1. */
conic_hybrid_bound conic_hybrid_join(const conic_hybrid_bound *a, const conic_hybrid_bound *b);

#endif
