/* The clusters of a mesh, one by one, and what their surface is at a place. */
#ifndef CONIC_CLUSTER_H
#define CONIC_CLUSTER_H

#include "conic/triangles.h"
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

#endif
