/* Clusters of faces. At first what is flat together is joined, and then what is small is gathered (HQP §3.2). */
#ifndef CONIC_MESH_CLUSTERS_H
#define CONIC_MESH_CLUSTERS_H

#include "lod/mesh/cluster_cost.h"

#define CONIC_NO_CLUSTER UINT32_MAX

typedef struct conic_clustering_options {
  double phase1;    /* at first clusters are joined up to this fit + direction + shape */
  double phase2;    /* and then up to this shape + size */
  double most_area; /* no cluster of the first phase has a larger share of the whole area */
} conic_clustering_options;

typedef struct conic_mesh_clusters {
  uint32_t *of_face; /* cluster of each face, or CONIC_NO_CLUSTER where it is of no use */
  size_t n_clusters;
  size_t n_first;        /* clusters after the first phase */
  uint8_t *is_gathered;  /* of each: made by the second phase */
  conic_face_sums *sums; /* of each, as kept while joining */
  size_t n_evaluations;  /* costs that were computed */
} conic_mesh_clusters;

/* Clusters are numbered by their first faces. On success the caller releases *clusters; on failure it is empty. Errors:
 * MEMORY, CANCELLED. */
conic_status conic_mesh_clusters_find(conic_context *context, const conic_mesh *mesh, const conic_adjacency *adjacency,
                                      const conic_clustering_options *options, conic_mesh_clusters *clusters);
void conic_mesh_clusters_release(conic_context *context, conic_mesh_clusters *clusters);

#endif
