#include "core/estimate/neighbours.h"

#include <string.h>

enum { MAX_DEPTH = 34 };

/* Two doubles at a time: one of each of two boxes that lie side by side. What is compared cannot be foreseen, so
 * nothing here branches. */
typedef double box_pair __attribute__((vector_size(16)));
typedef int64_t box_pair_mask __attribute__((vector_size(16)));

static inline box_pair greater_of(box_pair a, box_pair b) {
  box_pair_mask is_a = a > b;
  return (box_pair)((is_a & (box_pair_mask)a) | (~is_a & (box_pair_mask)b));
}

/* The least squared distances from the query to two boxes, one after the other. Rounding is monotonic, and these sums
 * are formed like that of a point's distance: none is above the distance of any point in the box, to the last bit. */
static inline box_pair box_distances2(const float boxes[2][6], const double query[3]) {
  box_pair sum = {0.0, 0.0};
  for (int axis = 0; axis < 3; axis++) {
    const box_pair low = {(double)boxes[0][axis], (double)boxes[1][axis]};
    const box_pair high = {(double)boxes[0][3 + axis], (double)boxes[1][3 + axis]};
    box_pair outside = greater_of(greater_of(low - query[axis], query[axis] - high), (box_pair){0.0, 0.0});
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

static void insert(neighbour_search *s, uint32_t slot, double distance2) {
  size_t n = s->n_found, place = 0;
  if (n == s->k) {
    n--;
    if (distance2 == s->distances2[n] && !lies_before(s->tree, slot, s->slots[n]))
      return;
  } else
    s->n_found++;
  for (size_t i = 0; i < n; i++) /* counted, as where it belongs cannot be foreseen */
    place += s->distances2[i] <= distance2;
  while (place > 0 && s->distances2[place - 1] == distance2 && lies_before(s->tree, slot, s->slots[place - 1]))
    place--;
  memmove(s->distances2 + place + 1, s->distances2 + place, (n - place) * sizeof *s->distances2);
  memmove(s->slots + place + 1, s->slots + place, (n - place) * sizeof *s->slots);
  s->distances2[place] = distance2;
  s->slots[place] = slot;
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
  stack[n_stack++].distance2 = 0.0;
  while (n_stack > 0) {
    size_t i_node = stack[--n_stack].i_node;
    int is_near = stack[n_stack].distance2 <= s.limit2;
    while (is_near && i_node < tree->n_leaves - 1) {
      size_t first = 2 * i_node + 1;
      const box_pair both = box_distances2((const float(*)[6])tree->boxes + first, query);
      size_t nearer = both[1] < both[0];
      const double near2 = nearer ? both[1] : both[0], far2 = nearer ? both[0] : both[1];
      stack[n_stack].i_node = first + (1 - nearer);
      stack[n_stack].distance2 = far2;
      n_stack += far2 <= s.limit2;
      i_node = first + nearer;
      is_near = near2 <= s.limit2;
    }
    if (is_near)
      search_leaf(&s, i_node - (tree->n_leaves - 1));
  }
  return s.n_found;
}

double conic_neighbours_bound2(const conic_neighbours *tree, const uint32_t *nearest, size_t n, size_t other,
                               size_t slot) {
  const double query[3] = {(double)tree->position[0][slot], (double)tree->position[1][slot],
                           (double)tree->position[2][slot]};
  double bound2 = 0.0;
  for (size_t i = 0; i < n; i++) {
    double distance2 = conic_neighbours_distance2(tree, nearest[i] == slot ? other : nearest[i], query);
    bound2 = distance2 > bound2 ? distance2 : bound2;
  }
  return bound2;
}
