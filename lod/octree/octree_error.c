/* The errors of inner nodes: how far their discs reach past the surface that is there. What covers a disc is sought
 * among the leaves, its own and those around, or, for large nodes, among small nodes and their errors. So nodes are
 * taken in classes by their size. What a class looks at belongs to the classes below. */

#include "core/base/real.h"
#include "core/base/team_runs.h"
#include "core/base/vectors.h"
#include "lod/octree/octree_loops.h"

/* Subtrees with as many leaves are worked off at a time: their discs stay in the cache. */
static const size_t task_leaves = 8192;

/* A class: nodes with more leaves than `above` and no more than `most` look at subtrees with no more than `part`; what
 * is around is found for subtrees with no more than `group`. */
typedef struct size_class {
  size_t above, most, part, group;
} size_class;

typedef struct error_pass {
  conic_octree *octree;
  conic_disc_samples samples;
  conic_octree_loops loops;
  size_class sizes;
  uint32_t *tasks; /* roots */
  conic_status *statuses;
  size_t n_tasks;
  double from, to; /* of the progress */
} error_pass;

typedef struct error_box {
  float low[3], high[3];
} error_box;

/* A node of the class. */
typedef struct member {
  conic_node_disc disc;
  float radius;
  uint32_t i_node;
} member;

/* What one task works with: the largest subtrees of the class, one by one, with what is around each. */
typedef struct neighbourhood {
  const error_pass *pass;
  conic_discs discs; /* of the surface: first those of the subtree, in the order of the hierarchy, then some around */
  float *numbers;    /* where they lie */
  conic_near_discs near;
  float *near_numbers;
  uint32_t *near_blocks;
  uint32_t *first_leaf; /* of each of the subtree's */
  member *members;
  size_t n_members;
  size_t n_own, room; /* discs */
} neighbourhood;

static size_t count_leaves(const conic_octree *octree, size_t i) {
  return octree->first_leaf[octree->end[i]] - octree->first_leaf[i];
}

/* Whether disc k reaches into the box; a larger one that is quicker to tell. */
static int is_in_box(const error_box *b, const conic_discs *discs, size_t k) {
  int is_in = 1;
  for (int axis = 0; axis < 3; axis++) {
    float half = fabsf(discs->u[axis][k]) + fabsf(discs->v[axis][k]), center = discs->center[axis][k];
    is_in &= center - half <= b->high[axis] && center + half >= b->low[axis];
  }
  return is_in;
}

static void add_to_box(float center, float half, int axis, error_box *b) {
  float low = center - half, high = center + half;
  CONIC_WIDEN(b->low[axis], b->high[axis], low, high);
}

/* Around the subtree's own discs and those of its nodes. */
static error_box box_of_group(const neighbourhood *around) {
  error_box b;
  for (int axis = 0; axis < 3; axis++) {
    b.low[axis] = HUGE_VALF;
    b.high[axis] = -HUGE_VALF;
    for (size_t k = 0; k < around->n_own; k++)
      add_to_box(around->discs.center[axis][k], around->discs.half[axis][k], axis, &b);
    for (size_t k = 0; k < around->n_members; k++) {
      const conic_node_disc *disc = &around->members[k].disc;
      add_to_box(disc->center[axis], sqrtf(disc->u[axis] * disc->u[axis] + disc->v[axis] * disc->v[axis]), axis, &b);
    }
  }
  return b;
}

static void node_at(const conic_octree *octree, size_t i, conic_node *node) {
  double first[3];
  conic_vector_at(octree->leaves.position, octree->first_leaf[i], first);
  conic_code_decode(&octree->scale, first, octree->codes + i * CONIC_NODE_BYTES, node);
}

static void set_disc_of_node(const conic_octree *octree, size_t i, const conic_discs *discs, size_t k) {
  float cutoff = (float)octree->scale.cutoff;
  conic_node node;
  node_at(octree, i, &node);
  for (int axis = 0; axis < 3; axis++) {
    discs->center[axis][k] = node.position[axis];
    discs->u[axis][k] = cutoff * node.tangent_u[axis];
    discs->v[axis][k] = cutoff * node.tangent_v[axis];
  }
  discs->error[k] = node.error;
}

static void set_disc_of_leaf(const conic_octree *octree, size_t i, const conic_discs *discs, size_t k) {
  float cutoff = (float)octree->scale.cutoff;
  for (int axis = 0; axis < 3; axis++) {
    discs->center[axis][k] = octree->leaves.position[axis][i];
    discs->u[axis][k] = cutoff * octree->leaves.tangent_u[axis][i];
    discs->v[axis][k] = cutoff * octree->leaves.tangent_v[axis][i];
  }
  discs->error[k] = 0.0f;
  if (conic_octree_clip(octree, i)) { /* what is left of it may be at its other end */
    float sum = 0.0f;
    for (int axis = 0; axis < 3; axis++)
      sum += discs->u[axis][k] * discs->u[axis][k] + discs->v[axis][k] * discs->v[axis][k];
    discs->error[k] = 2.0f * sqrtf(sum);
  }
}

/* The same of a leaf that is no disc yet. */
static int is_leaf_in_box(const conic_octree *octree, size_t i, const error_box *b) {
  const conic_splats *leaves = &octree->leaves;
  float cutoff = (float)octree->scale.cutoff;
  for (int axis = 0; axis < 3; axis++) {
    float half = fabsf(cutoff * leaves->tangent_u[axis][i]) + fabsf(cutoff * leaves->tangent_v[axis][i]);
    float center = leaves->position[axis][i];
    if (!(center - half <= b->high[axis] && center + half >= b->low[axis]))
      return 0;
  }
  return 1;
}

/* Whether subtree i reaches into the box. Reads of its code what no other thread writes. */
static int is_near(const conic_octree *octree, size_t i, const error_box *b) {
  float center[3], radius, apart2 = 0.0f;
  double first[3];
  conic_vector_at(octree->leaves.position, octree->first_leaf[i], first);
  conic_code_sphere(&octree->scale, first, octree->codes + i * CONIC_NODE_BYTES, center, &radius);
  for (int axis = 0; axis < 3; axis++) {
    float below = b->low[axis] - center[axis], above = center[axis] - b->high[axis];
    float apart = below > above ? below : above;
    apart2 += apart > 0.0f ? apart * apart : 0.0f;
  }
  return apart2 <= radius * radius;
}

/* The leaves begin … end, from disc n on. */
static void set_discs_of_leaves(const neighbourhood *around, uint32_t begin, uint32_t end, size_t n) {
  const conic_octree *octree = around->pass->octree;
  const conic_discs *discs = &around->discs;
  const float cutoff = (float)octree->scale.cutoff;
  for (uint32_t k = begin; k < end; k++)
    around->first_leaf[n + k - begin] = k;
  if (octree->clip_of_point) {
    for (uint32_t k = begin; k < end; k++)
      set_disc_of_leaf(octree, k, discs, n + k - begin);
    return;
  }
  for (int axis = 0; axis < 3; axis++) {
    const float *u = octree->leaves.tangent_u[axis] + begin, *v = octree->leaves.tangent_v[axis] + begin;
    float *disc_u = discs->u[axis] + n, *disc_v = discs->v[axis] + n;
    memcpy(discs->center[axis] + n, octree->leaves.position[axis] + begin, (end - begin) * sizeof(float));
    for (uint32_t k = 0; k < end - begin; k++) {
      disc_u[k] = cutoff * u[k];
      disc_v[k] = cutoff * v[k];
    }
  }
  memset(discs->error + n, 0, (end - begin) * sizeof *discs->error);
}

/* The subtree's own discs. */
static void gather_own(neighbourhood *around, size_t root) {
  const conic_octree *octree = around->pass->octree;
  const size_t part = around->pass->sizes.part;
  size_t n = 0;
  if (part == 1) { /* all of them leaves */
    n = count_leaves(octree, root);
    set_discs_of_leaves(around, octree->first_leaf[root], octree->first_leaf[octree->end[root]], 0);
  }
  for (size_t i = root; i < octree->end[root] && part > 1;) {
    if (count_leaves(octree, i) <= part) {
      around->first_leaf[n] = octree->first_leaf[i];
      set_disc_of_node(octree, i, &around->discs, n++);
      i = octree->end[i];
      continue;
    }
    set_discs_of_leaves(around, octree->first_leaf[i], octree->first_leaf[i + 1], n);
    n += octree->first_leaf[i + 1] - octree->first_leaf[i];
    i++;
  }
  around->n_own = around->discs.count = n;
  conic_discs_set_half(&around->discs, 0);
}

/* Takes the discs of the nodes begin … end that are in the box; while there is room and patience, for everything may be
 * near everything. What is left out makes errors larger than they are, which breaks no promise. */
static void gather_discs(neighbourhood *around, size_t begin, size_t end, const error_box *b, size_t room) {
  const conic_octree *octree = around->pass->octree;
  conic_discs *discs = &around->discs;
  size_t patience = 32 * around->room;
  for (size_t i = begin; i < end && discs->count < room && patience > 0; patience--) {
    if (!is_near(octree, i, b)) {
      i = octree->end[i];
      continue;
    }
    if (count_leaves(octree, i) <= around->pass->sizes.part) {
      set_disc_of_node(octree, i, discs, discs->count);
      discs->count += (size_t)is_in_box(b, discs, discs->count);
      i = octree->end[i];
      continue;
    }
    for (uint32_t k = octree->first_leaf[i]; k < octree->first_leaf[i + 1] && discs->count < room; k++)
      if (is_leaf_in_box(octree, k, b))
        set_disc_of_leaf(octree, k, discs, discs->count++);
    i++;
  }
}

/* The nodes of the class in a subtree. */
static void list_members(neighbourhood *around, size_t root) {
  const conic_octree *octree = around->pass->octree;
  float cutoff = (float)octree->scale.cutoff;
  around->n_members = 0;
  for (size_t i = root; i < octree->end[root];) {
    member *m = &around->members[around->n_members];
    conic_node node;
    if (count_leaves(octree, i) <= around->pass->sizes.above) {
      i = octree->end[i];
      continue;
    }
    if (count_leaves(octree, i) > around->pass->sizes.most) {
      i++;
      continue;
    }
    node_at(octree, i, &node);
    for (int axis = 0; axis < 3; axis++) {
      m->disc.center[axis] = node.position[axis];
      m->disc.u[axis] = cutoff * node.tangent_u[axis];
      m->disc.v[axis] = cutoff * node.tangent_v[axis];
      m->disc.n[axis] = node.normal[axis];
    }
    m->disc.enough = node.error;
    m->radius = node.radius;
    m->i_node = (uint32_t)i++;
    around->n_members++;
  }
}

/* The first of the subtree's discs whose leaves begin at `leaf` or later. */
static size_t find_disc(const neighbourhood *around, uint32_t leaf) {
  size_t begin = 0, guess = leaf - around->first_leaf[0]; /* right where all discs are leaves */
  if (guess < around->n_own && around->first_leaf[guess] == leaf)
    return guess;
  CONIC_BISECT(begin, around->n_own, around->first_leaf[middle] < leaf);
  return begin;
}

/* Finds what the members begin … end look at: what is within the way that the least error that matters lets a point be
 * off the surface. */
static void find_near(neighbourhood *around, size_t begin, size_t end) {
  const conic_octree *octree = around->pass->octree;
  conic_near_discs *near = &around->near;
  uint32_t root = around->members[begin].i_node; /* the others are below it */
  near->begin = find_disc(around, octree->first_leaf[root]);
  near->end = find_disc(around, octree->first_leaf[octree->end[root]]);
  for (int axis = 0; axis < 3; axis++) {
    error_box b = {{0}, {0}};
    b.low[axis] = HUGE_VALF;
    b.high[axis] = -HUGE_VALF;
    for (size_t k = begin; k < end; k++) {
      const conic_node_disc *disc = &around->members[k].disc;
      float extent = sqrtf(disc->u[axis] * disc->u[axis] + disc->v[axis] * disc->v[axis]);
      add_to_box(disc->center[axis], extent + disc->enough * (1.1f / CONIC_COVER_WEIGHT), axis, &b);
    }
    near->center[axis] = 0.5f * b.low[axis] + 0.5f * b.high[axis];
    near->half[axis] = 0.5f * b.high[axis] - 0.5f * b.low[axis];
  }
  around->pass->loops.find_near(&around->discs, near);
}

static void find_error(neighbourhood *around, const member *m) {
  const error_pass *pass = around->pass;
  const conic_octree *octree = pass->octree;
  size_t begin = find_disc(around, octree->first_leaf[m->i_node]);
  size_t end = find_disc(around, octree->first_leaf[octree->end[m->i_node]]);
  float error = pass->loops.cover(&pass->samples, &around->discs, begin, end, &around->near, &m->disc);
  if (error > m->disc.enough) /* a hair more for the floats */
    conic_code_error(&octree->scale, (double)error * (1.0 + 1e-5), (double)m->radius,
                     octree->codes + (size_t)m->i_node * CONIC_NODE_BYTES);
}

/* The errors of a member and of those in its subtree. Returns the member after them. */
static size_t find_member_errors(neighbourhood *around, size_t begin) {
  const conic_octree *octree = around->pass->octree;
  size_t end = begin;
  while (end < around->n_members && around->members[end].i_node < octree->end[around->members[begin].i_node])
    end++;
  find_near(around, begin, end);
  for (size_t k = begin; k < end; k++)
    find_error(around, &around->members[k]);
  return end;
}

/* How many discs a subtree has itself; and nodes of the class, no more than those and the others. */
static size_t count_parts(const conic_octree *octree, size_t root, size_t part) {
  size_t n = 0;
  for (size_t i = root; i < octree->end[root];)
    if (count_leaves(octree, i) <= part) {
      n++;
      i = octree->end[i];
    } else {
      n += octree->first_leaf[i + 1] - octree->first_leaf[i];
      i++;
    }
  return n;
}

static void release_around(const neighbourhood *around) {
  conic_context *context = around->pass->octree->context;
  conic_memory_release_these(context, around->numbers, around->first_leaf, around->members, around->near_numbers,
                             around->near_blocks, around->near.flat, around->near.are_flat);
}

/* Lays out the arrays of discs: `stride` of each number, and a block's. */
static void lay_out_discs(float *next, size_t stride, conic_discs *discs) {
  float **arrays[] = {discs->center, discs->u, discs->v, discs->half};
  for (int k = 0; k < 4; k++)
    for (int axis = 0; axis < 3; axis++, next += stride)
      arrays[k][axis] = next;
  discs->error = next;
  next += stride;
  for (int axis = 0; axis < 3; axis++, next += 2 * stride / CONIC_DISC_BLOCK) {
    discs->block_center[axis] = next;
    discs->block_half[axis] = next + stride / CONIC_DISC_BLOCK;
  }
}

static void lay_out_list(float *next, uint32_t *blocks, size_t room, conic_block_list *list) {
  for (int axis = 0; axis < 3; axis++, next += 2 * room) {
    list->center[axis] = next;
    list->half[axis] = next + room;
  }
  list->block = blocks;
}

/* Makes room for a subtree with so many discs. A node of the class has two parts at least. */
static conic_status make_room_for_discs(neighbourhood *around, size_t n_own) {
  enum { NUMBERS = 14, WHOLE = CONIC_DISC_BLOCK * CONIC_DISC_BLOCK }; /* 13, and a block's 6 make less than one */
  conic_context *context = around->pass->octree->context;
  conic_discs *discs = &around->discs;
  conic_near_discs *near = &around->near;
  size_t room = 8 * n_own + 512;
  if (around->first_leaf && room <= around->room)
    return CONIC_OK;
  release_around(around);
  size_t stride = room + WHOLE - room % WHOLE;
  around->room = room;
  size_t n_blocks = stride / CONIC_DISC_BLOCK;
  if (conic_memory_allocate_these(context, CONIC_ROOM(around->numbers, NUMBERS * stride),
                                  CONIC_ROOM(around->first_leaf, n_own), CONIC_ROOM(around->members, n_own),
                                  CONIC_ROOM(around->near_numbers, 6 * n_blocks),
                                  CONIC_ROOM(around->near_blocks, n_blocks), CONIC_ROOM(near->flat, n_blocks),
                                  CONIC_ROOM(near->are_flat, n_blocks / CONIC_DISC_BLOCK + 1)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  lay_out_discs(around->numbers, stride, discs);
  lay_out_list(around->near_numbers, around->near_blocks, n_blocks, &near->blocks);
  return CONIC_OK;
}

static conic_status run_group(neighbourhood *around, size_t root) {
  const conic_octree *octree = around->pass->octree;
  conic_status status = make_room_for_discs(around, count_parts(octree, root, around->pass->sizes.part));
  if (status != CONIC_OK)
    return status;
  gather_own(around, root);
  list_members(around, root);
  error_box b = box_of_group(around);
  gather_discs(around, 0, root, &b, around->n_own + (around->room - around->n_own) / 2);
  gather_discs(around, octree->end[root], octree->n_nodes, &b, around->room);
  conic_discs_set_half(&around->discs, around->n_own);
  conic_discs_close(&around->discs);
  for (size_t k = 0; k < around->n_members;)
    k = find_member_errors(around, k);
  return CONIC_OK;
}

static conic_status run_subtree(const error_pass *pass, size_t root) {
  const conic_octree *octree = pass->octree;
  neighbourhood around = {.pass = pass};
  conic_status status = CONIC_OK;
  for (size_t i = root; i < octree->end[root] && status == CONIC_OK;) {
    size_t n_leaves = count_leaves(octree, i);
    if (n_leaves <= pass->sizes.group && n_leaves > pass->sizes.above)
      status = run_group(&around, i);
    i = n_leaves <= pass->sizes.group ? octree->end[i] : i + 1;
  }
  release_around(&around);
  return status;
}

static void run_task(void *data, size_t i_task) {
  error_pass *pass = data;
  pass->statuses[i_task] = run_subtree(pass, pass->tasks[i_task]);
}

/* Counts the roots of the tasks, or lists them: whatever is of the class is below one. */
static size_t list_tasks(const error_pass *pass, uint32_t *tasks) {
  const conic_octree *octree = pass->octree;
  size_t most = pass->sizes.group > task_leaves ? pass->sizes.group : task_leaves, n = 0;
  for (size_t i = 0; i < octree->n_nodes;) {
    size_t n_leaves = count_leaves(octree, i);
    if (n_leaves <= most && n_leaves > pass->sizes.above) {
      if (tasks)
        tasks[n] = (uint32_t)i;
      n++;
    }
    i = n_leaves <= most ? octree->end[i] : i + 1;
  }
  return n;
}

/* The first node that is a task's. */
static size_t first_node_of_task(const void *data, size_t i_task) {
  const error_pass *pass = data;
  return i_task < pass->n_tasks ? pass->tasks[i_task] : pass->octree->n_nodes;
}

static conic_status run_pass(error_pass *pass) {
  conic_context *context = pass->octree->context;
  conic_status status = CONIC_OK;
  pass->n_tasks = list_tasks(pass, NULL);
  pass->tasks = conic_memory_allocate(context, pass->n_tasks, sizeof *pass->tasks);
  pass->statuses = conic_memory_allocate_zeroed(context, pass->n_tasks, sizeof *pass->statuses); /* CONIC_OK */
  if (!pass->tasks || !pass->statuses)
    status = CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    list_tasks(pass, pass->tasks);
    conic_team_loop loop = {.name = "octree", .from = pass->from, .to = pass->to, .n_items = pass->n_tasks};
    loop.task = CONIC_TASK(run_task);
    loop.data = pass;
    loop.first_of = first_node_of_task;
    loop.columns[0] = (conic_team_column){pass->octree->codes, CONIC_NODE_BYTES};
    status = conic_team_runs(context, &loop);
  }
  for (size_t i = 0; i < pass->n_tasks && status == CONIC_OK; i++)
    status = pass->statuses[i];
  conic_memory_release_these(context, pass->tasks, pass->statuses);
  return status;
}

conic_status conic_octree_find_errors(conic_octree *octree) {
  error_pass pass = {.octree = octree, .sizes = {1, 64, 1, 8192}, .from = 0.6, .to = 0.9};
  conic_isa isa;
  conic_status status = conic_isa_choose(octree->context, CONIC_ISA_AUTO, &isa);
  conic_octree_loops_init(&pass.loops, isa);
  conic_disc_samples_init(&pass.samples);
  while (status == CONIC_OK && pass.sizes.above < octree->n_leaves) {
    status = run_pass(&pass);
    pass.from = pass.to;
    pass.to = 0.5 + 0.5 * pass.to;
    size_t most = 8 * pass.sizes.most;
    pass.sizes = (size_class){pass.sizes.most, most, pass.sizes.most / 8, 8 * most};
  }
  return status;
}
