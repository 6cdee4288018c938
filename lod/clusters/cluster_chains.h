/* Chains: where two clusters meet, from one corner that a third has too to the next. A simpler cluster may leave out
 * what lies between a chain's ends. What a finer neighbour still has of it is put into both when they are drawn. */
#ifndef CONIC_CLUSTER_CHAINS_H
#define CONIC_CLUSTER_CHAINS_H

#include "lod/clusters/cluster.h"
#include "lod/clusters/cluster_border.h"

#define CONIC_NO_SLOT UINT32_MAX

/* Its vertices are slots[first … first + n), the ends among them; a closed one ends in the vertex where it begins. */
typedef struct conic_chain {
  uint32_t first, n;
  uint32_t clusters[2];
} conic_chain;

typedef struct conic_cluster_chains {
  size_t n_chains, n_slots;
  conic_chain *chains; /* each has something between its ends */
  conic_cluster_slot *slots;
  uint32_t *of_vertex; /* the slot of each place between a chain's ends; else CONIC_NO_SLOT */
} conic_cluster_chains;

/* Finds the chains between clusters of one region; what lies between regions is not simplified. `region` is by cluster.
 * All slots last for ever at first. On success the caller releases *chains; on failure it is empty. Errors: MEMORY. */
conic_status conic_cluster_chains_find(conic_context *context, const conic_clustered_mesh *mesh, const uint32_t *region,
                                       conic_cluster_chains *chains);
void conic_cluster_chains_release(conic_context *context, conic_cluster_chains *chains);

#endif
