#include "core/estimate/neighbours.h"

enum { MAX_DEPTH = 34 };

/* Two doubles at a time, one for each of two neighbouring boxes. Comparisons cannot be predicted, so nothing here
 * branches. */
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

/* Candidates for the nearest slots are collected unsorted. When there are half as many again as wanted, and some more,
 * only the nearest are kept. */
enum {
  MOST_BESIDE = CONIC_MOST_NEAREST / 2 + 4,
  MOST_CANDIDATES = CONIC_MOST_NEAREST + MOST_BESIDE + CONIC_LEAF_SLOTS,
  BLOCK_KEYS = 16
};

typedef struct neighbour_search {
  const conic_neighbours *tree;
  double query[3];
  uint32_t except;
  size_t k, n;   /* candidates */
  double limit2; /* farther slots are not wanted: first the caller's limit, later the distance of the last slot that was
                    kept */
  double distances2[MOST_CANDIDATES];
  uint32_t slots[MOST_CANDIDATES];
} neighbour_search;

/* The squared distances as floats, in whole blocks, and how many others each exceeds. */
typedef float key_four __attribute__((vector_size(16)));
typedef int32_t place_four __attribute__((vector_size(16)));
typedef struct candidate_order {
  float keys[MOST_CANDIDATES + BLOCK_KEYS];
  int32_t places[MOST_CANDIDATES + BLOCK_KEYS];
} candidate_order;

/* Compares each with each: for so few, that is quicker than sorting with its unpredictable comparisons. */
static void rank_block(candidate_order *order, size_t begin, size_t n) {
  key_four keys[BLOCK_KEYS / 4];
  place_four places[BLOCK_KEYS / 4] = {{0}};
  memcpy(keys, order->keys + begin, sizeof keys);
  for (size_t j = 0; j < n; j++)
    for (int part = 0; part < BLOCK_KEYS / 4; part++)
      places[part] -= order->keys[j] < keys[part];
  memcpy(order->places + begin, places, sizeof places);
}

static int is_candidate_nearer(const neighbour_search *s, size_t a, size_t b) {
  return s->distances2[a] < s->distances2[b] ||
         (s->distances2[a] == s->distances2[b] && lies_before(s->tree, s->slots[a], s->slots[b]));
}

/* NOLINTBEGIN(clang-analyzer-core.*): it does not see what memcpy and vectors write */
/* Lists the candidates, nearest first. Candidates with the same key share a place, from which on they are put in
 * order. */
static void sort_candidates(const neighbour_search *s, uint8_t sorted[MOST_CANDIDATES]) {
  candidate_order order;
  uint8_t n_at[MOST_CANDIDATES] = {0};
  for (size_t i = 0; i < s->n; i++)
    order.keys[i] = (float)s->distances2[i];
  for (size_t i = s->n; i % BLOCK_KEYS != 0; i++)
    order.keys[i] = 0.0f; /* any number */
  for (size_t begin = 0; begin < s->n; begin += BLOCK_KEYS)
    rank_block(&order, begin, s->n);
  for (size_t i = 0; i < s->n; i++) {
    size_t first = (size_t)order.places[i], place = first + n_at[first]++;
    for (; place > first && is_candidate_nearer(s, i, sorted[place - 1]); place--)
      sorted[place] = sorted[place - 1];
    sorted[place] = (uint8_t)i;
  }
}

/* Writes the k nearest candidates, or all if there are fewer, nearest first. Returns how many. */
static size_t take_candidates(const neighbour_search *s, uint32_t *slots, double *distances2) {
  uint8_t sorted[MOST_CANDIDATES];
  size_t n = s->n < s->k ? s->n : s->k;
  sort_candidates(s, sorted);
  for (size_t i = 0; i < n; i++) {
    slots[i] = s->slots[sorted[i]];
    distances2[i] = s->distances2[sorted[i]];
  }
  return n;
}
/* NOLINTEND(clang-analyzer-core.*) */

/* Keeps the k nearest of more candidates. */
static void cut_candidates(neighbour_search *s) {
  double distances2[CONIC_MOST_NEAREST];
  uint32_t slots[CONIC_MOST_NEAREST];
  s->n = take_candidates(s, slots, distances2);
  memcpy(s->distances2, distances2, s->n * sizeof *distances2);
  memcpy(s->slots, slots, s->n * sizeof *slots);
  s->limit2 = distances2[s->n - 1];
}

static void search_leaf(neighbour_search *s, size_t i_leaf) {
  double distances2[CONIC_LEAF_SLOTS];
  size_t begin = conic_neighbours_leaf_begin(s->tree, i_leaf);
  size_t n = conic_neighbours_leaf_begin(s->tree, i_leaf + 1) - begin;
  for (size_t i = 0; i < n; i++)
    distances2[i] = conic_neighbours_distance2(s->tree, begin + i, s->query);
  for (size_t i = 0; i < n; i++) {
    s->distances2[s->n] = distances2[i];
    s->slots[s->n] = (uint32_t)(begin + i);
    s->n += (distances2[i] <= s->limit2) & (begin + i != s->except);
  }
  if (s->n > s->k + s->k / 2 + 4)
    cut_candidates(s);
}

static void begin_search(neighbour_search *s, const conic_neighbours *tree, const double query[3], uint32_t except,
                         size_t k, double limit2) {
  s->tree = tree;
  memcpy(s->query, query, sizeof s->query);
  s->except = except;
  s->k = k;
  s->n = 0;
  s->limit2 = limit2;
}

size_t conic_neighbours_nearest(const conic_neighbours *tree, const double query[3], uint32_t except, size_t k,
                                double limit2, uint32_t *slots, double *distances2) {
  neighbour_search s;
  begin_search(&s, tree, query, except, k, limit2);
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
  return take_candidates(&s, slots, distances2);
}

/* --- slots of one leaf after the other --- */

/* The reach of the list, as the square of a multiple of the distance to the last neighbour that one slot has. */
static const double AROUND_REACH2 = 1.7 * 1.7;

/* Lists the leaves within reach of a leaf's box. Rounding is monotonic: the distance of two boxes is not above that of
 * a point in one of them from the other. What does not fit leaves none listed. */
static void list_around(const conic_neighbours *tree, size_t i_leaf, double reach2, conic_neighbours_around *around) {
  size_t stack[MAX_DEPTH + 2];
  int n_stack = 0;
  const float *own = tree->boxes[tree->n_leaves - 1 + i_leaf];
  around->begin = conic_neighbours_leaf_begin(tree, i_leaf);
  around->end = conic_neighbours_leaf_begin(tree, i_leaf + 1);
  around->reach2 = reach2;
  around->n = 0;
  stack[n_stack++] = 0;
  while (n_stack > 0) {
    size_t i_node = stack[--n_stack];
    const float *box = tree->boxes[i_node];
    double distance2 = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      double above = (double)box[axis] - (double)own[3 + axis], below = (double)own[axis] - (double)box[3 + axis];
      double outside = above > below ? above : below;
      outside = outside > 0.0 ? outside : 0.0;
      distance2 += outside * outside;
    }
    if (!(distance2 <= reach2))
      continue;
    if (i_node < tree->n_leaves - 1) {
      stack[n_stack++] = 2 * i_node + 2;
      stack[n_stack++] = 2 * i_node + 1;
      continue;
    }
    if (around->n == CONIC_MOST_AROUND) {
      around->reach2 = -1.0;
      return;
    }
    memcpy(around->boxes[around->n], box, sizeof around->boxes[0]);
    around->leaves[around->n++] = (uint32_t)(i_node - (tree->n_leaves - 1));
  }
}

static void search_around(neighbour_search *s, const conic_neighbours_around *around) {
  uint32_t leaves[CONIC_MOST_AROUND + 1];
  double near2[CONIC_MOST_AROUND + 1];
  size_t n = 0;
  for (size_t i = 0; i < around->n; i += 2) {
    size_t first = i + 1 < around->n || i == 0 ? i : i - 1; /* the last pair may have one again */
    const box_pair both = box_distances2((const float(*)[6])around->boxes + first, s->query);
    for (size_t k = i - first; k < 2 && first + k < around->n; k++) { /* of one leaf, the other box is none */
      leaves[n] = around->leaves[first + k];
      near2[n] = both[k];
      n += both[k] <= s->limit2;
    }
  }
  for (size_t i = 0; i < n; i++)
    if (near2[i] <= s->limit2) /* NOLINT(clang-analyzer-core.UndefinedBinaryOperatorResult): i < n */
      search_leaf(s, leaves[i]);
}

/* A bound of the squared distance from a slot to its k-th neighbour, by the nearest slot whose k neighbours are known:
 * the distance to the farthest of these, with the slot itself replaced by that one. */
static double bound_around(const conic_neighbours *tree, const conic_neighbours_around *around, size_t slot,
                           const double query[3], size_t k) {
  double bound2 = 0.0, least2 = HUGE_VAL;
  size_t best = around->n_known;
  for (size_t i = 0; i < around->n_known; i++) {
    double distance2 = conic_neighbours_distance2(tree, around->known[i], query);
    best = distance2 < least2 || i == 0 ? i : best;
    least2 = distance2 < least2 ? distance2 : least2;
  }
  if (best == around->n_known)
    return HUGE_VAL;
  for (size_t i = 0; i < k; i++) {
    size_t other = around->nearest[best][i] == slot ? around->known[best] : around->nearest[best][i];
    double distance2 = conic_neighbours_distance2(tree, other, query);
    bound2 = distance2 > bound2 ? distance2 : bound2;
  }
  return bound2;
}

size_t conic_neighbours_of_slot(const conic_neighbours *tree, size_t slot, size_t k, conic_neighbours_around *around,
                                uint32_t *slots, double *distances2) {
  const double query[3] = {(double)tree->position[0][slot], (double)tree->position[1][slot],
                           (double)tree->position[2][slot]};
  double limit2 = bound_around(tree, around, slot, query, k);
  int is_same = slot >= around->begin && slot < around->end;
  size_t n;
  if (is_same && limit2 <= around->reach2) {
    neighbour_search s;
    begin_search(&s, tree, query, (uint32_t)slot, k, limit2);
    search_around(&s, around);
    n = take_candidates(&s, slots, distances2);
  } else
    n = conic_neighbours_nearest(tree, query, (uint32_t)slot, k, limit2, slots, distances2);
  if (n < k || k == 0)
    return n;
  if (!is_same) {
    size_t i_leaf = (size_t)((uint64_t)slot * (uint64_t)tree->n_leaves / (uint64_t)tree->n_slots);
    i_leaf += conic_neighbours_leaf_begin(tree, i_leaf + 1) <= slot;
    list_around(tree, i_leaf, AROUND_REACH2 * distances2[n - 1], around);
    around->n_known = 0;
  }
  if (around->n_known < CONIC_LEAF_SLOTS) {
    around->known[around->n_known] = (uint32_t)slot;
    memcpy(around->nearest[around->n_known++], slots, k * sizeof *slots);
  }
  return n;
}
