/* Chooses what each cluster in sight is drawn as, triangles or surfels and at which level, and which nodes stand for
 * many of them, for an error on the screen. All are chosen together, since what one is drawn as changes
 * what its neighbours take. */
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
  size_t n; /* clusters in sight, but for those that nodes stand for already */
  const uint32_t *seen;
  size_t n_seen; /* nodes that may yet stand: in growing order, with each also all that it is below */
} conic_hybrid_choosing;

/* Gives each of the clusters a level, from its first, whose error is at most error_px: triangles or surfels, or the
 * kind that is asked for, at its finest where none is good enough; and to nodes of which all that is in sight is
 * surfels the level by which they stand for it, so that all together they take least, as far as a few rounds find it.
 * Before, nodes[i] is the level of each node that stands already, which stays, or NO_NODE. Errors: MEMORY. */
conic_status conic_hybrid_choose_levels(const conic_hybrid_choosing *choosing, uint32_t *levels, uint32_t *nodes);

#endif
