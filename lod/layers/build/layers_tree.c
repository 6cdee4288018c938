#include "lod/layers/build/layers_tree.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/files/mapping.h"
#include "lod/layers/build/layers_branch.h"
#include "lod/layers/build/layers_normals.h"

struct conic_layers_worker {
  conic_layers_plan plan;
  conic_thinner *thinner;
  conic_layers_coder *coder;
  conic_layers_sample *candidates; /* of the two children, then what is left of one */
  uint8_t *is_chosen;
};

/* Two leaves' samples are chosen from at most. */
static size_t most_candidates(const conic_layers_plan *plan) {
  return 2 * conic_layers_most_in_leaf(plan);
}

conic_status conic_layers_worker_create(const conic_layers_plan *plan, conic_layers_worker **worker) {
  conic_context *context = plan->context;
  size_t n = most_candidates(plan);
  *worker = NULL;
  conic_layers_worker *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->plan = *plan;
  conic_status status =
      conic_layers_coder_create(context, conic_layers_most_in_leaf(plan), plan->has_colors, &made->coder);
  if (status == CONIC_OK)
    status = conic_thinner_create(context, n, &made->thinner);
  if (status == CONIC_OK) {
    made->candidates = conic_memory_allocate(context, n, sizeof *made->candidates);
    made->is_chosen = conic_memory_allocate(context, n, 1);
    status = made->candidates && made->is_chosen ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK)
    *worker = made;
  else
    conic_layers_worker_destroy(made);
  return status;
}

void conic_layers_worker_destroy(conic_layers_worker *worker) {
  if (!worker)
    return;
  conic_context *context = worker->plan.context;
  conic_layers_coder_destroy(worker->coder);
  conic_thinner_destroy(context, worker->thinner);
  conic_memory_release(context, worker->candidates);
  conic_memory_release(context, worker->is_chosen);
  conic_memory_release(context, worker);
}

void conic_layers_shelf_release(conic_layers_shelf *shelf) {
  conic_memory_release(shelf->context, shelf->nodes);
  conic_memory_release(shelf->context, shelf->bytes);
  *shelf = (conic_layers_shelf){.context = shelf->context};
}

void conic_layers_branch_destroy(conic_context *context, conic_layers_branch *branch) {
  if (!branch)
    return;
  for (int i = 0; i < 2; i++)
    conic_layers_branch_destroy(context, branch->children[i]);
  conic_memory_release(context, branch->samples);
  conic_memory_release(context, branch->keys);
  conic_memory_release(context, branch);
}

/* A branch with room for n samples that are drawn. */
static conic_layers_branch *create_branch(conic_context *context, size_t n) {
  conic_layers_branch *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return NULL;
  made->nodes[0] = made->nodes[1] = CONIC_LAYERS_NO_NODE;
  made->n_drawn = n;
  made->samples = conic_memory_allocate(context, n, sizeof *made->samples);
  made->keys = conic_memory_allocate(context, n, sizeof *made->keys);
  if (made->samples && made->keys)
    return made;
  conic_layers_branch_destroy(context, made);
  return NULL;
}

static conic_status grow_leaf(conic_layers_worker *worker, const conic_layers_sample *samples, size_t n,
                              conic_layers_branch **branch) {
  conic_layers_branch *leaf = create_branch(worker->plan.context, n);
  if (!leaf)
    return CONIC_ERROR_MEMORY;
  memcpy(leaf->samples, samples, n * sizeof *samples);
  for (size_t i = 0; i < n; i++)
    leaf->keys[i] = samples[i].key;
  leaf->first_key = samples[0].key;
  leaf->last_key = samples[n - 1].key;
  leaf->n_place = n;
  leaf->is_leaf = 1;
  conic_status status = conic_layers_bound_leaf(&worker->plan, leaf);
  if (status == CONIC_OK)
    *branch = leaf;
  else
    conic_layers_branch_destroy(worker->plan.context, leaf);
  return status;
}

/* The first sample past the middle of the place that all share; where all coincide, past half of them. */
static size_t split_point(const conic_layers_sample *samples, size_t n) {
  uint64_t differing = samples[0].key ^ samples[n - 1].key;
  if (!differing)
    return n / 2;
  uint64_t bit = UINT64_C(1) << (63 - __builtin_clzll(differing));
  size_t low = 0, high = n - 1; /* the bit is not set in the first, and is in the last */
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (samples[middle].key & bit)
      high = middle;
    else
      low = middle;
  }
  return high;
}

static conic_status grow(conic_layers_worker *worker, conic_layers_sample *samples, size_t n, int is_bare,
                         conic_layers_shelf *shelf, conic_layers_branch **branch) {
  conic_layers_branch *children[2] = {NULL, NULL};
  conic_status status = CONIC_OK;
  size_t most = conic_layers_most_in_leaf(&worker->plan);
  *branch = NULL;
  if (is_bare && n <= CONIC_LAYERS_PATCH_LEAVES * most) {
    status = conic_layers_find_normals(&worker->plan, samples, n);
    is_bare = 0;
  }
  if (status == CONIC_OK && n <= most)
    return grow_leaf(worker, samples, n, branch);
  size_t n_first = split_point(samples, n);
  if (status == CONIC_OK)
    status = grow(worker, samples, n_first, is_bare, shelf, &children[0]);
  if (status == CONIC_OK)
    status = grow(worker, samples + n_first, n - n_first, is_bare, shelf, &children[1]);
  if (status == CONIC_OK)
    return conic_layers_join(worker, children, shelf, branch);
  conic_layers_branch_destroy(worker->plan.context, children[0]);
  return status;
}

conic_status conic_layers_grow(conic_layers_worker *worker, conic_layers_sample *samples, size_t n,
                               conic_layers_shelf *shelf, conic_layers_branch **branch) {
  return grow(worker, samples, n, worker->plan.is_unoriented, shelf, branch);
}

/* Packs samples as the branch's cloud and puts its node on the shelf. */
static conic_status shelve(conic_layers_worker *worker, const conic_layers_branch *branch,
                           const conic_layers_sample *samples, size_t n, conic_layers_shelf *shelf) {
  conic_context *context = worker->plan.context;
  const unsigned char *bytes;
  conic_layers_node node = {.children = {branch->nodes[0], branch->nodes[1]}};
  conic_layers_describe_branch(&worker->plan, branch, &node.entry);
  size_t n_bytes = conic_layers_encode(worker->coder, samples, n, node.entry.key, &bytes, shelf->part_bytes);
  node.entry.n_samples = (uint32_t)n;
  node.entry.n_bytes = (uint32_t)n_bytes;
  node.entry.offset = shelf->n_bytes;
  node.entry.sum = conic_checksum(bytes, n_bytes);
  conic_status status =
      conic_memory_reserve(context, &shelf->nodes, shelf->n_nodes, shelf->n_nodes + 1, &shelf->node_room, sizeof node);
  if (status == CONIC_OK)
    status =
        conic_memory_reserve(context, &shelf->bytes, shelf->n_bytes, shelf->n_bytes + n_bytes, &shelf->byte_room, 1);
  if (status != CONIC_OK)
    return status;
  memcpy(shelf->bytes + shelf->n_bytes, bytes, n_bytes);
  shelf->n_bytes += n_bytes;
  shelf->nodes[shelf->n_nodes++] = node;
  return CONIC_OK;
}

/* What the parent has not taken of a child's samples is its cloud. */
static conic_status shelve_rest(conic_layers_worker *worker, conic_layers_branch *child, const uint8_t *is_taken,
                                conic_layers_shelf *shelf, uint32_t *node) {
  size_t n = 0;
  for (size_t i = 0; i < child->n_drawn; i++)
    if (!is_taken[i])
      worker->candidates[n++] = child->samples[i];
  conic_memory_release(worker->plan.context, child->samples);
  child->samples = NULL;
  *node = (uint32_t)shelf->n_nodes;
  return shelve(worker, child, worker->candidates, n, shelf);
}

/* Drops what no node of so large a place, nor a larger one, looks at any more. */
static void forget(conic_context *context, conic_layers_branch *branch, uint64_t n_place) {
  int is_far = conic_layers_is_far_below(n_place, branch->n_place);
  for (int i = 0; i < 2 && branch->children[i]; i++)
    if (is_far) {
      conic_layers_branch_destroy(context, branch->children[i]);
      branch->children[i] = NULL;
    } else
      forget(context, branch->children[i], n_place);
}

/* The distance for the thinning, from the area and from how the children's came out. */
static double guess_distance(const conic_layers_branch *const children[2], size_t target) {
  double area = children[0]->area + children[1]->area, packing = 0.0, weight = 0.0;
  for (int i = 0; i < 2; i++) {
    double own = children[i]->distance * children[i]->distance * (double)children[i]->n_drawn;
    packing += own;
    weight += children[i]->distance > 0.0 ? children[i]->area : 0.0;
  }
  double share = weight > 0.0 ? packing / weight : 0.43; /* measured; of darts on all of a plane it is 0.70 */
  return sqrt(share * area / (double)target);
}

/* Chooses of both children's samples, in the worker's candidates, and copies what is chosen. */
static conic_status choose_samples(conic_layers_worker *worker, conic_layers_branch *const children[2],
                                   conic_layers_branch **parent) {
  const conic_layers_plan *plan = &worker->plan;
  size_t n_first = children[0]->n_drawn, n = n_first + children[1]->n_drawn;
  uint64_t n_place = children[0]->n_place + children[1]->n_place;
  /* What is chosen has to do for a place; of the root's nothing goes to a parent. */
  size_t target = (n_place == plan->n_samples ? 1 : 2) * (size_t)plan->cloud_size;
  memcpy(worker->candidates, children[0]->samples, n_first * sizeof *worker->candidates);
  memcpy(worker->candidates + n_first, children[1]->samples, (n - n_first) * sizeof *worker->candidates);
  double distance = guess_distance((const conic_layers_branch *const *)children, target);
  conic_thinner_load(worker->thinner, &worker->candidates->key, sizeof *worker->candidates, n);
  size_t n_chosen = conic_thinner_choose(worker->thinner, target, target + target / 4, &distance, worker->is_chosen);
  *parent = create_branch(plan->context, n_chosen);
  if (!*parent)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0, k = 0; i < n; i++)
    if (worker->is_chosen[i]) {
      (*parent)->samples[k] = worker->candidates[i];
      (*parent)->keys[k++] = worker->candidates[i].key;
    }
  (*parent)->distance = distance;
  (*parent)->first_key = children[0]->first_key;
  (*parent)->last_key = children[1]->last_key;
  (*parent)->n_place = n_place;
  return CONIC_OK;
}

conic_status conic_layers_join(conic_layers_worker *worker, conic_layers_branch *const children[2],
                               conic_layers_shelf *shelf, conic_layers_branch **parent) {
  conic_context *context = worker->plan.context;
  size_t n_first = children[0]->n_drawn;
  conic_status status = choose_samples(worker, children, parent);
  if (status != CONIC_OK) {
    conic_layers_branch_destroy(context, children[0]);
    conic_layers_branch_destroy(context, children[1]);
    return status;
  }
  (*parent)->children[0] = children[0];
  (*parent)->children[1] = children[1];
  conic_layers_bound_node(worker->thinner, *parent);
  status = shelve_rest(worker, children[0], worker->is_chosen, shelf, &(*parent)->nodes[0]);
  if (status == CONIC_OK)
    status = shelve_rest(worker, children[1], worker->is_chosen + n_first, shelf, &(*parent)->nodes[1]);
  forget(context, *parent, (*parent)->n_place);
  if (status == CONIC_OK)
    return CONIC_OK;
  conic_layers_branch_destroy(context, *parent);
  *parent = NULL;
  return status;
}

conic_status conic_layers_finish_root(conic_layers_worker *worker, conic_layers_branch *branch,
                                      conic_layers_shelf *shelf) {
  return shelve(worker, branch, branch->samples, branch->n_drawn, shelf);
}
