/* The least error that so many splats can give. */

#include "core/base/base.h"
#include "core/image/viewpoint.h"
#include "lod/octree/octree_loops.h"
#include "lod/octree/octree_view.h"

/* A node gives way to its children once the error asked for is below `pixels`: its own and those of all nodes above,
 * for these have given way before. Then there are `change` more splats. */
typedef struct opening {
  uint32_t pixels; /* the bits of a float that is not negative, which order like it */
  int32_t change;
} opening;

/* The way down to a node that is in sight. */
typedef struct budget_node {
  uint32_t end;
  float pixels;
  size_t i_opening;
} budget_node;

/* Every node in sight, in preorder. Returns how many there are. */
static size_t list_openings(const conic_octree *octree, const conic_octree_view *view, opening *openings) {
  budget_node path[CONIC_OCTREE_DEPTH + 1];
  conic_measured measured = {0};
  size_t n = 0;
  int depth = 0;
  for (size_t i = 0; i < octree->n_nodes;) {
    float pixels = conic_octree_look_up(octree, view, i, &measured);
    while (depth > 0 && i >= path[depth - 1].end)
      depth--;
    if (pixels < 0.0f) {
      i = octree->end[i];
      continue;
    }
    float above = depth > 0 ? path[depth - 1].pixels : pixels, least = pixels < above ? pixels : above;
    if (depth > 0)
      openings[path[depth - 1].i_opening].change++;
    openings[n] =
        (opening){conic_bits_of_float(least), (int32_t)(octree->first_leaf[i + 1] - octree->first_leaf[i]) - 1};
    path[depth++] = (budget_node){octree->end[i], least, n++};
    i++;
  }
  return n;
}

/* Sorts by falling pixels, and keeps the order of equals. `other` has room for as many. */
static void sort_openings(opening *openings, opening *other, size_t n) {
  enum { DIGIT_BITS = 11, N_DIGITS = 1 << DIGIT_BITS };
  for (int shift = 0; shift < 33; shift += DIGIT_BITS) {
    size_t places[N_DIGITS] = {0}, place = 0;
    for (size_t i = 0; i < n; i++)
      places[openings[i].pixels >> shift & (N_DIGITS - 1)]++;
    for (int digit = N_DIGITS - 1; digit >= 0; digit--) {
      size_t count = places[digit];
      places[digit] = place;
      place += count;
    }
    for (size_t i = 0; i < n; i++)
      other[places[openings[i].pixels >> shift & (N_DIGITS - 1)]++] = openings[i];
    memcpy(openings, other, n * sizeof *openings);
  }
}

conic_status conic_octree_fit_budget(const conic_octree *octree, const conic_octree_view *view, uint64_t budget,
                                     float *error_px) {
  conic_context *context = octree->context;
  opening *openings = conic_memory_allocate(context, octree->n_nodes + 1, sizeof *openings);
  opening *other = conic_memory_allocate(context, octree->n_nodes + 1, sizeof *other);
  conic_status status = openings && other ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    size_t n = list_openings(octree, view, openings);
    int64_t count = 1;
    uint32_t best = n ? openings[0].pixels : 0;
    sort_openings(openings, other, n);
    for (size_t i = 0; i < n; i++) { /* before all that have these pixels give way, so many are chosen: */
      if ((i == 0 || openings[i].pixels < openings[i - 1].pixels) && count <= (int64_t)budget)
        best = openings[i].pixels;
      count += openings[i].change;
    }
    if (count <= (int64_t)budget)
      best = 0;
    *error_px = conic_float_of_bits(best);
  }
  conic_memory_release_these(context, openings, other);
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
