/* Surfels of a cluster: splats that stand for its faces. */
#pragma once

#include "lod/clusters/cluster_seen.h"
#include "lod/mesh/face_tree.h"

typedef struct conic_surfel {
  float position[3]; /* from the mesh's origin */
  float tangent_u[3], tangent_v[3];
  float color[3];
  uint32_t face; /* of the mesh, near it */
} conic_surfel;

typedef struct conic_surfels {
  size_t n, room;
  conic_surfel *items;
  /* No point of the faces is farther from the surfel that stands for it. Nor is a surfel's outline from the mesh, as
   * measured at forty places. */
  double error;
  double refined_error;     /* the same as measured at the twenty places by which surfels are laid closer or not */
  conic_seen_change change; /* how the faces' colours differ from those of the surfels, in the root mean square */
  double reach;             /* the longest half axis of an outline */
  int is_out;               /* an outline is farther from the mesh than the job's `most_out` */
  int is_coarsest;          /* no wider spacing gives fewer */
  int are_dots;             /* turned to each camera */
} conic_surfels;

typedef struct conic_sampling_job {
  const conic_clustered_mesh *mesh;
  const conic_face_tree *tree; /* of all its faces */
  uint32_t cluster;
  double spacing;   /* no two surfels that face alike are nearer than this, but where the surface needs closer ones */
  double tolerance; /* surfels whose error is larger are made of closer ones, */
  size_t most;      /* as long as there are no more than these */
  double most_out;  /* how far outlines may be from the mesh; infinite: nobody asks */
  size_t useful;    /* the caller has no use for more, and need not know how far these err */
  int is_coarser;   /* the job before was the same cluster's, at half the spacing */
  int is_off_mesh;  /* what sites stand for lies near the mesh, but not on it */
  double cutoff;    /* standard deviations at which a splat ends */
} conic_sampling_job;

/* Memory that is kept from cluster to cluster. Zero before the first use. */
typedef struct conic_sampler conic_sampler;
conic_status conic_sampler_create(conic_context *context, conic_sampler **sampler);
void conic_sampler_destroy(conic_sampler *sampler);

/* Area-weighted blue noise: places at random, none nearer to another than the spacing, until no more go in. Those on
 * the cluster's border to triangles or to nothing come first. Each stands for what is nearest to it, and its ellipse
 * covers that. Together they cover every face whole. Appends to *surfels. Errors: MEMORY. */
conic_status conic_cluster_sample(conic_sampler *sampler, const conic_sampling_job *job, conic_surfels *surfels);

/* For comparison, surfels as in HQP §3.3.2: circles of √3 spacings, where the faces are met by the lines of a grid of
 * that spacing along each of the three axes. Appends to *surfels. Errors: MEMORY. */
conic_status conic_cluster_sample_box(conic_context *context, const conic_sampling_job *job, conic_surfels *surfels);

/* Room for one more. Errors: MEMORY. */
conic_status conic_surfels_reserve(conic_context *context, conic_surfels *surfels);
void conic_surfels_release(conic_context *context, conic_surfels *surfels);
