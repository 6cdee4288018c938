/* What one pass over a cluster need not do again: sites whose surroundings are as they were in the last. */
#ifndef CONIC_CLUSTER_REUSE_H
#define CONIC_CLUSTER_REUSE_H

#include "lod/clusters/cluster_sites.h"

/* Puts this pass's lattices, owners and sites aside, as the last one's. */
void conic_cluster_end_pass(conic_sampler *sampler);

/* Called when new sites and owners have been found. A site is settled where all that it stands for, and all that lies
 * on the same faces, belongs to the same sites as in the last pass. It then takes over all that it had there. */
void conic_cluster_settle_sites(conic_sampler *sampler);

#endif
