/* Rays against triangles, one by one down a tree of boxes: what shadows are measured against. */
#pragma once

#include "tests/support/check.h"

typedef struct ray_mesh_node {
  double low[3], high[3];
  size_t begin, end;  /* triangles */
  size_t children[2]; /* 0: none, it is a leaf */
} ray_mesh_node;

typedef struct ray_mesh {
  size_t count, n_nodes;
  double (*corners)[3][3];
  size_t *order;
  ray_mesh_node *nodes;
} ray_mesh;

static inline void ray_mesh_box(const ray_mesh *mesh, ray_mesh_node *node) {
  for (int axis = 0; axis < 3; axis++) {
    node->low[axis] = HUGE_VAL;
    node->high[axis] = -HUGE_VAL;
    for (size_t i = node->begin; i < node->end; i++)
      for (int corner = 0; corner < 3; corner++) {
        node->low[axis] = fmin(node->low[axis], mesh->corners[mesh->order[i]][corner][axis]);
        node->high[axis] = fmax(node->high[axis], mesh->corners[mesh->order[i]][corner][axis]);
      }
  }
}

/* Halves what is in a node by the middle of its longest axis. */
static inline void ray_mesh_split(ray_mesh *mesh, size_t i_node) {
  ray_mesh_node *node = &mesh->nodes[i_node];
  int axis = 0;
  ray_mesh_box(mesh, node);
  if (node->end - node->begin <= 4)
    return;
  for (int i = 1; i < 3; i++)
    if (node->high[i] - node->low[i] > node->high[axis] - node->low[axis])
      axis = i;
  size_t middle = node->begin;
  for (size_t i = node->begin; i < node->end; i++) {
    double(*corners)[3] = mesh->corners[mesh->order[i]];
    double sum = corners[0][axis] + corners[1][axis] + corners[2][axis];
    if (sum < 1.5 * (node->low[axis] + node->high[axis])) {
      size_t other = mesh->order[middle];
      mesh->order[middle++] = mesh->order[i];
      mesh->order[i] = other;
    }
  }
  if (middle == node->begin || middle == node->end)
    middle = (node->begin + node->end) / 2;
  node->children[0] = mesh->n_nodes++;
  node->children[1] = mesh->n_nodes++;
  mesh->nodes[node->children[0]] = (ray_mesh_node){.begin = node->begin, .end = middle};
  mesh->nodes[node->children[1]] = (ray_mesh_node){.begin = middle, .end = node->end};
  ray_mesh_split(mesh, mesh->nodes[i_node].children[0]);
  ray_mesh_split(mesh, mesh->nodes[i_node].children[1]);
}

/* Of the set in world coordinates; the caller frees it by ray_mesh_free. */
static inline ray_mesh ray_mesh_of(const conic_triangles *triangles) {
  ray_mesh mesh = {.count = triangles->count, .n_nodes = 1};
  mesh.corners = malloc(mesh.count * sizeof *mesh.corners);
  mesh.order = malloc(mesh.count * sizeof *mesh.order);
  mesh.nodes = malloc(2 * mesh.count * sizeof *mesh.nodes);
  for (size_t i = 0; i < mesh.count; i++) {
    mesh.order[i] = i;
    for (int corner = 0; corner < 3; corner++)
      for (int axis = 0; axis < 3; axis++)
        mesh.corners[i][corner][axis] =
            triangles->origin[axis] + (double)triangles->position[axis][triangles->corners[i][corner]];
  }
  mesh.nodes[0] = (ray_mesh_node){.begin = 0, .end = mesh.count};
  ray_mesh_split(&mesh, 0);
  return mesh;
}

static inline void ray_mesh_free(ray_mesh *mesh) {
  free(mesh->corners);
  free(mesh->order);
  free(mesh->nodes);
}

/* Moeller and Trumbore 1997, from either side. */
static inline int ray_meets_triangle(double (*corners)[3], const double from[3], const double d[3], double most) {
  double e[3], f[3], p[3], q[3], t[3];
  for (int axis = 0; axis < 3; axis++) {
    e[axis] = corners[1][axis] - corners[0][axis];
    f[axis] = corners[2][axis] - corners[0][axis];
    t[axis] = from[axis] - corners[0][axis];
  }
  for (int axis = 0; axis < 3; axis++) {
    int i = (axis + 1) % 3, j = (axis + 2) % 3;
    p[axis] = d[i] * f[j] - d[j] * f[i];
    q[axis] = t[i] * e[j] - t[j] * e[i];
  }
  double determinant = e[0] * p[0] + e[1] * p[1] + e[2] * p[2];
  if (determinant == 0.0)
    return 0;
  double u = (t[0] * p[0] + t[1] * p[1] + t[2] * p[2]) / determinant;
  double v = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / determinant;
  double distance = (f[0] * q[0] + f[1] * q[1] + f[2] * q[2]) / determinant;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0 && distance < most;
}

static inline int ray_meets_node(const ray_mesh_node *node, const double from[3], const double d[3]) {
  double near = 0.0, far = HUGE_VAL;
  for (int axis = 0; axis < 3; axis++) {
    double a = (node->low[axis] - from[axis]) / d[axis], b = (node->high[axis] - from[axis]) / d[axis];
    if (d[axis] == 0.0) {
      if (from[axis] < node->low[axis] || from[axis] > node->high[axis])
        return 0;
      continue;
    }
    near = fmax(near, fmin(a, b));
    far = fmin(far, fmax(a, b));
  }
  return near <= far * (1.0 + 1e-12);
}

/* Whether anything lies nearer than `most` along the unit direction d. */
static inline int ray_is_blocked(const ray_mesh *mesh, const double from[3], const double d[3], double most) {
  size_t stack[256], n = 1;
  stack[0] = 0;
  while (n > 0) {
    const ray_mesh_node *node = &mesh->nodes[stack[--n]];
    if (!ray_meets_node(node, from, d))
      continue;
    if (node->children[0]) {
      stack[n++] = node->children[0];
      stack[n++] = node->children[1];
      continue;
    }
    for (size_t i = node->begin; i < node->end; i++)
      if (ray_meets_triangle(mesh->corners[mesh->order[i]], from, d, most))
        return 1;
  }
  return 0;
}
