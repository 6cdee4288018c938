/* Building hybrid models: what its steps hand to each other. */
#pragma once

#include "lod/clusters/cluster_sample.h"
#include "lod/clusters/cluster_simplify.h"
#include "lod/hybrid/model/hybrid_model.h"

/* --- ways to draw a cluster --- */

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
  double most_error;    /* above 0: clusters have no ways but their faces; the whole has, up to one that errs by more */
  size_t n_clusters;    /* the first ones are the model's; the others lie beside them and stay */
  conic_face_tree tree; /* private */
  double most_out;      /* private: how far surfels as built may stand out from the mesh; infinite: by any length */
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

/* conic_hybrid_build of a mesh that stays the caller's. With most_error above 0, which is for one picture, without
 * clusters: the model has the mesh's triangles, and for the whole levels of half as many each, down to the first that
 * errs by more. Errors: as conic_hybrid_build. */
conic_status conic_hybrid_build_lent(conic_context *context, const conic_triangles *mesh,
                                     const conic_hybrid_options *options, double most_error, conic_hybrid **hybrid);

/* conic_hybrid_build of the first n_own faces, without levels of the whole. The other faces lie beside these. They stay
 * as they are and are not in the model, but they are part of the surface: where they meet the model's faces, no vertex
 * is left out. Errors: as conic_hybrid_build. */
conic_status conic_hybrid_build_part(conic_context *context, conic_triangles *mesh, size_t n_own,
                                     const conic_hybrid_options *options, conic_hybrid **hybrid,
                                     conic_hybrid_report *report);

/* --- splats that stay what they are --- */

/* conic_hybrid_build of a mesh whose last faces stand for splats; `kept` may be null. */
conic_status conic_hybrid_build_with(conic_context *context, conic_triangles *mesh, const conic_kept_splats *kept,
                                     const conic_hybrid_options *options, conic_hybrid **hybrid,
                                     conic_hybrid_report *report);

/* --- meshes that are larger than memory --- */

/* About so many faces are simplified together. */
enum { CONIC_HYBRID_CELL_FACES = 200000 };

/* conic_hybrid_build_file with cells of about `most_faces`, on which the model depends. */
conic_status conic_hybrid_build_cells(conic_context *context, const char *mesh, const char *path,
                                      const conic_hybrid_options *options, const conic_hybrid_streaming *streaming,
                                      size_t most_faces, conic_hybrid **hybrid, conic_hybrid_report *report);

/* --- nodes over the clusters --- */

/* Makes job->nodes over the clusters, whose ways are known. But for single levels and boxes, each node gets its point,
 * and surfels that stand for all of its clusters. A node's surfel stands for some of the clusters' surfels that are
 * close together, as a cluster's surfel does for faces. The caller releases all, on failure too. Errors: MEMORY,
 * CANCELLED. */
conic_status conic_find_nodes(conic_ways_job *job);
void conic_nodes_release(conic_ways_job *job);

/* --- the model in one piece of memory --- */

/* Makes the model of all that was found. The caller owns what there is of *hybrid, on failure too. Errors: ARGUMENT
 * (too much for a file), MEMORY. */
conic_status conic_hybrid_pack(const conic_ways_job *ways, conic_hybrid **hybrid);
