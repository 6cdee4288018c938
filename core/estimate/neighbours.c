#include "core/estimate/neighbours.h"

enum { MAX_DEPTH = 34 };

/* The least squared distance from the query to the box. Rounding is monotonic, and this sum is formed like that of a
 * point's distance: it is never above the distance of any point in the box, to the last bit. */
static double box_distance2(const float box[6], const double query[3]) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double below = (double)box[axis] - query[axis], above = query[axis] - (double)box[3 + axis];
    double outside = below > above ? below : above;
    outside = outside > 0.0 ? outside : 0.0;
    sum += outside * outside;
  }
  return sum;
}

/* Equal distances are told apart by position; no two slots have the same. */
static int lies_before(const conic_neighbours *tree, size_t a, size_t b) {
  for (int axis = 0; axis < 3; axis++)
    if (tree->position[axis][a] != tree->position[axis][b])
      return tree->position[axis][a] < tree->position[axis][b];
  return 0;
}

typedef struct neighbour_search {
  const conic_neighbours *tree;
  double query[3];
  uint32_t except;
  size_t k, n_found;
  double limit2; /* what is farther is not wanted: the limit, later the k-th distance */
  uint32_t *slots;
  double *distances2;
} neighbour_search;

static inline void move_on(neighbour_search *s, size_t i) {
  s->distances2[i] = s->distances2[i - 1];
  s->slots[i] = s->slots[i - 1];
}

static void insert(neighbour_search *s, uint32_t slot, double distance2) {
  size_t i = s->n_found;
  if (i == s->k) {
    i--;
    if (distance2 == s->distances2[i] && !lies_before(s->tree, slot, s->slots[i]))
      return;
  } else
    s->n_found++;
  for (; i > 0 && s->distances2[i - 1] > distance2; i--)
    move_on(s, i);
  for (; i > 0 && s->distances2[i - 1] == distance2 && lies_before(s->tree, slot, s->slots[i - 1]); i--)
    move_on(s, i);
  s->distances2[i] = distance2;
  s->slots[i] = slot;
  if (s->n_found == s->k)
    s->limit2 = s->distances2[s->k - 1];
}

static void search_leaf(neighbour_search *s, size_t i_leaf) {
  double distances2[CONIC_LEAF_SLOTS];
  size_t begin = conic_neighbours_leaf_begin(s->tree, i_leaf);
  size_t n = conic_neighbours_leaf_begin(s->tree, i_leaf + 1) - begin;
  for (size_t i = 0; i < n; i++)
    distances2[i] = conic_neighbours_distance2(s->tree, begin + i, s->query);
  for (size_t i = 0; i < n; i++)
    if (distances2[i] <= s->limit2 && begin + i != s->except)
      insert(s, (uint32_t)(begin + i), distances2[i]);
}

size_t conic_neighbours_nearest(const conic_neighbours *tree, const double query[3], uint32_t except, size_t k,
                                double limit2, uint32_t *slots, double *distances2) {
  neighbour_search s = {tree, {query[0], query[1], query[2]}, except, k, 0, limit2, NULL, NULL};
  s.slots = slots;
  s.distances2 = distances2;
  struct {
    size_t i_node;
    double distance2;
  } stack[MAX_DEPTH + 2];
  int n_stack = 0;
  if (k == 0 || tree->n_slots == 0)
    return 0;
  stack[n_stack].i_node = 0;
  stack[n_stack++].distance2 = box_distance2(tree->boxes[0], query);
  while (n_stack > 0) {
    size_t i_node = stack[--n_stack].i_node;
    int is_near = stack[n_stack].distance2 <= s.limit2;
    while (is_near && i_node < tree->n_leaves - 1) {
      size_t near = 2 * i_node + 1, far = near + 1;
      double near2 = box_distance2(tree->boxes[near], query), far2 = box_distance2(tree->boxes[far], query);
      if (far2 < near2) {
        double distance2 = near2;
        near2 = far2;
        far2 = distance2;
        near = far;
        far = 2 * i_node + 1;
      }
      if (far2 <= s.limit2) {
        stack[n_stack].i_node = far;
        stack[n_stack++].distance2 = far2;
      }
      i_node = near;
      is_near = near2 <= s.limit2;
    }
    if (is_near)
      search_leaf(&s, i_node - (tree->n_leaves - 1));
  }
  return s.n_found;
}
