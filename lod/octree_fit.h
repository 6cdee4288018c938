/* What stands for many: the position, ellipse, colour and bounds of every inner node. */
#ifndef LOD_OCTREE_FIT_H
#define LOD_OCTREE_FIT_H

#include "lod/moments.h"
#include "lod/octree.h"

/* Fills in the codes of all nodes, whose structure and leaves are there. Errors: MEMORY, CANCELLED. */
conic_status conic_octree_fit(conic_octree *octree);

/* How far a range of leaves reaches in a frame: what a node's bounds are made of. */
typedef struct conic_leaf_reach {
  double reach;  /* the major half axis of the least ellipse, of the frame's directions and ratio, that holds their
                    outlines */
  double radius; /* of the sphere that holds their outlines */
  double height; /* how far from the plane their outlines go */
  double cosine; /* the least of their normals to the frame's */
} conic_leaf_reach;

/* Widens *reach by the leaves begin … end. */
void conic_leaf_reach_add(const conic_splats *leaves, size_t begin, size_t end, double cutoff,
                          const conic_node_frame *frame, conic_leaf_reach *reach);

/* A disc: an ellipse in space with the two half axes of its outline. */
typedef struct conic_octree_disc {
  double center[3], u[3], v[3];
  double error; /* what it stands for is no farther from it */
} conic_octree_disc;

/* Where an ellipse is sampled: points of the unit disc, none of which is farther from all of them than the gap. */
enum { CONIC_DISC_SAMPLES = 48 };
#define CONIC_DISC_GAP 0.187
typedef struct conic_disc_samples {
  float x[CONIC_DISC_SAMPLES], y[CONIC_DISC_SAMPLES];
} conic_disc_samples;
void conic_disc_samples_init(conic_disc_samples *samples);

/* No point of the ellipse in the frame with the major half axis `reach` is farther than this from the nearest disc. */
double conic_octree_overshoot(const conic_disc_samples *samples, const conic_node_frame *frame, double reach,
                              const conic_octree_disc *discs, int n_discs);

#endif
