/* All ways to draw one cluster. */
#ifndef CONIC_HYBRID_LEVELS_H
#define CONIC_HYBRID_LEVELS_H

#include "lod/clusters/cluster_sample.h"
#include "lod/clusters/cluster_simplify.h"
#include "lod/hybrid/model/hybrid_model.h"

enum { CONIC_MOST_SURFEL_LEVELS = 8 };

typedef struct conic_cluster_ways {
  conic_cluster_levels triangles; /* the simpler ones; the faces themselves come before them */
  int is_surfels;                 /* as built: the first of those below */
  int n_surfels;
  conic_surfels surfels[CONIC_MOST_SURFEL_LEVELS];
  conic_hybrid_bound bound;
  double area;
} conic_cluster_ways;

enum { CONIC_MOST_NODE_LEVELS = 3 };

typedef struct conic_node_ways {
  int n_surfels;
  conic_surfels surfels[CONIC_MOST_NODE_LEVELS];
} conic_node_ways;

typedef struct conic_ways_job {
  conic_context *context;
  const conic_clustered_mesh *mesh;
  const conic_hybrid_options *options;
  size_t n_clusters;        /* the first ones are the model's; the others lie beside them and stay */
  conic_face_tree tree;     /* private */
  double most_out;          /* private: how far surfels as built may stand out from the mesh; infinite: by any length */
  conic_cluster_ways *ways; /* of each cluster; zero before */
  /* The caller releases these four by conic_nodes_release. */
  size_t n_nodes;
  conic_hybrid_node *nodes;    /* over the clusters, with their points but not yet with levels */
  conic_node_ways *node_ways;  /* null where nodes have none */
  conic_cluster_levels whole;  /* simpler triangles of all clusters as one, for the root */
  conic_cluster_chains chains; /* between simpler triangles of clusters; the caller releases them, on failure too */
  double sample_seconds, simplify_seconds;
} conic_ways_job;

/* Finds the ways of all clusters, on all threads. The caller releases what is in `ways`, on failure too. Errors:
 * MEMORY, CANCELLED. */
conic_status conic_find_ways(conic_ways_job *job);
void conic_cluster_ways_release(conic_context *context, conic_cluster_ways *ways);

/* Simpler triangles of all clusters, region by region, and of all as one; these depend on the mesh alone. Errors:
 * MEMORY, CANCELLED. */
conic_status conic_find_simpler(conic_ways_job *ways);
conic_status conic_find_whole(conic_ways_job *ways);

/* A sphere and a cone for a cluster's faces. */
conic_hybrid_bound conic_cluster_bound(const conic_clustered_mesh *mesh, uint32_t cluster);

#endif
