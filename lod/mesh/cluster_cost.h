/* Sums that describe a set of faces, and add up when two sets become one; and the cost of making them one (HQP §3.2.2).
 * All lengths are in units of the longest side of the mesh's box, about its middle. */
#ifndef CONIC_CLUSTER_COST_H
#define CONIC_CLUSTER_COST_H

#include "lod/mesh/mesh.h"

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

#endif
