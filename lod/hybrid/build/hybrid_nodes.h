/* The hierarchy over the clusters, and ways to draw many of them as one. */
#ifndef CONIC_HYBRID_NODES_H
#define CONIC_HYBRID_NODES_H

#include "lod/hybrid/build/hybrid_levels.h"

/* Makes job->nodes over the clusters, whose ways are known. But for single levels and boxes, each node gets its point,
 * and surfels that stand for all of its clusters. A node's surfel stands for some of the clusters' surfels that are
 * close together, as a cluster's surfel does for faces. The caller releases all, on failure too. Errors: MEMORY,
 * CANCELLED. */
conic_status conic_find_nodes(conic_ways_job *job);
void conic_nodes_release(conic_ways_job *job);

#endif
