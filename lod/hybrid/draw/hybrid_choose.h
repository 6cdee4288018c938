/* Chooses, for an error on the screen, what each cluster in sight is drawn as, triangles or surfels and at which level,
 * and which nodes stand for many of them. All are chosen together, since what one is drawn as changes what its
 * neighbours take. */
#ifndef CONIC_HYBRID_CHOOSE_H
#define CONIC_HYBRID_CHOOSE_H

#include "lod/hybrid/draw/hybrid_offers.h"

/* --- nodes that stand for their clusters --- */

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
 * or NO_NODE. Returns how much less all takes then. Looked at are the nodes `seen`, in growing order, and all nodes
 * above one are among them; null: all. The caller fills in nodes[i] and below[i] of the others: NO_NODE, and 0 where it
 * is out of sight, NaN where no node above may stand for it. */
double conic_hybrid_cut(const conic_hybrid_cutting *cutting, const uint32_t *seen, size_t n_seen, uint32_t *nodes);

/* For each cluster of the model the node that stands for it, or NO_NODE. */
void conic_hybrid_find_standing(const conic_hybrid *hybrid, const uint32_t *nodes, uint32_t *standing);

/* What there is to choose for. */
typedef struct conic_hybrid_choosing {
  const conic_hybrid *hybrid;
  const conic_hybrid_camera *view;
  double error_px;
  int only_kind; /* below 0: either */
  const uint32_t *clusters;
  size_t n; /* clusters in sight for which no node stands yet */
  const uint32_t *seen;
  size_t n_seen; /* nodes that may yet stand, in growing order; all nodes above one are among them */
} conic_hybrid_choosing;

/* Gives each of the clusters a level, from its first, whose error is at most error_px: triangles or surfels, or the
 * kind that is asked for, at its finest where none is good enough. A node may stand for its clusters where all of them
 * in sight are surfels; it then gets the level by which it does. All together take least, as far as a few rounds find
 * it. Before the call, nodes[i] is NO_NODE, or the level of a node that stands already and stays. Errors: MEMORY. */
conic_status conic_hybrid_choose_levels(const conic_hybrid_choosing *choosing, uint32_t *levels, uint32_t *nodes);

/* --- budgets --- */

/* Finds the least error E on the screen for which the picture has no more than `budget` primitives, with those that fit
 * clusters to each other; of one kind alone where that gives a smaller E. Each of the n clusters in sight gets the
 * level, from its first, of fewest primitives with an error of at most E. A node of fewer primitives than its clusters
 * together gets the level by which it stands for them; all others get NO_NODE. Infinite errors are the last to be
 * taken. `only_kind` as in conic_hybrid_view. Errors: ARGUMENT (the coarsest of all are more), MEMORY. */
conic_status conic_hybrid_fit_budget(const conic_hybrid *hybrid, const conic_hybrid_camera *view, int only_kind,
                                     uint64_t budget, const uint32_t *clusters, size_t n, uint32_t *levels,
                                     uint32_t *nodes);

#endif
