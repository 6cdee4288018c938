/* The least error that so many splats can give, and the view of an octree. */

#include "core/image/viewpoint.h"
#include "lod/octree/octree_loops.h"
#include "lod/planner/plan.h"

typedef struct octree_opening {
  const conic_octree *octree;
  const conic_octree_view *view;
} octree_opening;

/* The way down to a node that is in sight. */
typedef struct budget_node {
  uint32_t end;
  float pixels;
  size_t i_opening;
} budget_node;

/* In preorder. */
static size_t open_nodes(const void *data, double low_px, conic_plan_opening *openings, uint64_t *n_first) {
  const octree_opening *o = data;
  const conic_octree *octree = o->octree;
  budget_node path[CONIC_OCTREE_DEPTH + 1];
  conic_measured measured = {0};
  size_t n = 0;
  int depth = 0;
  *n_first = 0;
  for (size_t i = 0; i < octree->n_nodes;) {
    float pixels = conic_octree_look_up(octree, o->view, i, &measured);
    while (depth > 0 && i >= path[depth - 1].end)
      depth--;
    if (pixels >= 0.0f && depth > 0)
      openings[path[depth - 1].i_opening].change++;
    else if (pixels >= 0.0f)
      ++*n_first;
    if (!((double)pixels > low_px)) {
      i = octree->end[i];
      continue;
    }
    float above = depth > 0 ? path[depth - 1].pixels : pixels, least = pixels < above ? pixels : above;
    openings[n] = (conic_plan_opening){(double)least, (int64_t)(octree->first_leaf[i + 1] - octree->first_leaf[i]) - 1};
    path[depth++] = (budget_node){octree->end[i], least, n++};
    i++;
  }
  return n;
}

conic_status conic_octree_fit_budget(const conic_octree *octree, const conic_octree_view *view, uint64_t budget,
                                     float *error_px) {
  const octree_opening opening = {octree, view};
  const conic_plan_tree tree = {&opening, octree->n_nodes, open_nodes};
  double found_px = 0.0;
  conic_status status = conic_plan_fit_tree(octree->context, &tree, budget, &found_px);
  *error_px = (float)found_px;
  return status;
}

/* --- the view --- */

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
