#include "surface/clusters.h"

#include <math.h>

#include "core/base/memory.h"

/* The sums over a node's slots, each weighed by its mass. */
typedef struct node_sums {
  double mass, place[3], normal[3], color[3], h;
} node_sums;

static void add_slot(const conic_surface *surface, size_t slot, node_sums *sums) {
  double mass = (double)surface->mass[slot];
  sums->mass += mass;
  sums->h += mass * (double)surface->h[slot];
  for (int axis = 0; axis < 3; axis++) {
    sums->place[axis] += mass * (double)surface->tree.position[axis][slot];
    sums->normal[axis] += surface->normal[0] ? mass * (double)surface->normal[axis][slot] : 0.0;
    sums->color[axis] += surface->color[0] ? mass * (double)surface->color[axis][slot] : 0.0;
  }
}

static void add_child(const conic_surface_clusters *clusters, size_t i, node_sums *sums) {
  double mass = clusters->mass[i];
  sums->mass += mass;
  sums->h += mass * (double)clusters->h[i];
  for (int axis = 0; axis < 3; axis++) {
    sums->place[axis] += mass * clusters->centroid[i][axis];
    sums->normal[axis] += clusters->normal ? mass * (double)clusters->normal[i][axis] : 0.0;
    sums->color[axis] += clusters->color ? mass * (double)clusters->color[i][axis] : 0.0;
  }
}

static void settle(conic_surface *surface, size_t i, const node_sums *sums) {
  conic_surface_clusters *clusters = &surface->clusters;
  const float *box = surface->tree.boxes[i];
  double share = sums->mass > 0.0 ? 1.0 / sums->mass : 0.0, size2 = 0.0;
  clusters->mass[i] = sums->mass;
  clusters->h[i] = (float)(sums->h * share);
  for (int axis = 0; axis < 3; axis++) {
    double edge = (double)box[3 + axis] - (double)box[axis];
    size2 += edge * edge;
    clusters->centroid[i][axis] = sums->place[axis] * share;
    if (clusters->normal)
      clusters->normal[i][axis] = (float)(sums->normal[axis] * share);
    if (clusters->color)
      clusters->color[i][axis] = (float)(sums->color[axis] * share);
  }
  clusters->size[i] = (float)sqrt(size2);
}

conic_status conic_clusters_create(conic_surface *surface) {
  conic_context *context = surface->context;
  conic_surface_clusters *clusters = &surface->clusters;
  const conic_neighbours *tree = &surface->tree;
  size_t n = 2 * tree->n_leaves - 1;
  clusters->centroid = conic_memory_allocate(context, n, sizeof *clusters->centroid);
  clusters->mass = conic_memory_allocate(context, n, sizeof *clusters->mass);
  clusters->size = conic_memory_allocate(context, n, sizeof *clusters->size);
  clusters->h = conic_memory_allocate(context, n, sizeof *clusters->h);
  if (surface->normal[0])
    clusters->normal = conic_memory_allocate(context, n, sizeof *clusters->normal);
  if (surface->color[0])
    clusters->color = conic_memory_allocate(context, n, sizeof *clusters->color);
  if (!clusters->centroid || !clusters->mass || !clusters->size || !clusters->h ||
      (surface->normal[0] && !clusters->normal) || (surface->color[0] && !clusters->color))
    return CONIC_ERROR_MEMORY;
  for (size_t i = n; i-- > 0;) {
    node_sums sums = {0};
    if (i >= tree->n_leaves - 1) {
      size_t i_leaf = i - (tree->n_leaves - 1), end = conic_neighbours_leaf_begin(tree, i_leaf + 1);
      for (size_t slot = conic_neighbours_leaf_begin(tree, i_leaf); slot < end; slot++)
        add_slot(surface, slot, &sums);
    } else {
      add_child(clusters, 2 * i + 1, &sums);
      add_child(clusters, 2 * i + 2, &sums);
    }
    settle(surface, i, &sums);
  }
  return CONIC_OK;
}

void conic_clusters_release(conic_surface *surface) {
  conic_surface_clusters *clusters = &surface->clusters;
  conic_memory_release_these(surface->context, clusters->centroid, clusters->mass, clusters->size, clusters->h,
                             clusters->normal, clusters->color);
}
