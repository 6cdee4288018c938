/* Clusters of faces. At first what is flat together is joined, and then what is small is gathered (HQP §3.2). */
#pragma once

#include "lod/mesh/mesh.h"

/* --- what joining two sets of faces costs (HQP §3.2.2) --- */

/* Sums that describe a set of faces, and add up when two sets become one. All lengths are in units of the longest side
 * of the mesh's box, about its middle. */
typedef struct conic_face_sums {
  double area;
  double first[3];   /* ∫ x dA */
  double second[6];  /* ∫ x xᵀ dA: xx, xy, xz, yy, yz, zz */
  double normal[3];  /* Σ area · n */
  double normals[6]; /* Σ area · n nᵀ */
  double outline;    /* the length of the edges that have a face of the set on one side only */
} conic_face_sums;

/* Turns lengths and places of a mesh into those units. */
typedef struct conic_unit_box {
  double middle[3], scale;
} conic_unit_box;

conic_unit_box conic_unit_box_of(const conic_mesh *mesh, const conic_adjacency *adjacency);

/* The sums of one face that is of use. */
conic_face_sums conic_face_sums_of(const conic_mesh *mesh, const conic_adjacency *adjacency, const conic_unit_box *box,
                                   size_t i_face);

/* The sums of both together. `shared` is the length of the edges between them. */
conic_face_sums conic_face_sums_join(const conic_face_sums *a, const conic_face_sums *b, double shared);

/* Finds the plane that the faces lie on best, by least squares over their area: n·x + d = 0, with n towards the side
 * that they face. Where that leaves the direction open (a needle, a point), n is the mean normal. */
void conic_face_sums_plane(const conic_face_sums *sums, double normal[3], double *d);

/* The square of how many times longer the outline is than that of a disc of this area. */
double conic_face_sums_raggedness(const conic_face_sums *sums);

/* The parts of a cost. Two sets without any area cost nothing. */
typedef struct conic_joining_cost {
  double fit;       /* mean squared distance from the plane */
  double direction; /* mean of (1 - n·nᵢ)² */
  double shape;     /* how much more ragged the whole is than both parts, over its own raggedness: -1 to 1 */
  double size;      /* its area over the largest that a cluster of the first phase may have */
} conic_joining_cost;

/* The cost comes in two steps, as the plane takes most of the time. The first gives shape and size, and the sums of
 * both sets. The second gives fit and direction, which are 0 before and never below 0. */
conic_joining_cost conic_joining_cost_without_plane(const conic_face_sums *a, const conic_face_sums *b, double shared,
                                                    double largest_area, conic_face_sums *both);
void conic_joining_cost_add_plane(const conic_face_sums *both, conic_joining_cost *cost);

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
