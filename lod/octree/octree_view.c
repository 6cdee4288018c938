#include "lod/octree/octree_view.h"

#include <math.h>
#include <string.h>

#include "core/image/viewpoint.h"
#include "lod/octree/octree_loops.h"

void conic_octree_view_init(const conic_octree *octree, const conic_camera *camera, const conic_render_options *render,
                            double near_z, conic_octree_view *view) {
  double margin = (double)render->kernel.cutoff * sqrt((double)render->prefilter) + 1.0, farthest = 0.0;
  conic_viewpoint from;
  conic_viewpoint_init(&from, camera, octree->leaves.origin, margin);
  memset(view, 0, sizeof *view);
  for (int row = 0; row < 3; row++) {
    view->translation[row] = (float)from.translation[row];
    view->eye[row] = (float)from.eye[row];
    farthest += fabs(from.translation[row]);
    for (int axis = 0; axis < 3; axis++)
      view->rotation[row][axis] = (float)from.rotation[row][axis];
  }
  for (int side = 0; side < 4; side++)
    for (int axis = 0; axis < 3; axis++)
      view->side[side][axis] = (float)from.side[side][axis];
  view->near_z = (float)near_z;
  view->focal_px = (float)(camera->fx > camera->fy ? camera->fx : camera->fy);
  view->slack = 1e-6f;
  view->slack_offset = (float)(1e-6 * farthest);
  view->cull_back = render->cull_back;
  conic_octree_loops loops;
  conic_octree_loops_init(&loops, render->isa);
  view->measure = loops.measure;
}
