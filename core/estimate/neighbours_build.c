/* Builds the kd-tree: coincident points are joined, then ranges are halved across their longest side. */

#include "core/base/random.h"
#include "core/base/vectors.h"
#include "core/estimate/neighbours.h"
#include "core/estimate/places.h"

enum { SHARED_LEVELS = 6 };

/* A tree of so many takes long enough to report progress. */
enum { MANY_SLOTS = 1 << 18, SUBTREES_A_REPORT = 4 };

typedef struct point_record {
  float position[3];
  uint32_t point;
} point_record;

static int is_finite(const point_record *r) {
  return r->position[0] * 0.0f == 0.0f && r->position[1] * 0.0f == 0.0f && r->position[2] * 0.0f == 0.0f;
}

/* Gathers the finite positions into `records`, coincident ones once; for now, slot_of_point is the number of the
 * point's record. */
static conic_status gather_points(conic_context *context, const float *const positions[3], conic_neighbours *tree,
                                  point_record *records) {
  conic_status status = conic_places_find(context, positions, tree->n_points, tree->slot_of_point);
  for (size_t i = 0; i < tree->n_points && status == CONIC_OK; i++) {
    const point_record r = {{positions[0][i], positions[1][i], positions[2][i]}, (uint32_t)i};
    uint32_t *slot = &tree->slot_of_point[i], first = *slot;
    if (!is_finite(&r)) {
      tree->n_not_finite++;
      *slot = CONIC_NO_SLOT;
    } else if (first == i) {
      *slot = (uint32_t)tree->n_slots;
      records[tree->n_slots++] = r;
    } else {
      tree->n_duplicates++;
      *slot = tree->slot_of_point[first];
    }
  }
  return status;
}

/* A strict order of the records: by the axis, then by the next ones, so that splits are unique. */
static int comes_before_by_next(const point_record *a, const point_record *b, int axis) {
  for (int step = 1; step < 3; step++) {
    int other = (axis + step) % 3;
    if (a->position[other] != b->position[other])
      return a->position[other] < b->position[other];
  }
  return 0;
}

static inline int comes_before(const point_record *a, const point_record *b, int axis) {
  int is_before = a->position[axis] < b->position[axis];
  return a->position[axis] == b->position[axis] ? comes_before_by_next(a, b, axis) : is_before;
}

static point_record median_of_three(const point_record *a, const point_record *b, const point_record *c, int axis) {
  if (comes_before(b, a, axis)) {
    const point_record *swap = a;
    a = b;
    b = swap;
  }
  return comes_before(b, c, axis) ? *b : comes_before(a, c, axis) ? *c : *a;
}

static void swap_records(point_record *a, point_record *b) {
  point_record swap = *a;
  *a = *b;
  *b = swap;
}

/* The exchanges of Hoare's split, but for whole blocks at both ends what is on the wrong side is noted first: that
 * branches on no comparison, which could not be foreseen. What is left between is for less than two blocks. */
enum { MOST_IN_BLOCK = 64, FEWEST_IN_BLOCK = 4 };
static void split_blocks(point_record *records, ptrdiff_t *low, ptrdiff_t *high, const point_record *pivot, int axis) {
  ptrdiff_t n;
  while ((n = (*high - *low + 1) / 2) >= FEWEST_IN_BLOCK) {
    uint8_t lefts[MOST_IN_BLOCK], rights[MOST_IN_BLOCK];
    ptrdiff_t n_lefts = 0, n_rights = 0, k = 0;
    n = n < MOST_IN_BLOCK ? n : MOST_IN_BLOCK;
    for (ptrdiff_t i = 0; i < n; i++) {
      lefts[n_lefts] = rights[n_rights] = (uint8_t)i;
      n_lefts += !comes_before(&records[*low + i], pivot, axis);
      n_rights += !comes_before(pivot, &records[*high - i], axis);
    }
    for (; k < n_lefts && k < n_rights; k++)
      swap_records(&records[*low + lefts[k]], &records[*high - rights[k]]);
    *low += k < n_lefts ? lefts[k] : n;
    *high -= k < n_rights ? rights[k] : n;
  }
}

/* Reorders so that the first n_left records come before all others along the axis (Hoare's FIND). Pivots come from
 * places that no usual arrangement of points defeats. */
static void partition(point_record *records, size_t n, size_t n_left, int axis) {
  ptrdiff_t begin = 0, last = (ptrdiff_t)n - 1, wanted = (ptrdiff_t)n_left;
  while (begin < last) {
    uint64_t draw = conic_random_mix((uint64_t)begin * 0x9E3779B97F4A7C15u + (uint64_t)last),
             span = (uint64_t)(last - begin) + 1;
    const point_record *from = records + begin;
    point_record pivot =
        median_of_three(&from[(draw & 0xFFFFF) * span >> 20], &from[(draw >> 20 & 0xFFFFF) * span >> 20],
                        &from[(draw >> 40 & 0xFFFFF) * span >> 20], axis);
    ptrdiff_t low = begin, high = last;
    split_blocks(records, &low, &high, &pivot, axis);
    while (low <= high) {
      while (comes_before(&records[low], &pivot, axis))
        low++;
      while (comes_before(&pivot, &records[high], axis))
        high--;
      if (low <= high)
        swap_records(&records[low++], &records[high--]);
    }
    if (high < wanted)
      begin = low;
    if (wanted < low)
      last = high;
  }
}

typedef struct build {
  conic_neighbours *tree;
  point_record *records;
  size_t n_level_nodes; /* nodes of the level at work */
} build;

static void bound_box(const point_record *records, size_t n, float box[6]) {
  for (int axis = 0; axis < 3; axis++)
    box[axis] = box[3 + axis] = records[0].position[axis];
  for (size_t i = 1; i < n; i++)
    for (int axis = 0; axis < 3; axis++) {
      float value = records[i].position[axis];
      CONIC_WIDEN(box[axis], box[3 + axis], value, value);
    }
}

static int longest_side(const float box[6]) {
  double side[3];
  for (int axis = 0; axis < 3; axis++)
    side[axis] = (double)box[3 + axis] - (double)box[axis];
  return side[0] >= side[1] ? (side[0] >= side[2] ? 0 : 2) : side[1] >= side[2] ? 1 : 2;
}

/* Bounds the node that covers the leaves [first, first + n_leaves), and halves its records where it has children. */
static void make_node(build *b, size_t i_node, size_t first, size_t n_leaves) {
  conic_neighbours *tree = b->tree;
  size_t begin = conic_neighbours_leaf_begin(tree, first), end = conic_neighbours_leaf_begin(tree, first + n_leaves);
  bound_box(b->records + begin, end - begin, tree->boxes[i_node]);
  if (n_leaves > 1) {
    size_t middle = conic_neighbours_leaf_begin(tree, first + n_leaves / 2);
    partition(b->records + begin, end - begin, middle - begin, longest_side(tree->boxes[i_node]));
  }
}

static void make_subtree(build *b, size_t i_node, size_t first, size_t n_leaves) {
  make_node(b, i_node, first, n_leaves);
  if (n_leaves > 1) {
    make_subtree(b, 2 * i_node + 1, first, n_leaves / 2);
    make_subtree(b, 2 * i_node + 2, first + n_leaves / 2, n_leaves / 2);
  }
}

static void make_level_node(void *data, size_t i_item) {
  build *b = data;
  size_t n_leaves = b->tree->n_leaves / b->n_level_nodes;
  make_node(b, b->n_level_nodes - 1 + i_item, i_item * n_leaves, n_leaves);
}

static void make_level_subtree(void *data, size_t i_item) {
  build *b = data;
  size_t n_leaves = b->tree->n_leaves / b->n_level_nodes;
  make_subtree(b, b->n_level_nodes - 1 + i_item, i_item * n_leaves, n_leaves);
}

/* Makes the nodes of the top levels level by level, then the subtrees below them. */
static conic_status make_tree(conic_context *context, build *b) {
  int is_reported = b->tree->n_slots >= MANY_SLOTS;
  b->n_level_nodes = 1;
  for (int level = 0; level < SHARED_LEVELS && b->n_level_nodes < b->tree->n_leaves; level++) {
    conic_status status = is_reported ? conic_progress(context, "neighbours", 0.0) : CONIC_OK;
    if (status != CONIC_OK)
      return status;
    conic_parallel_for(context, b->n_level_nodes, make_level_node, b);
    b->n_level_nodes *= 2;
  }
  if (is_reported)
    return conic_parallel_runs(context, "neighbours", 0.0, 1.0, b->n_level_nodes, SUBTREES_A_REPORT, make_level_subtree,
                               b);
  conic_parallel_for(context, b->n_level_nodes, make_level_subtree, b);
  return CONIC_OK;
}

/* Takes the positions in their final order, and turns record numbers into slots with `slot_of_record`. */
static void settle(conic_neighbours *tree, const point_record *records, uint32_t *slot_of_record) {
  for (size_t slot = 0; slot < tree->n_slots; slot++) {
    for (int axis = 0; axis < 3; axis++)
      tree->position[axis][slot] = records[slot].position[axis];
    tree->point_of_slot[slot] = records[slot].point;
    slot_of_record[tree->slot_of_point[records[slot].point]] = (uint32_t)slot;
  }
  for (size_t i = 0; i < tree->n_points; i++)
    if (tree->slot_of_point[i] != CONIC_NO_SLOT)
      tree->slot_of_point[i] = slot_of_record[tree->slot_of_point[i]];
}

static conic_status allocate_tree(conic_context *context, conic_neighbours *tree) {
  for (tree->n_leaves = 1; tree->n_leaves * CONIC_LEAF_SLOTS < tree->n_slots;)
    tree->n_leaves *= 2;
  for (int axis = 0; axis < 3; axis++)
    tree->position[axis] = conic_memory_allocate(context, tree->n_slots + CONIC_LEAF_ROOM, sizeof(float));
  tree->point_of_slot = conic_memory_allocate(context, tree->n_slots, sizeof *tree->point_of_slot);
  tree->boxes = conic_memory_allocate(context, 2 * tree->n_leaves - 1, sizeof *tree->boxes);
  return tree->position[0] && tree->position[1] && tree->position[2] && tree->point_of_slot && tree->boxes
             ? CONIC_OK
             : CONIC_ERROR_MEMORY;
}

static conic_status build_with(conic_context *context, const float *const positions[3], conic_neighbours *tree,
                               point_record *records) {
  conic_status status = gather_points(context, positions, tree, records);
  if (status == CONIC_OK)
    status = allocate_tree(context, tree);
  if (status != CONIC_OK || tree->n_slots == 0)
    return status;
  uint32_t *slot_of_record = conic_memory_allocate(context, tree->n_slots, sizeof *slot_of_record);
  if (!slot_of_record)
    return CONIC_ERROR_MEMORY;
  build b = {tree, records, 1};
  status = make_tree(context, &b);
  if (status == CONIC_OK)
    settle(tree, records, slot_of_record);
  conic_memory_release(context, slot_of_record);
  return status;
}

conic_status conic_neighbours_build(conic_context *context, const float *const positions[3], size_t count,
                                    conic_neighbours *tree) {
  conic_isa isa;
  memset(tree, 0, sizeof *tree);
  if (count > UINT32_MAX - 1)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%zu points are too many to find neighbours for", count);
  conic_status chosen = conic_isa_choose(context, CONIC_ISA_AUTO, &isa);
  if (chosen != CONIC_OK)
    return chosen;
  conic_neighbour_loops_init(&tree->loops, isa);
  tree->n_points = count;
  tree->slot_of_point = conic_memory_allocate(context, count, sizeof *tree->slot_of_point);
  point_record *records = conic_memory_allocate(context, count, sizeof *records);
  conic_status status = CONIC_ERROR_MEMORY;
  if (records && tree->slot_of_point)
    status = build_with(context, positions, tree, records);
  conic_memory_release(context, records);
  if (status != CONIC_OK)
    conic_neighbours_release(context, tree);
  return status;
}

void conic_neighbours_release(conic_context *context, conic_neighbours *tree) {
  for (int axis = 0; axis < 3; axis++)
    conic_memory_release(context, tree->position[axis]);
  conic_memory_release_these(context, tree->point_of_slot, tree->slot_of_point, tree->boxes);
  memset(tree, 0, sizeof *tree);
}
