#include "surface/densify_triangles.h"

#include "core/base/team_runs.h"
#include "core/base/vectors.h"
#include "surface/fan.h"

/* Chunks of leaves, and of points. */
enum { CHUNK = 16, FANS = 64, CHUNKS_A_REPORT = 256 };

/* If the caller sets no hole, circles up to this many h are none: the outlines of splats close them. */
static const double HOLE = 1.25;

/* A neighbour farther away than this many of its own h is joined to a stray point, whose h says nothing of the surface:
 * h changes by less between neighbours of a scan. */
static const double FARTHEST = 16.0;

/* Where strays are joined to each other, the set's median h is left to tell; this many of it are no gap. */
static const double FARTHEST_OF_ALL = 1024.0;

/* The least cosine between the normals of a triangle and of a corner for which the triangle can stand for the
 * surface. */
static const double LEAST_AGREEMENT = 0.5;

typedef struct triangle_search {
  conic_densify_triangles *found;
  const conic_densify_options *options;
  conic_workspace *workspaces;
  conic_fan *fans; /* by slot */
} triangle_search;

/* --- normals --- */

/* The surface's normal at a slot, or the sample's where nothing can be projected. */
static void find_normal(triangle_search *search, uint32_t slot, conic_workspace *workspace) {
  const conic_surface *surface = search->found->surface;
  const conic_neighbours *tree = &surface->tree;
  const double r[3] = {(double)tree->position[0][slot], (double)tree->position[1][slot],
                       (double)tree->position[2][slot]};
  conic_landing landing;
  double side[3], color[3];
  float own[3];
  for (int axis = 0; axis < 3; axis++)
    own[axis] = surface->normal[0] ? surface->normal[axis][slot] : 0.0f;
  workspace->side = surface->normal[0] ? own : NULL;
  conic_surface_project_one(surface, r, (double)surface->h[slot], CONIC_NO_SLOT, 1, workspace, &landing);
  conic_surface_attributes(surface, workspace, side, color);
  workspace->side = NULL;
  int is_landed = landing.outcome == CONIC_SURFACE_DONE;
  double sign = conic_dot(side, landing.normal) < 0.0 ? -1.0 : 1.0;
  for (int axis = 0; axis < 3; axis++)
    search->found->normals[slot][axis] = is_landed ? (float)(sign * landing.normal[axis]) : own[axis];
}

static void find_normals(void *data, size_t i_item, int i_thread) {
  triangle_search *search = data;
  const conic_neighbours *tree = &search->found->surface->tree;
  conic_workspace *workspace = &search->workspaces[i_thread];
  for (size_t i = i_item * CHUNK; i < (i_item + 1) * CHUNK && i < tree->n_leaves; i++) {
    conic_surface_share_leaf(search->found->surface, i, workspace);
    for (size_t slot = conic_neighbours_leaf_begin(tree, i); slot < conic_neighbours_leaf_begin(tree, i + 1); slot++)
      find_normal(search, (uint32_t)slot, workspace);
  }
}

static size_t first_slot_of_leaves(const void *data, size_t i_item) {
  const conic_neighbours *tree = &((const triangle_search *)data)->found->surface->tree;
  return conic_neighbours_leaf_begin(tree, i_item * CHUNK < tree->n_leaves ? i_item * CHUNK : tree->n_leaves);
}

/* --- triangles of neighbours --- */

/* Takes triangles out whose corners are too far away for the neighbours' h. */
static void leave_strays_out(const conic_surface *surface, uint32_t slot, conic_fan *fan) {
  double at[3];
  int n = 0;
  conic_vector_at(surface->tree.position, slot, at);
  for (int i = 0; i < fan->n; i++) {
    int is_near = 1;
    for (int k = 0; k < 2; k++) {
      uint32_t other = fan->pairs[i][k];
      double most = FARTHEST * (double)surface->h[other];
      is_near &= conic_neighbours_distance2(&surface->tree, other, at) <= most * most;
    }
    if (is_near)
      memcpy(fan->pairs[n++], fan->pairs[i], sizeof fan->pairs[0]);
  }
  fan->n = n;
}

static void find_fans(void *data, size_t i_item) {
  triangle_search *search = data;
  const conic_surface *surface = search->found->surface;
  for (size_t slot = i_item * FANS; slot < (i_item + 1) * FANS && slot < surface->tree.n_slots; slot++) {
    double widest = FARTHEST_OF_ALL * (double)surface->median_h, own = HOLE * (double)surface->h[slot], normal[3];
    double most = search->options->hole > 0.0 ? search->options->hole : own < widest ? own : widest;
    for (int axis = 0; axis < 3; axis++)
      normal[axis] = (double)search->found->normals[slot][axis];
    search->fans[slot].n = 0;
    if (conic_normalize(normal) && most > 0.0)
      conic_fan_find(&surface->tree, surface->normal[0] ? surface->normal : NULL, (uint32_t)slot, normal, most,
                     &search->fans[slot]);
    if (!(search->options->hole > 0.0))
      leave_strays_out(surface, (uint32_t)slot, &search->fans[slot]);
  }
}

static int has_triangle(const conic_fan *fan, uint32_t a, uint32_t b) {
  for (int i = 0; i < fan->n; i++)
    if ((fan->pairs[i][0] == a && fan->pairs[i][1] == b) || (fan->pairs[i][0] == b && fan->pairs[i][1] == a))
      return 1;
  return 0;
}

/* Whether this slot lists a triangle of its fan: it is the first corner whose fan has it. */
static int lists(const triangle_search *search, uint32_t slot, const uint32_t pair[2]) {
  for (int i = 0; i < 2; i++)
    if (pair[i] < slot && has_triangle(&search->fans[pair[i]], slot, pair[1 - i]))
      return 0;
  return 1;
}

static conic_status list_fans(triangle_search *search) {
  conic_densify_triangles *found = search->found;
  size_t n_slots = found->surface->tree.n_slots, n_most = 0;
  for (size_t slot = 0; slot < n_slots; slot++)
    n_most += (size_t)search->fans[slot].n;
  found->corners = conic_memory_allocate(found->surface->context, n_most, sizeof *found->corners);
  if (!found->corners)
    return CONIC_ERROR_MEMORY;
  for (size_t slot = 0; slot < n_slots; slot++)
    for (int i = 0; i < search->fans[slot].n; i++) {
      const uint32_t *pair = search->fans[slot].pairs[i];
      if (!lists(search, (uint32_t)slot, pair))
        continue;
      const uint32_t corners[3] = {(uint32_t)slot, pair[0], pair[1]};
      memcpy(found->corners[found->n++], corners, sizeof corners);
    }
  return CONIC_OK;
}

static conic_status triangulate(triangle_search *search) {
  const conic_surface *surface = search->found->surface;
  conic_context *context = surface->context;
  search->fans = conic_memory_allocate(context, surface->tree.n_slots, sizeof *search->fans);
  if (!search->fans)
    return CONIC_ERROR_MEMORY;
  conic_team_loop loop =
      conic_team_loop_of("densify", 0.0, 0.0, surface->tree.n_slots, FANS, CHUNKS_A_REPORT, find_fans, search);
  loop.columns[0] = (conic_team_column){search->fans, sizeof *search->fans};
  conic_status status = conic_team_runs(context, &loop);
  if (status == CONIC_OK)
    status = list_fans(search);
  conic_memory_release(context, search->fans);
  return status;
}

/* --- triangles of a mesh --- */

static conic_status take_triangles(triangle_search *search) {
  conic_densify_triangles *found = search->found;
  const uint32_t *slot_of_point = found->surface->tree.slot_of_point;
  found->are_given = 1;
  found->corners = conic_memory_allocate(found->surface->context, search->options->n_triangles, sizeof *found->corners);
  if (!found->corners)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < search->options->n_triangles; i++) {
    uint32_t *slots = found->corners[found->n];
    for (int k = 0; k < 3; k++)
      slots[k] = slot_of_point[search->options->triangles[i][k]];
    found->n += slots[0] != CONIC_NO_SLOT && slots[1] != CONIC_NO_SLOT && slots[2] != CONIC_NO_SLOT &&
                slots[0] != slots[1] && slots[1] != slots[2] && slots[2] != slots[0];
  }
  return CONIC_OK;
}

/* --- all --- */

static conic_status measure_triangles(conic_densify_triangles *found) {
  found->reaches = conic_memory_allocate(found->surface->context, found->n, sizeof *found->reaches);
  if (!found->reaches)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < found->n; i++) {
    conic_dart_triangle triangle;
    conic_densify_triangle(found, i, &triangle);
    double reach = conic_dart_reach(&triangle);
    found->reaches[i] = (float)reach;
    found->widest = reach > found->widest ? reach : found->widest;
  }
  return CONIC_OK;
}

conic_status conic_densify_triangles_find(const conic_surface *surface, const conic_densify_options *options,
                                          conic_workspace *workspaces, conic_densify_triangles *triangles) {
  conic_context *context = surface->context;
  triangle_search search = {triangles, options, workspaces, NULL};
  *triangles = (conic_densify_triangles){.surface = surface};
  triangles->normals = conic_memory_allocate(context, surface->tree.n_slots, sizeof *triangles->normals);
  if (!triangles->normals)
    return CONIC_ERROR_MEMORY;
  conic_team_loop loop = {
      .name = "densify", .n_a_run = CHUNKS_A_REPORT, .task = CONIC_TASK(find_normals), .data = &search};
  loop.n_items = (surface->tree.n_leaves + CHUNK - 1) / CHUNK;
  loop.first_of = first_slot_of_leaves;
  loop.columns[0] = (conic_team_column){triangles->normals, sizeof *triangles->normals};
  conic_status status = conic_team_runs(context, &loop);
  if (status == CONIC_OK)
    status = options->n_triangles ? take_triangles(&search) : triangulate(&search);
  return status == CONIC_OK ? measure_triangles(triangles) : status;
}

void conic_densify_triangles_release(conic_context *context, conic_densify_triangles *triangles) {
  conic_memory_release_these(context, triangles->normals, triangles->corners, triangles->reaches);
  memset(triangles, 0, sizeof *triangles);
}

void conic_densify_triangle(const conic_densify_triangles *triangles, size_t i, conic_dart_triangle *triangle) {
  const conic_neighbours *tree = &triangles->surface->tree;
  double u[3], v[3], *across = triangle->across, side = 0.0;
  for (int k = 0; k < 3; k++)
    for (int axis = 0; axis < 3; axis++) {
      uint32_t slot = triangles->corners[i][k];
      triangle->corners[k][axis] = (double)tree->position[axis][slot];
      triangle->normals[k][axis] = (double)triangles->normals[slot][axis];
    }
  conic_subtract(triangle->corners[1], triangle->corners[0], u);
  conic_subtract(triangle->corners[2], triangle->corners[0], v);
  conic_cross(u, v, across);
  conic_normalize(across);
  for (int k = 0; k < 3; k++)
    side += conic_dot(across, triangle->normals[k]);
  triangle->is_bent = 1;
  for (int axis = 0; axis < 3 && side < 0.0; axis++)
    across[axis] = -across[axis];
  for (int k = 0; k < 3; k++)
    triangle->is_bent &= conic_dot(triangle->normals[k], across) >= LEAST_AGREEMENT;
}
