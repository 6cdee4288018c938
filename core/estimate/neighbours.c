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
  MOST_CANDIDATES = CONIC_MOST_NEAREST + MOST_BESIDE + CONIC_LEAF_SLOTS
};

typedef struct neighbour_search {
  const conic_neighbours *tree;
  double query[3];
  uint32_t except;
  size_t k, n;   /* candidates */
  double limit2; /* farther slots are not wanted: first the caller's limit, later the distance of the last slot that was
                    kept */
  double distances2[CONIC_FOUND_ROOM];
  uint32_t slots[CONIC_FOUND_ROOM];
} neighbour_search;

static int is_candidate_nearer(const neighbour_search *s, size_t a, size_t b) {
  return s->distances2[a] < s->distances2[b] ||
         (s->distances2[a] == s->distances2[b] && lies_before(s->tree, s->slots[a], s->slots[b]));
}

/* NOLINTBEGIN(clang-analyzer-core.*): it does not see what memcpy and vectors write */
/* Lists the candidates, nearest first, by their squared distances as floats. Candidates with the same key share a
 * place, from which on they are put in order. */
static void sort_candidates(const neighbour_search *s, uint8_t sorted[MOST_CANDIDATES]) {
  float keys[MOST_CANDIDATES + CONIC_KEYS_AT_ONCE];
  uint32_t places[MOST_CANDIDATES + CONIC_KEYS_AT_ONCE];
  uint8_t n_at[MOST_CANDIDATES] = {0};
  size_t sum = 0;
  for (size_t i = 0; i < s->n; i++)
    keys[i] = (float)s->distances2[i];
  s->tree->loops.rank(keys, s->n, places);
  for (size_t i = 0; i < s->n; i++) {
    sorted[places[i]] = (uint8_t)i;
    sum += places[i];
  }
  if (sum == s->n * (s->n - 1) / 2) /* each has a place of its own */
    return;
  for (size_t i = 0; i < s->n; i++) {
    size_t first = places[i], place = first + n_at[first]++;
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

/* How far the leaves around reach, in distances to the last neighbour of the slot before; a bound beyond the greatest
 * is of a slot far from it. */
static const double AROUND_REACH = 2.0, GREATEST_REACH = 2.5;

/* A sum of distances is at least so near to the true one. */
static const double ROUNDED_UP = 1.0 + 1e-12;

static void append_around(const conic_neighbours *tree, size_t i_leaf, const float *box, conic_near_leaves *near) {
  size_t begin = conic_neighbours_leaf_begin(tree, i_leaf), end = conic_neighbours_leaf_begin(tree, i_leaf + 1);
  size_t room = near->n * CONIC_LEAF_ROOM, n = end - begin;
  near->first[near->n] = (uint32_t)begin;
  for (int axis = 0; axis < 3; axis++) {
    near->low[axis][near->n] = box[axis];
    near->high[axis][near->n] = box[3 + axis];
    memcpy(near->place[axis] + room, tree->position[axis] + begin, CONIC_LEAF_ROOM * sizeof(float)); /* and others */
  }
  for (; n < CONIC_LEAF_ROOM; n++)
    near->place[0][room + n] = NAN;
  near->n++;
}

/* The squared distance between two boxes. Rounding is monotonic: it is not above that of a point in one of them from
 * the other. */
static inline double boxes_apart2(const float a[6], const float b[6]) {
  double distance2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double above = (double)a[axis] - (double)b[3 + axis], below = (double)b[axis] - (double)a[3 + axis];
    double outside = above > below ? above : below;
    outside = outside > 0.0 ? outside : 0.0;
    distance2 += outside * outside;
  }
  return distance2;
}

/* Puts the leaves within reach of a slot's two leaves side by side. If there are too many, the reach is none. */
static void list_around(const conic_neighbours *tree, size_t slot, double reach, conic_neighbours_around *around) {
  conic_near_leaves *near = &around->near;
  size_t stack[MAX_DEPTH + 2], n_above = tree->n_leaves - 1, n = 0;
  size_t i_leaf = (size_t)((uint64_t)slot * (uint64_t)tree->n_leaves / (uint64_t)tree->n_slots);
  i_leaf += conic_neighbours_leaf_begin(tree, i_leaf + 1) <= slot;
  size_t i_both = tree->n_leaves > 1 ? (n_above + i_leaf - 1) / 2 : 0;
  const float *own = tree->boxes[i_both];
  around->begin = conic_neighbours_leaf_begin(tree, i_leaf & ~(size_t)1);
  around->end = conic_neighbours_leaf_begin(tree, tree->n_leaves > 1 ? (i_leaf | 1) + 1 : 1);
  around->reach2 = -1.0;
  near->n = 0;
  stack[n++] = 0;
  while (n > 0) {
    size_t i_node = stack[--n], first = 2 * i_node + 1;
    if (i_node < n_above) {
      stack[n] = first + 1;
      n += boxes_apart2(tree->boxes[first + 1], own) <= reach * reach;
      stack[n] = first;
      n += boxes_apart2(tree->boxes[first], own) <= reach * reach;
    } else if (near->n < CONIC_MOST_NEAR_LEAVES)
      append_around(tree, i_node - n_above, tree->boxes[i_node], near);
    else
      return;
  }
  for (size_t i = near->n; i < near->n + CONIC_NEAR_LEAVES_ROOM - CONIC_MOST_NEAR_LEAVES; i++)
    for (int axis = 0; axis < 3; axis++)
      near->low[axis][i] = near->high[axis][i] = HUGE_VALF; /* near nothing */
  around->reach2 = reach * reach;
}

/* Returns also where many are as near. */
static size_t search_around(const conic_neighbours *tree, const conic_near_leaves *near, const double query[3],
                            uint32_t except, size_t k, double limit2, uint32_t *slots, double *distances2) {
  neighbour_search s;
  begin_search(&s, tree, query, except, k, limit2);
  s.n = tree->loops.find(near, query, limit2, except, s.slots, s.distances2);
  return s.n <= MOST_CANDIDATES ? take_candidates(&s, slots, distances2) : 0;
}

/* A bound of the distance from a place to its k-th neighbour, by the nearest of the last slots and how far its k
 * neighbours reach: with the slot itself replaced by that one, they are as many about the slot. */
static double bound_around(const conic_neighbours_around *around, const double query[3], double *reach) {
  double least2 = HUGE_VAL;
  size_t n = around->n_known < CONIC_LAST_KNOWN ? around->n_known : CONIC_LAST_KNOWN;
  *reach = HUGE_VAL;
  for (size_t i = 0; i < n; i++) {
    const double *place = around->known[i];
    double x = place[0] - query[0], y = place[1] - query[1], z = place[2] - query[2];
    double distance2 = x * x + y * y + z * z;
    *reach = distance2 < least2 ? around->reach[i] : *reach;
    least2 = distance2 < least2 ? distance2 : least2;
  }
  return (sqrt(least2) + *reach) * ROUNDED_UP;
}

size_t conic_neighbours_of_slot(const conic_neighbours *tree, size_t slot, size_t k, conic_neighbours_around *around,
                                uint32_t *slots, double *distances2) {
  const double query[3] = {(double)tree->position[0][slot], (double)tree->position[1][slot],
                           (double)tree->position[2][slot]};
  double reach, limit = bound_around(around, query, &reach), limit2 = limit * limit;
  int is_same = slot >= around->begin && slot < around->end;
  size_t n = 0;
  if (!is_same && limit < GREATEST_REACH * reach) {
    reach = limit > AROUND_REACH * reach ? limit : AROUND_REACH * reach;
    list_around(tree, slot, reach, around);
    is_same = 1;
  }
  if (is_same && limit2 <= around->reach2)
    n = search_around(tree, &around->near, query, (uint32_t)slot, k, limit2, slots, distances2);
  if (n == 0)
    n = conic_neighbours_nearest(tree, query, (uint32_t)slot, k, limit2, slots, distances2);
  if (n < k || k == 0)
    return n;
  reach = sqrt(distances2[n - 1]);
  if (!is_same)
    list_around(tree, slot, AROUND_REACH * reach, around);
  size_t last = around->n_known++ % CONIC_LAST_KNOWN;
  memcpy(around->known[last], query, sizeof query);
  around->reach[last] = reach;
  return n;
}
