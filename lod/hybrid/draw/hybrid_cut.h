/* Which nodes stand for all of their clusters. */
#ifndef CONIC_HYBRID_CUT_H
#define CONIC_HYBRID_CUT_H

#include "lod/hybrid/draw/hybrid_offers.h"

/* A node whose clusters are drawn each by itself, or that is below one that stands for it. */
#define CONIC_HYBRID_NO_NODE UINT32_MAX

typedef struct conic_hybrid_cutting {
  const conic_hybrid *hybrid;
  const double *amounts; /* what each cluster takes, in any unit: 0 out of sight; NaN where no node may stand for it */
  /* What the best way to draw a node takes, and which level that is, from the node's first; n_levels is its point.
   * Infinite where none is good enough. */
  conic_hybrid_offer (*offer)(const void *data, const conic_hybrid_node *node);
  const void *data;
  double *below; /* room for a number a node */
} conic_hybrid_cutting;

/* Lets nodes stand for their clusters wherever that takes less. nodes[i] becomes the level of node i, from its first,
 * or NO_NODE. Returns how much less all takes then. */
double conic_hybrid_cut(const conic_hybrid_cutting *cutting, uint32_t *nodes);

/* The same for some of the nodes, in growing order; all nodes above one are among them. The caller fills in nodes[i]
 * and below[i] of the others: NO_NODE, and 0 where it is out of sight, NaN where no node above may stand for it. */
double conic_hybrid_cut_seen(const conic_hybrid_cutting *cutting, const uint32_t *seen, size_t n_seen, uint32_t *nodes);

/* For each cluster of the model the node that stands for it, or NO_NODE. */
void conic_hybrid_find_standing(const conic_hybrid *hybrid, const uint32_t *nodes, uint32_t *standing);

#endif
