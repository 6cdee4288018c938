/* Chooses, for an error on the screen, what each cluster in sight is drawn as, triangles or surfels and at which level,
 * and which nodes stand for many of them. All are chosen together, since what one is drawn as changes what its
 * neighbours take. */
#ifndef CONIC_HYBRID_CHOOSE_H
#define CONIC_HYBRID_CHOOSE_H

#include "lod/hybrid/draw/hybrid_cut.h"

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

#endif
