/* What stands for many: the position, ellipse, colour and bounds of every inner node. */
#ifndef LOD_OCTREE_FIT_H
#define LOD_OCTREE_FIT_H

#include "lod/moments.h"
#include "lod/octree.h"

/* Fills in the codes of all nodes, whose structure and leaves are there. Errors: MEMORY, CANCELLED. */
conic_status conic_octree_fit(conic_octree *octree);

/* How far a range of leaves reaches in a frame: what a node's bounds are made of. */
typedef struct conic_leaf_reach {
  double reach;  /* the major half axis of an ellipse of the frame's directions and ratio that holds their outlines;
                    the least is smaller by 2 % at most */
  double radius; /* of the sphere that holds their outlines */
  double height; /* how far from the plane their outlines go */
  double cosine; /* the least of their normals to the frame's */
} conic_leaf_reach;

/* Widens *reach by the leaves begin … end. */
void conic_leaf_reach_add(const conic_splats *leaves, size_t begin, size_t end, double cutoff,
                          const conic_node_frame *frame, conic_leaf_reach *reach);

/* Raises the errors that conic_octree_fit has left, which tell of the leaves' heights and the node's size alone, to how
 * far its disc reaches past the surface. Errors: MEMORY, CANCELLED. */
conic_status conic_octree_find_errors(conic_octree *octree);

#endif
