/* The clusters of a mesh: what their surface is at a place, and where they meet. */
#pragma once

#include "lod/mesh/mesh_clusters.h"

/* Splats that are drawn as what they are, beside a surface. In the mesh they are the last faces, two each: a rectangle
 * about the ellipse. A cluster has faces of one kind only. */
typedef struct conic_kept_splats {
  size_t n_surface;  /* faces before them */
  size_t n, n_discs; /* dots come after those */
  struct conic_surfel *items;
} conic_kept_splats;

typedef struct conic_clustered_mesh {
  const conic_triangles *triangles;
  conic_mesh mesh; /* the same */
  const conic_adjacency *adjacency;
  const conic_mesh_clusters *clusters;
  const uint32_t *faces;         /* of use, by cluster */
  const size_t *starts;          /* n_clusters + 1: those of cluster i are faces[starts[i] … starts[i + 1]) */
  const conic_kept_splats *kept; /* null: none */
} conic_clustered_mesh;

/* Whether what lies across that edge of a face is another cluster, or nothing. */
static inline int conic_cluster_ends_at(const conic_clustered_mesh *mesh, uint32_t face, int corner) {
  uint32_t across = mesh->adjacency->across[3 * (size_t)face + (size_t)corner];
  return !conic_edge_is_shared(across) || mesh->clusters->of_face[across / 3] != mesh->clusters->of_face[face];
}

/* Whether a cluster is of splats that are drawn as what they are. */
static inline int conic_cluster_is_kept(const conic_clustered_mesh *mesh, uint32_t cluster) {
  return mesh->kept && mesh->faces[mesh->starts[cluster]] >= mesh->kept->n_surface;
}

static inline int conic_cluster_are_dots(const conic_clustered_mesh *mesh, uint32_t cluster) {
  return conic_cluster_is_kept(mesh, cluster) &&
         mesh->faces[mesh->starts[cluster]] >= mesh->kept->n_surface + 2 * mesh->kept->n_discs;
}

/* The mean length of a cluster's edges, and the mean of its faces' areas. */
double conic_cluster_edge_length(const conic_clustered_mesh *mesh, uint32_t cluster);

/* Unit normal of a face's plane, on the side that its neighbours agree upon; zero where it has no area. */
void conic_cluster_face_normal(const conic_clustered_mesh *mesh, uint32_t face, double normal[3]);

/* What a face has at barycentric coordinates: the place (from the origin); the normal that it is shaded with, not unit,
 * on the side of `facing`; and the colour without the texture. */
void conic_cluster_place(const conic_clustered_mesh *mesh, uint32_t face, const double bary[3], double place[3]);
void conic_cluster_normal(const conic_clustered_mesh *mesh, uint32_t face, const double bary[3], const double facing[3],
                          double normal[3]);
void conic_cluster_color(const conic_clustered_mesh *mesh, uint32_t face, const double bary[3], double color[3]);

/* The texture at a place, with which the colour is multiplied. It is filtered over a square of that side on the face,
 * and white where there is no texture. */
void conic_cluster_texel(const conic_clustered_mesh *mesh, uint32_t face, const double bary[3], double side,
                         double color[3]);

/* --- where clusters meet --- */

/* A vertex where two clusters meet. Each cluster has one of its own there; the lower cluster's is the first. `stage` is
 * the last stage of simplification at which it is still there. */
typedef struct conic_cluster_slot {
  uint32_t vertices[2], stage;
} conic_cluster_slot;

#define CONIC_CLUSTER_ALWAYS UINT32_MAX

/* An edge of a level's triangle along which vertices were left out. Where the cluster across still has some of them,
 * they are put in when both are drawn. */
typedef struct conic_cluster_border {
  uint32_t edge;     /* 4 · triangle, from the level's first, + the corner where the edge begins */
  uint32_t from, to; /* slots of its two ends, in a model of the cluster's own; what was left out is between */
  uint32_t across;   /* the other cluster */
} conic_cluster_border;

/* --- chains --- */

#define CONIC_NO_SLOT UINT32_MAX

/* A chain is where two clusters meet, from one corner that a third has too to the next. Its vertices are slots[first …
 * first + n), the ends among them. A closed one ends in the vertex where it begins. */
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
