/* How large the errors of inner nodes are in one picture. */
#pragma once

#include "lod/octree/octree_nodes.h"

typedef struct conic_octree_view conic_octree_view;

/* Measures n nodes from `begin` on. pixels[k] is below 0 where nothing of node begin + k is in sight; infinite where it
 * reaches the near plane; else the most that its error can be on the screen, less where it is seen from its side. With
 * back culling it is that of the node's diameter where some of its leaves may face away. `pixels` has room for n
 * rounded up to whole groups. */
typedef void conic_measure_function(const conic_octree *octree, const conic_octree_view *view, size_t begin, size_t n,
                                    float *pixels);

/* A camera in floats. That loses less than `slack` times the coordinates, and every sphere is taken to be that much
 * larger.
 */
struct conic_octree_view {
  float rotation[3][3], translation[3], eye[3];
  float side[4][3]; /* the planes of the picture's sides, widened by the prefilter: unit normals, inwards, through the
                       eye */
  float near_z;
  float focal_px; /* the longer of the two */
  float slack, slack_offset;
  int cull_back;
  conic_measure_function *measure;
};

/* The machine must have the options' instruction set. */
void conic_octree_view_init(const conic_octree *octree, const conic_camera *camera, const conic_render_options *render,
                            double near_z, conic_octree_view *view);

/* Some nodes that were measured together: the walk down the tree will look at most of them. */
typedef struct conic_measured {
  size_t begin, end;
  float pixels[CONIC_OCTREE_GROUP];
} conic_measured;

/* What measuring gives for node i. Where that is not known yet, the node and those after it are measured, which is its
 * whole subtree if that is small. `measured` is zero before the first use. */
static inline float conic_octree_look_up(const conic_octree *octree, const conic_octree_view *view, size_t i,
                                         conic_measured *measured) {
  if (i < measured->begin || i >= measured->end) {
    size_t n = octree->n_nodes - i < CONIC_OCTREE_GROUP ? octree->n_nodes - i : CONIC_OCTREE_GROUP;
    view->measure(octree, view, i, n, measured->pixels);
    measured->begin = i;
    measured->end = i + n;
  }
  return measured->pixels[i - measured->begin];
}

/* Finds the least error for which no more than `budget` splats are chosen. Errors: MEMORY. */
conic_status conic_octree_fit_budget(const conic_octree *octree, const conic_octree_view *view, uint64_t budget,
                                     float *error_px);
