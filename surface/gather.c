/* The samples near a point: from the tree into the arrays that the loops sum over. */

#include "core/base/team_runs.h"
#include "core/base/vectors.h"
#include "surface/mls_surface.h"

enum { MAX_DEPTH = 34 };

conic_status conic_workspaces_create(conic_context *context, conic_workspace **workspaces) {
  size_t n = (size_t)conic_context_threads(context);
  *workspaces = conic_memory_allocate_zeroed(context, n, sizeof **workspaces);
  for (size_t i = 0; *workspaces && i < n; i++)
    (*workspaces)[i].context = context;
  return *workspaces ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void conic_workspaces_release(conic_context *context, conic_workspace *workspaces) {
  for (int i = 0; workspaces && i < conic_context_threads(context); i++) {
    conic_memory_release_these(context, workspaces[i].shared.sources, workspaces[i].single.sources,
                               workspaces[i].shared.samples.offset[0], workspaces[i].single.samples.offset[0],
                               workspaces[i].near.offset[0], workspaces[i].other_near.offset[0]);
  }
  conic_memory_release(context, workspaces);
}

conic_status conic_workspaces_check(const conic_context *context, const conic_workspace *workspaces) {
  for (int i = 0; i < conic_context_threads(context); i++)
    if (workspaces[i].is_out_of_memory)
      return CONIC_ERROR_MEMORY;
  return CONIC_OK;
}

conic_status conic_workspaces_count(conic_context *context, conic_workspace *workspaces, size_t *n_evaluations) {
  size_t n = 0;
  for (int i = 0; i < conic_context_threads(context); i++) {
    n += workspaces[i].n_evaluations;
    workspaces[i].n_evaluations = 0;
  }
  conic_status status = conic_team_total(context, &n);
  *n_evaluations += n;
  return status;
}

/* Makes room for `n` neighbours and their padding: one block, the arrays side by side. */
static int reserve_near(conic_workspace *workspace, conic_near *near, size_t n) {
  enum { N_ARRAYS = 9 };
  if (n + CONIC_NEAR_LANES <= near->capacity)
    return 1;
  size_t capacity = (n + n / 2 + 128) / CONIC_NEAR_LANES * CONIC_NEAR_LANES;
  size_t entry_bytes = (N_ARRAYS + CONIC_MAX_COLUMNS) * sizeof(double) + sizeof(uint32_t);
  conic_memory_release(workspace->context, near->offset[0]);
  *near = (conic_near){0};
  double *block = workspace->is_out_of_memory ? NULL : conic_memory_allocate(workspace->context, capacity, entry_bytes);
  if (!block) {
    workspace->is_out_of_memory = 1;
    return 0;
  }
  for (size_t axis = 0; axis < 3; axis++) {
    near->offset[axis] = block + axis * capacity;
    near->normal[axis] = block + (3 + axis) * capacity;
  }
  near->mass = block + 6 * capacity;
  near->inverse_h2 = block + 7 * capacity;
  near->weights = block + 8 * capacity;
  near->columns = block + N_ARRAYS * capacity;
  near->sources = (uint32_t *)(near->columns + CONIC_MAX_COLUMNS * capacity);
  near->capacity = capacity;
  return 1;
}

static int reserve_candidates(conic_workspace *workspace, conic_candidates *candidates, size_t n) {
  if (!workspace->is_out_of_memory &&
      conic_memory_reserve(workspace->context, &candidates->sources, candidates->n, n, &candidates->capacity,
                           sizeof *candidates->sources) == CONIC_OK)
    return 1;
  workspace->is_out_of_memory = 1;
  return 0;
}

/* The squared distance between two boxes. */
static double distance2_between(const float node[6], const double box[6]) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double below = (double)node[axis] - box[3 + axis], above = box[axis] - (double)node[3 + axis];
    double outside = below > above ? below : above;
    outside = outside > 0.0 ? outside : 0.0;
    sum += outside * outside;
  }
  return sum;
}

static int append_leaf(const conic_surface *surface, size_t i_leaf, conic_workspace *workspace,
                       conic_candidates *candidates) {
  size_t begin = conic_neighbours_leaf_begin(&surface->tree, i_leaf);
  size_t end = conic_neighbours_leaf_begin(&surface->tree, i_leaf + 1);
  if (!reserve_candidates(workspace, candidates, candidates->n + (end - begin)))
    return 0;
  for (size_t slot = begin; slot < end; slot++)
    candidates->sources[candidates->n++] = (uint32_t)slot;
  return 1;
}

static int append_cluster(size_t i_node, conic_workspace *workspace, conic_candidates *candidates) {
  if (!reserve_candidates(workspace, candidates, candidates->n + 1))
    return 0;
  candidates->sources[candidates->n++] = CONIC_CLUSTER_BIT | (uint32_t)i_node;
  return 1;
}

/* A candidate's place, scale and mass. */
static inline void look_up(const conic_surface *surface, uint32_t source, double place[3], double *h, double *mass) {
  if (source & CONIC_CLUSTER_BIT) {
    size_t i = source & ~CONIC_CLUSTER_BIT;
    memcpy(place, surface->clusters.centroid[i], 3 * sizeof place[0]);
    *h = (double)surface->clusters.h[i];
    *mass = surface->clusters.mass[i]; /* NOLINT(clang-analyzer-core.NullDereference): without any no bit is set */
    return;
  }
  conic_vector_at(surface->tree.position, source, place);
  *h = (double)surface->h[source];
  *mass = (double)surface->mass[source];
}

static void pad(conic_near *near) {
  near->n_padded = (near->n + CONIC_NEAR_LANES - 1) / CONIC_NEAR_LANES * CONIC_NEAR_LANES;
  for (size_t i = near->n; i < near->n_padded; i++) {
    for (int axis = 0; axis < 3; axis++)
      near->offset[axis][i] = near->normal[axis][i] = 0.0;
    near->mass[i] = near->inverse_h2[i] = 0.0;
  }
}

/* Puts what is known of all candidates side by side, and behind them what is near nothing. */
static void look_up_all(const conic_surface *surface, conic_workspace *workspace, conic_candidates *candidates) {
  conic_near *all = &candidates->samples;
  all->n = all->n_padded = 0;
  if (!reserve_near(workspace, all, candidates->n))
    return;
  for (size_t i = 0; i < candidates->n; i++) {
    double place[3];
    look_up(surface, candidates->sources[i], place, &all->inverse_h2[i], &all->mass[i]);
    for (int axis = 0; axis < 3; axis++)
      all->offset[axis][i] = place[axis];
    all->sources[i] = candidates->sources[i];
  }
  all->n = candidates->n;
  pad(all);
  for (size_t i = all->n; i < all->n_padded; i++) {
    all->inverse_h2[i] = NAN;
    all->sources[i] = 0;
  }
}

void conic_surface_gather(const conic_surface *surface, const double box[6], double margin, conic_workspace *workspace,
                          conic_candidates *candidates) {
  const conic_neighbours *tree = &surface->tree;
  size_t stack[MAX_DEPTH + 2];
  int n_stack = 0, is_well = 1;
  candidates->n = 0;
  stack[n_stack++] = 0;
  while (n_stack > 0 && is_well) {
    size_t i_node = stack[--n_stack];
    double reach = (double)surface->node_reach[i_node] + margin,
           distance2 = distance2_between(tree->boxes[i_node], box);
    if (!(distance2 < reach * reach))
      continue;
    if (surface->clusters.mass) {
      double size = (double)surface->clusters.size[i_node];
      if (size * size < surface->options.cluster * surface->options.cluster * distance2) {
        is_well = append_cluster(i_node, workspace, candidates);
        continue;
      }
    }
    if (i_node >= tree->n_leaves - 1)
      is_well = append_leaf(surface, i_node - (tree->n_leaves - 1), workspace, candidates);
    else {
      stack[n_stack++] = 2 * i_node + 2;
      stack[n_stack++] = 2 * i_node + 1;
    }
  }
  look_up_all(surface, workspace, candidates);
}

void conic_surface_share_leaf(const conic_surface *surface, size_t i_leaf, conic_workspace *workspace) {
  const conic_neighbours *tree = &surface->tree;
  size_t end = conic_neighbours_leaf_begin(tree, i_leaf + 1);
  double box[6], margin = 0.0;
  for (int i = 0; i < 6; i++)
    box[i] = (double)tree->boxes[tree->n_leaves - 1 + i_leaf][i];
  for (size_t slot = conic_neighbours_leaf_begin(tree, i_leaf); slot < end; slot++) {
    double own = 2.0 * conic_surface_margin(surface, (double)surface->h[slot]);
    margin = own > margin ? own : margin;
  }
  conic_surface_gather(surface, box, margin, workspace, &workspace->shared);
}

static void fetch_normals(const conic_surface *surface, conic_near *near) {
  for (size_t i = 0; i < near->n; i++) {
    uint32_t source = near->sources[i];
    for (int axis = 0; axis < 3; axis++)
      near->normal[axis][i] = source & CONIC_CLUSTER_BIT
                                  ? (double)surface->clusters.normal[source & ~CONIC_CLUSTER_BIT][axis]
                                  : (double)surface->normal[axis][source];
  }
}

/* Normals turned by more than this (107°) belong to the other side of a thin part. */
static const double LEAST_COSINE = -0.3;

static void drop_backs(const conic_surface *surface, const float side[3], conic_near *near) {
  size_t n = 0;
  for (size_t i = 0; i < near->n; i++) {
    uint32_t source = near->sources[i];
    double along = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      along += (double)side[axis] * (double)surface->normal[axis][source];
      near->offset[axis][n] = near->offset[axis][i];
    }
    near->mass[n] = near->mass[i];
    near->inverse_h2[n] = near->inverse_h2[i];
    near->sources[n] = source;
    n += along < LEAST_COSINE ? 0 : 1;
  }
  near->n = n;
}

void conic_surface_select(const conic_surface *surface, const conic_candidates *candidates, const double r[3],
                          double margin, uint32_t except, conic_workspace *workspace) {
  conic_near *near = &workspace->near;
  const conic_near *all = &candidates->samples;
  near->n = near->n_padded = 0;
  if (!reserve_near(workspace, near, all->n))
    return;
  surface->loops.select(all, r, surface->options.neglect, margin, except, near);
  if (workspace->side)
    drop_backs(surface, workspace->side, near);
  pad(near);
  if (surface->options.type == CONIC_SURFACE_APSS)
    fetch_normals(surface, near);
}

static void add_source(const conic_surface *surface, uint32_t source, double w, double normal[3], double color[3]) {
  const conic_surface_clusters *clusters = &surface->clusters;
  int is_cluster = (source & CONIC_CLUSTER_BIT) != 0;
  size_t i = source & ~CONIC_CLUSTER_BIT;
  for (int axis = 0; axis < 3; axis++) {
    if (surface->normal[0])
      normal[axis] += w * (double)(is_cluster ? clusters->normal[i][axis] : surface->normal[axis][i]);
    if (surface->color[0])
      color[axis] += w * (double)(is_cluster ? clusters->color[i][axis] : surface->color[axis][i]);
  }
}

void conic_surface_attributes(const conic_surface *surface, const conic_workspace *workspace, double normal[3],
                              double color[3]) {
  const conic_near *near = &workspace->near;
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = color[axis] = 0.0;
  for (size_t i = 0; i < near->n; i++) {
    sum += near->weights[i];
    add_source(surface, near->sources[i], near->weights[i], normal, color);
  }
  double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  for (int axis = 0; axis < 3; axis++) {
    normal[axis] = length > 0.0 ? normal[axis] / length : 0.0;
    color[axis] = surface->color[0] && sum > 0.0 ? color[axis] / sum : 1.0;
  }
}
