/* The structure of a point-octree: space split at the mean of each node's points (Confetti §3.2). */
#include "lod/octree/octree_nodes.h"

/* Larger nodes are split one after the other, the subtrees below them side by side. */
static const size_t task_points = 32768;

/* Splitting at the mean takes more levels than this only where points crowd towards one place by the thousandth of a
 * thousandth; such a node is cut into eight by order, which ends after another few. */
enum { DEEPEST_MEAN = 96, FANOUT = CONIC_NODE_FANOUT, FEW_POINTS = 64 };

/* A subtree that is yet to be split, or the children's byte of a node that has been. */
typedef struct top_item {
  size_t begin, end; /* of the points; both 0 for a node */
  size_t n_nodes;
  uint8_t children;
  int depth;
} top_item;

typedef struct splitter {
  conic_split *split;
  float *scratch[3]; /* by point, like the split's own arrays */
  uint32_t *scratch_index;
  uint8_t *octants;
  uint8_t *children; /* a subtree's bytes begin where its points do */
  top_item *top;     /* in preorder */
  size_t n_top, top_room;
} splitter;

/* Where the parts of a node begin: parts with one point first. */
typedef struct parts {
  int n_direct, n_inner;
  size_t begin[FANOUT + 1];
} parts;

/* The axes together: their sums do not wait for each other. */
static void find_mean(const splitter *s, size_t begin, size_t end, double mean[3]) {
  const float *x = s->split->position[0], *y = s->split->position[1], *z = s->split->position[2];
  double sums[3] = {0.0, 0.0, 0.0};
  for (size_t i = begin; i < end; i++) {
    sums[0] += (double)x[i];
    sums[1] += (double)y[i];
    sums[2] += (double)z[i];
  }
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = sums[axis] / (double)(end - begin);
}

/* The greatest float that is not above the value: what floats are above is the same of both. */
static float round_down(double value) {
  float rounded = (float)value;
  if ((double)rounded > value) { /* the next one down */
    uint32_t bits = conic_bits_of_float(rounded);
    bits = rounded > 0.0f ? bits - 1 : rounded < 0.0f ? bits + 1 : UINT32_C(0x80000001);
    memcpy(&rounded, &bits, sizeof rounded);
  }
  return rounded;
}

/* Which octant about the mean each point is in; returns how many of them have any. */
static int find_octants(const splitter *s, size_t begin, size_t end, size_t counts[FANOUT]) {
  const float *x = s->split->position[0], *y = s->split->position[1], *z = s->split->position[2];
  uint8_t *octants = s->octants;
  double mean[3];
  int n_used = 0;
  find_mean(s, begin, end, mean);
  const float mean_x = round_down(mean[0]), mean_y = round_down(mean[1]), mean_z = round_down(mean[2]);
  memset(counts, 0, FANOUT * sizeof *counts);
  for (size_t i = begin; i < end; i++)
    octants[i] = (uint8_t)((x[i] > mean_x) | (y[i] > mean_y) << 1 | (z[i] > mean_z) << 2);
  for (size_t i = begin; i < end; i++)
    counts[octants[i]]++;
  for (int octant = 0; octant < FANOUT; octant++)
    n_used += counts[octant] > 0;
  return n_used;
}

/* Moves the points into the order of their octants, the lonely ones first, and within one as they were. */
static void move_points(splitter *s, size_t begin, size_t end, const size_t places[FANOUT]) {
  conic_split *split = s->split;
  size_t next[FANOUT], n = end - begin;
  for (int axis = 0; axis < 3; axis++) {
    memcpy(next, places, sizeof next);
    for (size_t i = begin; i < end; i++)
      s->scratch[axis][next[s->octants[i]]++] = split->position[axis][i];
    memcpy(split->position[axis] + begin, s->scratch[axis] + begin, n * sizeof(float));
  }
  memcpy(next, places, sizeof next);
  for (size_t i = begin; i < end; i++)
    s->scratch_index[next[s->octants[i]]++] = split->index[i];
  memcpy(split->index + begin, s->scratch_index + begin, n * sizeof(uint32_t));
}

/* The same of few points, each of whose places is found once. */
static void move_few(const splitter *s, size_t begin, size_t n, size_t places[FANOUT]) {
  conic_split *split = s->split;
  float moved[FEW_POINTS];
  uint32_t moved_index[FEW_POINTS];
  uint8_t to[FEW_POINTS];
  for (size_t i = 0; i < n; i++)
    to[i] = (uint8_t)(places[s->octants[begin + i]]++ - begin);
  for (int axis = 0; axis < 3; axis++) {
    float *position = split->position[axis] + begin;
    for (size_t i = 0; i < n; i++)
      moved[to[i]] = position[i];
    for (size_t i = 0; i < n; i++)
      position[i] = moved[i];
  }
  for (size_t i = 0; i < n; i++)
    moved_index[to[i]] = split->index[begin + i];
  for (size_t i = 0; i < n; i++)
    split->index[begin + i] = moved_index[i];
}

/* Equal parts by order, the smaller ones first. */
static void cut_by_order(size_t begin, size_t end, parts *result) {
  size_t n = end - begin, n_parts = n < FANOUT ? n : FANOUT, larger = n % n_parts;
  memset(result, 0, sizeof *result);
  result->begin[0] = begin;
  for (size_t i = 0; i < n_parts; i++) {
    size_t size = n / n_parts + (i >= n_parts - larger);
    result->begin[i + 1] = result->begin[i] + size;
    result->n_direct += size == 1;
    result->n_inner += size > 1;
  }
}

/* Two points part always, and half of the nodes are no more: they only may have to change places. */
static void split_pair(const splitter *s, size_t begin, parts *result) {
  conic_split *split = s->split;
  int first_octant = 0, last_octant = 0;
  for (int axis = 0; axis < 3; axis++) {
    const float *pair = split->position[axis] + begin;
    double mean = ((double)pair[0] + (double)pair[1]) / 2.0;
    first_octant |= ((double)pair[0] > mean) << axis;
    last_octant |= ((double)pair[1] > mean) << axis;
  }
  if (first_octant > last_octant) {
    for (int axis = 0; axis < 3; axis++) {
      float *pair = split->position[axis] + begin, first = pair[0];
      pair[0] = pair[1];
      pair[1] = first;
    }
    uint32_t *pair = split->index + begin, first = pair[0];
    pair[0] = pair[1];
    pair[1] = first;
  }
  *result = (parts){.n_direct = 2, .begin = {begin, begin + 1, begin + 2}};
}

static void split_node(splitter *s, size_t begin, size_t end, int depth, parts *result) {
  size_t counts[FANOUT], places[FANOUT], place = begin;
  if (end - begin == 2 && depth < DEEPEST_MEAN) {
    split_pair(s, begin, result);
    return;
  }
  if (depth >= DEEPEST_MEAN || find_octants(s, begin, end, counts) < 2) {
    cut_by_order(begin, end, result);
    return;
  }
  memset(result, 0, sizeof *result);
  for (int is_inner = 0; is_inner < 2; is_inner++)
    for (int octant = 0; octant < FANOUT; octant++)
      if (counts[octant] && (counts[octant] > 1) == is_inner) {
        result->begin[result->n_direct + result->n_inner] = places[octant] = place;
        place += counts[octant];
        result->n_direct += !is_inner;
        result->n_inner += is_inner;
      }
  result->begin[result->n_direct + result->n_inner] = place;
  if (end - begin <= FEW_POINTS)
    move_few(s, begin, end - begin, places);
  else
    move_points(s, begin, end, places);
}

static uint8_t children_byte(const parts *p) {
  return (uint8_t)(p->n_direct | p->n_inner << 4);
}

/* Splits a whole subtree; its bytes go to `children`. Returns how many. */
static size_t split_subtree(splitter *s, size_t begin, size_t end, int depth, uint8_t *children) {
  parts p;
  size_t n_nodes = 1;
  split_node(s, begin, end, depth, &p);
  children[0] = children_byte(&p);
  for (int i = p.n_direct; i < p.n_direct + p.n_inner; i++)
    n_nodes += split_subtree(s, p.begin[i], p.begin[i + 1], depth + 1, children + n_nodes);
  return n_nodes;
}

static conic_status add_top(conic_context *context, splitter *s, const top_item *item) {
  return conic_memory_append(context, &s->top, &s->n_top, &s->top_room, item, sizeof *item);
}

/* Splits the nodes that are too large for a task, and lists in preorder what is left. */
static conic_status split_top(conic_context *context, splitter *s, size_t begin, size_t end, int depth) {
  parts p;
  top_item item = {.begin = begin, .end = end, .depth = depth};
  if (end - begin <= task_points)
    return add_top(context, s, &item);
  conic_status status = conic_progress(context, "octree", 0.1 * (double)begin / (double)s->split->n);
  if (status != CONIC_OK)
    return status;
  split_node(s, begin, end, depth, &p);
  item = (top_item){.children = children_byte(&p), .n_nodes = 1};
  status = add_top(context, s, &item);
  for (int i = p.n_direct; i < p.n_direct + p.n_inner && status == CONIC_OK; i++)
    status = split_top(context, s, p.begin[i], p.begin[i + 1], depth + 1);
  return status;
}

static void split_task(void *data, size_t i_item) {
  splitter *s = data;
  top_item *item = &s->top[i_item];
  if (item->end > item->begin)
    item->n_nodes = split_subtree(s, item->begin, item->end, item->depth, s->children + item->begin);
}

/* Brings the bytes of the top and of all subtrees into one preorder. */
static void join_tasks(splitter *s) {
  conic_split *split = s->split;
  split->n_nodes = 0;
  for (size_t i = 0; i < s->n_top; i++) {
    const top_item *item = &s->top[i];
    if (item->end > item->begin)
      memcpy(split->children + split->n_nodes, s->children + item->begin, item->n_nodes);
    else
      split->children[split->n_nodes] = item->children;
    split->n_nodes += item->n_nodes;
  }
}

conic_status conic_octree_split(conic_context *context, conic_split *split) {
  splitter s = {.split = split};
  conic_status status = CONIC_OK;
  split->n_nodes = 0;
  if (split->n < 2)
    return CONIC_OK;
  status = conic_memory_allocate_these(context, CONIC_ROOM(s.scratch[0], split->n), CONIC_ROOM(s.scratch[1], split->n),
                                       CONIC_ROOM(s.scratch[2], split->n), CONIC_ROOM(s.scratch_index, split->n),
                                       CONIC_ROOM(s.octants, split->n), CONIC_ROOM(s.children, split->n));
  if (status == CONIC_OK)
    status = split_top(context, &s, 0, split->n, 0);
  if (status == CONIC_OK)
    status = conic_parallel_told(context, "octree", 0.1, 0.3, s.n_top, split_task, &s);
  if (status == CONIC_OK)
    join_tasks(&s);
  for (int axis = 0; axis < 3; axis++)
    conic_memory_release(context, s.scratch[axis]);
  conic_memory_release_these(context, s.scratch_index, s.octants, s.children, s.top);
  return status;
}
