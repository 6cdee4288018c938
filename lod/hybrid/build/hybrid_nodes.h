/* The hierarchy over the clusters, and ways to draw many of them as one. */
#ifndef CONIC_HYBRID_NODES_H
#define CONIC_HYBRID_NODES_H

#include "lod/hybrid/build/hybrid_levels.h"

/* Makes job->nodes over the clusters, whose ways are known; and, but for single levels and boxes, for each node its
 * point and surfels that stand for all of its clusters: of the clusters' own surfels, some of them close together at a
 * time, each what the surfels of a cluster are to its faces. The caller releases both, on failure too. Errors: MEMORY,
 * CANCELLED. */
conic_status conic_find_nodes(conic_ways_job *job);
void conic_nodes_release(conic_ways_job *job);

#endif
