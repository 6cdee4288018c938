/* Which nodes stand for all of their clusters before any of the clusters is looked at. */
#ifndef CONIC_HYBRID_SIGHT_H
#define CONIC_HYBRID_SIGHT_H

#include "lod/hybrid/draw/hybrid_offers.h"

/* The least that a cluster takes, whatever it is drawn as: to look at it, to copy it, and to draw one primitive. */
#define CONIC_HYBRID_LEAST_NS 250.0

/* Whether a node lies wholly within the picture, is good enough, and takes no more than its clusters would, whatever
 * they were drawn as. Then *offer is what it is drawn as, and *saved_ns grows by the least that it saves. */
int conic_hybrid_stands_at_once(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                                const conic_hybrid_node *node, double error_px, conic_hybrid_offer *offer,
                                double *saved_ns);

#endif
