/* The hierarchy over the clusters. */
#include "core/base/real.h"
#include "core/base/vectors.h"
#include "lod/hybrid/model/hybrid_model.h"

/* Halves like these need no more levels of nodes than they must. */
size_t conic_hybrid_half(size_t n) {
  return (n + 1) / 2;
}

size_t conic_hybrid_count_nodes(size_t n) {
  if (n <= CONIC_HYBRID_LEAF)
    return n > 0;
  return 1 + conic_hybrid_count_nodes(conic_hybrid_half(n)) + conic_hybrid_count_nodes(n - conic_hybrid_half(n));
}

typedef struct cluster_place {
  float at;
  uint32_t cluster;
} cluster_place;

CONIC_DEFINE_ORDER_BY_TWO(compare_places, cluster_place, at, cluster)

static int longest_axis(const conic_hybrid_bound *bounds, const uint32_t *order, size_t n) {
  float widest = -1.0f;
  int longest = 0;
  for (int axis = 0; axis < 3; axis++) {
    float low = bounds[order[0]].center[axis], high = low;
    for (size_t i = 1; i < n; i++) {
      float at = bounds[order[i]].center[axis];
      CONIC_WIDEN(low, high, at, at);
    }
    if (high - low > widest) {
      widest = high - low;
      longest = axis;
    }
  }
  return longest;
}

static int has_both_kinds(const uint8_t *kinds, const uint32_t *order, size_t n) {
  size_t i = 1;
  while (kinds && i < n && kinds[order[i]] == kinds[order[0]])
    i++;
  return kinds && i < n;
}

/* Kinds first, so that few nodes hold both. */
static void order_range(const conic_hybrid_bound *bounds, const uint8_t *kinds, uint32_t *order, size_t n,
                        cluster_place *places) {
  int is_mixed = has_both_kinds(kinds, order, n);
  if (n <= CONIC_HYBRID_LEAF && !is_mixed)
    return;
  int axis = longest_axis(bounds, order, n);
  for (size_t i = 0; i < n; i++)
    places[i] = (cluster_place){is_mixed ? (float)kinds[order[i]] : bounds[order[i]].center[axis], order[i]};
  qsort(places, n, sizeof *places, compare_places);
  for (size_t i = 0; i < n; i++)
    order[i] = places[i].cluster;
  if (n <= CONIC_HYBRID_LEAF)
    return;
  order_range(bounds, kinds, order, conic_hybrid_half(n), places);
  order_range(bounds, kinds, order + conic_hybrid_half(n), n - conic_hybrid_half(n), places);
}

conic_status conic_hybrid_order(conic_context *context, const conic_hybrid_bound *bounds, const uint8_t *kinds,
                                size_t n_clusters, uint32_t *order) {
  cluster_place *places = conic_memory_allocate(context, n_clusters, sizeof *places);
  if (!places)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n_clusters; i++)
    order[i] = (uint32_t)i;
  order_range(bounds, kinds, order, n_clusters, places);
  conic_memory_release(context, places);
  return CONIC_OK;
}

/* --- bounds --- */

/* What floats lose in forming a bound. */
static const double hair = 1.0 + 1e-6;

static void join_spheres(const conic_hybrid_bound *a, const conic_hybrid_bound *b, conic_hybrid_bound *both) {
  double way[3], ra = (double)a->radius, rb = (double)b->radius;
  for (int axis = 0; axis < 3; axis++)
    way[axis] = (double)b->center[axis] - (double)a->center[axis];
  double distance = sqrt((way[0] * way[0] + way[1] * way[1]) + way[2] * way[2]);
  if (distance + rb <= ra || distance + ra <= rb) {
    const conic_hybrid_bound *larger = distance + rb <= ra ? a : b;
    memcpy(both->center, larger->center, sizeof both->center);
    both->radius = larger->radius;
    return;
  }
  double radius = 0.5 * (distance + ra + rb), along = (radius - ra) / distance, farthest = 0.0;
  for (int axis = 0; axis < 3; axis++)
    both->center[axis] = (float)((double)a->center[axis] + along * way[axis]);
  for (int k = 0; k < 2; k++) { /* from the rounded centre */
    const conic_hybrid_bound *one = k ? b : a;
    double square = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      double d = (double)one->center[axis] - (double)both->center[axis];
      square += d * d;
    }
    double reach = sqrt(square) + (double)one->radius;
    farthest = reach > farthest ? reach : farthest;
  }
  both->radius = (float)(farthest * hair);
}

double conic_hybrid_cone_about(const conic_hybrid_bound *bound, const float axis[3]) {
  double own[3], about[3];
  for (int i = 0; i < 3; i++) {
    own[i] = (double)bound->axis[i];
    about[i] = (double)axis[i];
  }
  return conic_cosine_of_sum(conic_cosine_between(own, about), (double)bound->cone);
}

/* The axis between both, and the wider of the two openings from there; cosines of sums, no angles. */
static void join_cones(const conic_hybrid_bound *a, const conic_hybrid_bound *b, conic_hybrid_bound *both) {
  double axis[3], length2 = 0.0, least = 1.0;
  for (int i = 0; i < 3; i++) {
    axis[i] = (double)a->axis[i] + (double)b->axis[i];
    length2 += axis[i] * axis[i];
  }
  both->cone = -1.0f;
  memcpy(both->axis, a->axis, sizeof both->axis);
  if (!(length2 > 1e-6) || a->cone <= 0.0f || b->cone <= 0.0f)
    return;
  for (int i = 0; i < 3; i++)
    both->axis[i] = (float)(axis[i] / sqrt(length2));
  for (int k = 0; k < 2; k++) {
    double sum = conic_hybrid_cone_about(k ? b : a, both->axis);
    least = sum < least ? sum : least;
  }
  both->cone = least > 1e-3 ? (float)(least - 1e-5) : -1.0f;
}

conic_hybrid_bound conic_hybrid_join(const conic_hybrid_bound *a, const conic_hybrid_bound *b) {
  conic_hybrid_bound both;
  join_spheres(a, b, &both);
  join_cones(a, b, &both);
  return both;
}

typedef struct filling {
  const conic_hybrid_bound *bounds;
  const float *reach;
  conic_hybrid_node *nodes;
  uint32_t n;
} filling;

static uint32_t fill_node(filling *f, size_t begin, size_t end) {
  uint32_t own = f->n++, first = 0, second = 0;
  conic_hybrid_node *node = &f->nodes[own];
  size_t n = end - begin;
  if (n > CONIC_HYBRID_LEAF) {
    first = fill_node(f, begin, begin + conic_hybrid_half(n));
    second = fill_node(f, begin + conic_hybrid_half(n), end);
    node->bound = conic_hybrid_join(&f->nodes[first].bound, &f->nodes[second].bound);
  } else {
    for (size_t i = begin; i < end; i++) {
      conic_hybrid_bound bound = f->bounds[i];
      bound.radius = (float)(((double)bound.radius + (double)f->reach[i]) * hair);
      node->bound = i == begin ? bound : conic_hybrid_join(&node->bound, &bound);
    }
  }
  node->begin = (uint32_t)begin;
  node->end = (uint32_t)end;
  node->next = f->n;
  return own;
}

void conic_hybrid_fill_nodes(const conic_hybrid_bound *bounds, const float *reach, size_t n_clusters,
                             conic_hybrid_node *nodes) {
  filling f = {bounds, reach, nodes, 0};
  memset(nodes, 0, conic_hybrid_count_nodes(n_clusters) * sizeof *nodes);
  if (n_clusters > 0)
    fill_node(&f, 0, n_clusters);
}
