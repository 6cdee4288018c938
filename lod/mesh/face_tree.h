/* Boxes around boxes around a mesh's faces: how far a place is from the nearest. Where thousands of faces are about as
 * near, a search ends early, and its distance is an upper bound. */
#pragma once

#include "lod/mesh/mesh.h"

typedef struct conic_face_box {
  float low[3], high[3];
} conic_face_box;

typedef struct conic_face_tree {
  const conic_mesh *mesh;
  size_t n_faces, n_leaves; /* leaves: a power of two */
  uint32_t *faces;          /* along a curve that fills space */
  float (*corners)[3][3];   /* of each of these, side by side: a leaf is in few lines of the cache */
  conic_face_box *boxes;    /* from 1 on; the children of node i are 2i and 2i + 1, leaves begin at n_leaves */
} conic_face_tree;

/* Takes the faces that are of use, and of several at the same places the first. The mesh must outlive the tree. Errors:
 * MEMORY. */
conic_status conic_face_tree_build(conic_context *context, const conic_mesh *mesh, const conic_adjacency *adjacency,
                                   conic_face_tree *tree);
void conic_face_tree_release(conic_context *context, conic_face_tree *tree);

/* How far the place is from the nearest face; or `known`, where that is more. */
double conic_face_tree_farther(const conic_face_tree *tree, const double at[3], double known);

/* The same. It is quicker where `guess` is a face that is near. */
double conic_face_tree_farther_by(const conic_face_tree *tree, const double at[3], uint32_t guess, double known);

/* How far the place is from the nearest face, where that is more than `enough`. Else a number from that to `enough`. It
 * is quicker where *near is a face that is near; *near becomes the face that was found to be as near as the result. */
double conic_face_tree_bound(const conic_face_tree *tree, const double at[3], uint32_t *near, double enough);

/* How far the place is from that face of the mesh: infinite where the face has no area and no distance. */
double conic_face_distance(const conic_mesh *mesh, uint32_t face, const double at[3]);
