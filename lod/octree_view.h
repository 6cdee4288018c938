/* How large the errors of inner nodes are in one picture. */
#ifndef LOD_OCTREE_VIEW_H
#define LOD_OCTREE_VIEW_H

#include "lod/octree.h"

/* A camera in floats. What that loses is less than `slack` times the coordinates, and every sphere is that much larger.
 */
typedef struct conic_octree_view {
  float rotation[3][3], translation[3], eye[3];
  float side[4][3]; /* the planes of the picture's sides, widened by the prefilter: unit normals, inwards, through the
                       eye */
  float near_z;
  float focal_px; /* the longer of the two */
  float slack, slack_offset;
  int cull_back;
} conic_octree_view;

void conic_octree_view_init(const conic_octree *octree, const conic_camera *camera, const conic_render_options *render,
                            double near_z, conic_octree_view *view);

/* For the nodes begin … end: pixels[i] is below 0 where nothing of the node is in sight, else the most that its error
 * can be on the screen, which is infinite where it reaches the near plane. */
void conic_octree_measure(const conic_octree *octree, const conic_octree_view *view, size_t begin, size_t end,
                          float *pixels);

/* Whether the node's own disc does. */
int conic_octree_faces_away(const conic_octree *octree, const conic_octree_view *view, size_t i);

/* The least error that `budget` splats can give: the least for which no more are chosen. Errors: MEMORY. */
conic_status conic_octree_fit_budget(const conic_octree *octree, const conic_octree_view *view, uint64_t budget,
                                     float *pixels, float *error_px);

#endif
