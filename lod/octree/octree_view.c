#include "lod/octree/octree_view.h"

#include <math.h>
#include <string.h>

#include "lod/octree/octree_kernels.h"

/* The plane through the eye and a side of the picture: points with a·x + b·z ≥ 0 are inside. */
static void set_octree_side(float side[3], int axis, double a, double b) {
  double length = sqrt(a * a + b * b);
  side[0] = side[1] = 0.0f;
  side[axis] = (float)(a / length);
  side[2] = (float)(b / length);
}

void conic_octree_view_init(const conic_octree *octree, const conic_camera *camera, const conic_render_options *render,
                            double near_z, conic_octree_view *view) {
  const double *origin = octree->leaves.origin;
  double translation[3], margin = (double)render->kernel.cutoff * sqrt((double)render->prefilter) + 1.0, farthest = 0.0;
  memset(view, 0, sizeof *view);
  for (int row = 0; row < 3; row++) {
    const double *m = camera->cam_from_world[row];
    translation[row] = ((m[0] * origin[0] + m[1] * origin[1]) + m[2] * origin[2]) + m[3];
    view->translation[row] = (float)translation[row];
    farthest += fabs(translation[row]);
    for (int axis = 0; axis < 3; axis++)
      view->rotation[row][axis] = (float)m[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    view->eye[axis] =
        (float)-((camera->cam_from_world[0][axis] * translation[0] + camera->cam_from_world[1][axis] * translation[1]) +
                 camera->cam_from_world[2][axis] * translation[2]);
  set_octree_side(view->side[0], 0, camera->fx, camera->cx + margin);
  set_octree_side(view->side[1], 0, -camera->fx, (double)camera->width + margin - camera->cx);
  set_octree_side(view->side[2], 1, camera->fy, camera->cy + margin);
  set_octree_side(view->side[3], 1, -camera->fy, (double)camera->height + margin - camera->cy);
  view->near_z = (float)near_z;
  view->focal_px = (float)(camera->fx > camera->fy ? camera->fx : camera->fy);
  view->slack = 1e-6f;
  view->slack_offset = (float)(1e-6 * farthest);
  view->cull_back = render->cull_back;
  conic_octree_kernels kernels;
  conic_octree_kernels_init(&kernels, render->isa);
  view->measure = kernels.measure;
}
