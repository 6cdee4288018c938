/* Patches through the vertices of a mesh, with its normals. */
#pragma once

#include "conic/triangles.h"
#include "surface/patches/patch.h"

/* The corners of triangles by the slots of their places. A *side* of a vertex is what has one normal there: all of it
 * where the mesh is smooth, one of several at a crease. */
typedef struct conic_patch_mesh {
  const conic_triangles *triangles;
  uint32_t *slots;    /* of each vertex */
  size_t *starts;     /* of each slot, in `corners` */
  uint32_t *corners;  /* by slot, side by side: 3 × triangle + corner */
  uint8_t *n_sides;   /* of each slot; 0: nothing smooth is there */
  uint8_t *is_smooth; /* by slot: there is one side, which closes around it; null: there is no mesh */
} conic_patch_mesh;

/* Sorts the corners into the slots of `tree`, whose places are relative to the origin. `triangles` may be null. The
 * caller releases *mesh whether this succeeds or not. Errors: MEMORY, CANCELLED. */
conic_status conic_patch_mesh_create(conic_context *context, const conic_triangles *triangles,
                                     const conic_neighbours *tree, const double origin[3], conic_patch_mesh *mesh);
void conic_patch_mesh_release(conic_context *context, conic_patch_mesh *mesh);

/* A triangle from one of its corners: the places and normals of the others, from and beside the corner's own. */
typedef struct conic_patch_corner {
  uint32_t slots[3];
  double offsets[3][3], normals[3][3];
  double across[3]; /* the triangle's unit normal, on the corner's normal's side */
} conic_patch_corner;

/* Reads a corner. Returns 0 for a triangle without area, or without a normal. */
int conic_patch_mesh_corner(const conic_patch_mesh *mesh, uint32_t number, conic_patch_corner *corner);

/* Where the side ends, in `corners`, that begins at `begin`; no farther than `end`. */
size_t conic_patch_mesh_side_end(const conic_patch_mesh *mesh, size_t begin, size_t end);

/* Whether the triangles of a side are not steep to its normal, and close about the vertex or lie between two edges:
 * rays[] are corners there, and others[] says which of a corner's others the edge leads to, 1 or 2. Returns how many
 * edges there are; -1 where it is neither. */
int conic_patch_mesh_bound_side(const conic_patch_mesh *mesh, size_t begin, size_t end, uint32_t rays[2],
                                int others[2]);

/* Fits the polynomial of a side of a slot's vertex, and finds its fence, and the half axes of the patch's ellipse,
 * which lie along the frame's first two rows; the first, which is the longer, is the fit's unit. Returns 0 where the
 * side has none. */
int conic_patch_mesh_fit(const conic_patch_mesh *mesh, size_t vertex, size_t begin, size_t end, int degree,
                         conic_fit *to, double radii[2], conic_patch_fence *fence);

/* The steepest slope of the polynomial in eight places on an ellipse, all in units of h. */
double conic_fit_steepest(const conic_fit *fit, int degree, double radius_x, double radius_y);
