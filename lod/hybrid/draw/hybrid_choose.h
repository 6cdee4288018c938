/* Chooses what each cluster in sight is drawn as, triangles or surfels and at which level, and which nodes stand for
 * many of them: the fewest primitives for an error on the screen, or the least error for so many. */
#pragma once

#include "lod/hybrid/draw/hybrid_offers.h"

/* A node whose clusters are drawn each by itself, or that is below one that stands for it. */
#define CONIC_HYBRID_NO_NODE UINT32_MAX

/* What there is to choose for. */
typedef struct conic_hybrid_choosing {
  const conic_hybrid *hybrid;
  const conic_hybrid_camera *view;
  int only_kind;   /* below 0: either */
  double error_px; /* to be kept where there is no budget */
  uint64_t budget; /* the most primitives; 0: none */
  const uint32_t *clusters;
  size_t n; /* clusters in sight */
  const uint32_t *seen;
  size_t n_seen; /* nodes in sight, in growing order; all nodes above one are among them */
} conic_hybrid_choosing;

/* Gives each of the clusters a level, from its first, and each of the model's nodes NO_NODE, or the level by which it
 * stands for all of its clusters; n_levels is its point. Those that fit clusters to each other are counted.
 *
 * For an error all take the fewest primitives with an error of at most that; of as many, those that draw faster. Where
 * the kind that is asked for has nothing as good, it is at its finest. For a budget it is the least such error, or
 * nearly. The whole model's triangles then count half their error, and infinite errors are the last to be taken.
 *
 * Errors: ARGUMENT (the coarsest of all are more than the budget), MEMORY. */
conic_status conic_hybrid_choose_levels(const conic_hybrid_choosing *choosing, uint32_t *levels, uint32_t *nodes);

/* For each cluster of the model the node that stands for it, or NO_NODE. */
void conic_hybrid_find_standing(const conic_hybrid *hybrid, const uint32_t *nodes, uint32_t *standing);
