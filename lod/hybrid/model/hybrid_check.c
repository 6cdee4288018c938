/* Whether a hybrid model keeps what its numbers promise. */

#include "lod/hybrid/model/hybrid_chunks.h"

/* What floats lose between the finding of a bound and its use. */
static const double hair = 1e-5;

static double distance_of(const conic_hybrid_bound *bound, const double at[3]) {
  double way[3];
  for (int axis = 0; axis < 3; axis++)
    way[axis] = at[axis] - (double)bound->center[axis];
  return conic_length(way);
}

static void vertex_place(const conic_hybrid_vertices *vertices, size_t vertex, double at[3]) {
  for (int axis = 0; axis < 3; axis++)
    at[axis] = (double)vertices->position[axis][vertex];
}

static int faces_within(const conic_hybrid_bound *bound, double at[3][3]) {
  double sides[2][3], normal[3], axis[3];
  for (int k = 0; k < 3; k++) {
    sides[0][k] = at[1][k] - at[0][k];
    sides[1][k] = at[2][k] - at[0][k];
    axis[k] = (double)bound->axis[k];
  }
  conic_cross(sides[0], sides[1], normal);
  double length = conic_length(normal);
  return bound->cone <= -1.0f || conic_dot(normal, axis) >= ((double)bound->cone - hair) * length;
}

/* Triangles come before surfels, and each kind is of growing error. */
static int wrong_after(const conic_hybrid_level *before, const conic_hybrid_level *level) {
  return level->kind == before->kind ? !(level->error >= before->error) : level->kind != CONIC_HYBRID_SURFELS;
}

/* The faces themselves, the first level; or splats that stay, which may stand out of the sphere. */
static void check_cluster(const conic_hybrid *h, const conic_hybrid_cluster *cluster, conic_hybrid_defects *found) {
  const conic_hybrid_level *levels = h->levels + cluster->first_level;
  double most = (double)cluster->bound.radius * (1.0 + hair);
  int is_out = 0, is_turned = 0, is_wrong = levels[0].error != 0.0f;
  conic_hybrid_piece faces = conic_hybrid_piece_of(h, cluster->first_level);
  for (size_t i = 0; i < levels[0].count && levels[0].kind == CONIC_HYBRID_TRIANGLES; i++) {
    double at[3][3];
    for (int corner = 0; corner < 3; corner++) {
      vertex_place(&faces.vertices, conic_hybrid_corner(&faces, i, corner), at[corner]);
      is_out |= !(distance_of(&cluster->bound, at[corner]) <= most);
    }
    is_turned |= !faces_within(&cluster->bound, at);
  }
  for (uint32_t k = 1; k < cluster->n_levels; k++)
    is_wrong |= wrong_after(&levels[k - 1], &levels[k]);
  found->spheres += (size_t)is_out;
  found->cones += (size_t)is_turned;
  found->levels += (size_t)is_wrong;
}

/* A node's levels are of growing error, and the disc of its point holds the faces of all of its clusters. */
static void check_joined(const conic_hybrid *h, const conic_hybrid_node *node, conic_hybrid_defects *found) {
  const conic_hybrid_bound point = {.center = {node->bound.center[0], node->bound.center[1], node->bound.center[2]}};
  int is_out = 0, is_wrong = 0;
  const conic_hybrid_level *levels = h->levels + node->first_level;
  for (uint32_t k = 1; k < node->n_levels; k++)
    is_wrong |= wrong_after(&levels[k - 1], &levels[k]);
  for (uint32_t i = node->begin; i < node->end && node->point.radius > 0.0f; i++) {
    conic_hybrid_piece faces = conic_hybrid_piece_of(h, h->clusters[i].first_level);
    for (uint32_t k = 0; k < h->levels[h->clusters[i].first_level].n_vertices; k++) {
      double at[3];
      vertex_place(&faces.vertices, k, at);
      is_out |= !(distance_of(&point, at) <= (double)node->point.radius * (1.0 + hair));
    }
  }
  is_wrong |= node->point.radius > 0.0f && !(node->point.error >= node->point.radius);
  found->spheres += (size_t)is_out;
  found->levels += (size_t)is_wrong;
  for (int channel = 0; channel < 3; channel++)
    found->values += !conic_is_finite(node->point.color[channel]);
}

/* All that is drawn of a node's clusters lies in its sphere, and their cones in its cone. */
static void check_hybrid_node(const conic_hybrid *h, const conic_hybrid_node *node, conic_hybrid_defects *found) {
  int is_out = 0, is_turned = 0;
  for (uint32_t i = node->begin; i < node->end; i++) {
    const conic_hybrid_cluster *cluster = &h->clusters[i];
    double center[3], reach = conic_hybrid_reach(h, cluster);
    for (int axis = 0; axis < 3; axis++)
      center[axis] = (double)cluster->bound.center[axis];
    double farthest = distance_of(&node->bound, center) + (double)cluster->bound.radius + reach;
    is_out |= !(farthest <= (double)node->bound.radius * (1.0 + hair));
    is_turned |= node->bound.cone > -1.0f &&
                 !(conic_hybrid_cone_about(&cluster->bound, node->bound.axis) >= (double)node->bound.cone - 1e-4);
  }
  found->spheres += (size_t)is_out;
  found->cones += (size_t)is_turned;
}

static size_t count_wrong(const float *values, size_t n) {
  size_t n_wrong = 0;
  for (size_t i = 0; i < n && values; i++)
    n_wrong += !conic_is_finite(values[i]);
  return n_wrong;
}

conic_status conic_hybrid_check(const conic_hybrid *h, conic_hybrid_defects *defects) {
  if (h->store)
    return conic_fail(h->context, CONIC_ERROR_ARGUMENT, "a model that was opened, not read as a whole, is not checked");
  memset(defects, 0, sizeof *defects);
  for (uint32_t i = 0; i < h->n_levels; i++) {
    conic_hybrid_piece piece = conic_hybrid_piece_of(h, i);
    for (int axis = 0; axis < 3; axis++)
      defects->values += count_wrong(piece.vertices.position[axis], h->levels[i].n_vertices) +
                         count_wrong(piece.vertices.color[axis], h->levels[i].n_vertices);
    for (int k = 0; k < 12; k++)
      defects->values += count_wrong(piece.surfels[k], h->levels[i].count);
  }
  for (size_t i = 0; i < h->n_clusters; i++)
    check_cluster(h, &h->clusters[i], defects);
  for (size_t i = 0; i < h->n_nodes; i++) {
    check_hybrid_node(h, &h->nodes[i], defects);
    check_joined(h, &h->nodes[i], defects);
  }
  return CONIC_OK;
}
