#include "lod/layers/build/layers_tree.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/files/mapping.h"
#include "lod/layers/build/layers_normals.h"
#include "lod/layers/build/layers_waiting.h"

/* Clouds are written so many bytes at a time. */
enum { SHELF_BYTES = 1 << 17 };

struct conic_layers_worker {
  conic_layers_plan plan;
  conic_layers_waiting *waiting;
  conic_thinner *thinner;
  conic_layers_coder *coder;
  unsigned char *candidates; /* of the two children, then what is left of one */
  uint8_t *is_chosen;
  uint64_t *outlines;
};

/* Two leaves' samples are chosen from at most. */
static size_t most_candidates(const conic_layers_plan *plan) {
  return 2 * conic_layers_most_in_leaf(plan);
}

conic_status conic_layers_worker_create(const conic_layers_plan *plan, conic_layers_waiting *waiting,
                                        conic_layers_worker **worker) {
  conic_context *context = plan->context;
  size_t n = most_candidates(plan);
  *worker = NULL;
  conic_layers_worker *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->plan = *plan;
  made->waiting = waiting;
  conic_status status =
      conic_layers_coder_create(context, conic_layers_most_in_leaf(plan), plan->schema, NULL, &made->coder);
  if (status == CONIC_OK)
    status = conic_thinner_create(context, n, &made->thinner);
  if (status == CONIC_OK) {
    made->candidates = conic_memory_allocate(context, n, plan->sample_bytes);
    made->is_chosen = conic_memory_allocate(context, n, 1);
    made->outlines = conic_memory_allocate_zeroed(context, CONIC_LAYERS_OUTLINES, sizeof *made->outlines);
    status = made->candidates && made->is_chosen && made->outlines ? CONIC_OK : CONIC_ERROR_MEMORY;
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
  conic_memory_release(context, worker->outlines);
  conic_memory_release(context, worker);
}

conic_layers_waiting *conic_layers_worker_waiting(const conic_layers_worker *worker) {
  return worker->waiting;
}

const uint64_t *conic_layers_worker_outlines(const conic_layers_worker *worker) {
  return worker->outlines;
}

void conic_layers_worker_add_outlines(conic_layers_worker *worker, const uint64_t *outlines) {
  for (size_t i = 0; i < CONIC_LAYERS_OUTLINES; i++)
    worker->outlines[i] += outlines[i];
}

size_t conic_layers_worker_bytes(const conic_layers_plan *plan) {
  size_t zstd_bytes = 1 << 20,
         cloud_bytes = 2 * (size_t)(plan->schema->n_streams + 8) * conic_layers_most_in_leaf(plan);
  return zstd_bytes + cloud_bytes + CONIC_LAYERS_OUTLINES * sizeof(uint64_t) + SHELF_BYTES +
         conic_thinner_bytes(most_candidates(plan)) + most_candidates(plan) * plan->sample_bytes;
}

conic_status conic_layers_shelf_flush(conic_layers_shelf *shelf) {
  uint64_t at = 0;
  conic_status status = shelf->n_bytes ? conic_pile_append(shelf->clouds, shelf->bytes, shelf->n_bytes, &at) : CONIC_OK;
  for (; shelf->n_put < shelf->n_nodes; shelf->n_put++)
    shelf->nodes[shelf->n_put].offset += at;
  shelf->n_bytes = 0;
  return status;
}

void conic_layers_shelf_release(conic_layers_shelf *shelf) {
  conic_memory_release(shelf->context, shelf->nodes);
  conic_memory_release(shelf->context, shelf->bytes);
  *shelf = (conic_layers_shelf){.context = shelf->context, .clouds = shelf->clouds};
}

void conic_layers_branch_destroy(conic_layers_branch *branch) {
  if (!branch)
    return;
  for (int i = 0; i < 2; i++)
    conic_layers_branch_destroy(branch->children[i]);
  conic_layers_drop_samples(branch);
  conic_layers_drop_keys(branch);
  conic_memory_release(branch->waiting->context, branch);
}

/* A branch with room for n samples that are drawn. */
static conic_layers_branch *create_branch(const conic_layers_worker *worker, size_t n) {
  conic_layers_branch *made = conic_memory_allocate_zeroed(worker->plan.context, 1, sizeof *made);
  if (!made)
    return NULL;
  made->n_drawn = n;
  made->stride = worker->plan.sample_bytes;
  if (conic_layers_hold(worker->waiting, made) == CONIC_OK)
    return made;
  conic_layers_branch_destroy(made);
  return NULL;
}

/* What is kept of a branch's samples when they are gone. */
static void keep_discs(conic_layers_branch *branch) {
  for (size_t i = 0; i < branch->n_drawn; i++) {
    const conic_layers_sample *sample = conic_layers_drawn_at(branch, i);
    branch->keys[i] = sample->key;
    branch->facets[i] = (conic_layers_facet){{sample->normal[0], sample->normal[1]}, sample->size};
  }
}

static conic_status grow_leaf(conic_layers_worker *worker, const unsigned char *samples, size_t n,
                              conic_layers_branch **branch) {
  conic_layers_branch *leaf = create_branch(worker, n);
  if (!leaf)
    return CONIC_ERROR_MEMORY;
  memcpy(leaf->samples, samples, n * leaf->stride);
  keep_discs(leaf);
  leaf->first_key = leaf->keys[0];
  leaf->last_key = leaf->keys[n - 1];
  leaf->n_place = n;
  leaf->is_leaf = 1;
  conic_status status = conic_layers_bound_leaf(&worker->plan, leaf);
  keep_discs(leaf); /* now with all sizes */
  for (size_t i = 0; i < n; i++)
    worker->outlines[conic_layers_drawn_at(leaf, i)->size & (CONIC_LAYERS_OUTLINES - 1)]++;
  if (status == CONIC_OK)
    *branch = leaf;
  else
    conic_layers_branch_destroy(leaf);
  return status;
}

/* The first sample past the middle of the place that all share; where all coincide, past half of them. */
static size_t split_point(const unsigned char *samples, size_t stride, size_t n) {
  uint64_t differing =
      conic_layers_sample_at(samples, stride, 0)->key ^ conic_layers_sample_at(samples, stride, n - 1)->key;
  if (!differing)
    return n / 2;
  uint64_t bit = UINT64_C(1) << (63 - __builtin_clzll(differing));
  size_t low = 0, high = n - 1; /* the bit is not set in the first, and is in the last */
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (conic_layers_sample_at(samples, stride, middle)->key & bit)
      high = middle;
    else
      low = middle;
  }
  return high;
}

static conic_status grow(conic_layers_worker *worker, unsigned char *samples, size_t n, int is_bare,
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
  size_t n_first = split_point(samples, worker->plan.sample_bytes, n);
  if (status == CONIC_OK)
    status = grow(worker, samples, n_first, is_bare, shelf, &children[0]);
  if (status == CONIC_OK)
    status = grow(worker, samples + n_first * worker->plan.sample_bytes, n - n_first, is_bare, shelf, &children[1]);
  if (status == CONIC_OK)
    return conic_layers_join(worker, children, 0, shelf, branch);
  conic_layers_branch_destroy(children[0]);
  return status;
}

conic_status conic_layers_grow(conic_layers_worker *worker, unsigned char *samples, size_t n, conic_layers_shelf *shelf,
                               conic_layers_branch **branch) {
  return grow(worker, samples, n, worker->plan.has_bare, shelf, branch);
}

/* Packs samples as the branch's cloud and puts its node on the shelf. */
static conic_status shelve(conic_layers_worker *worker, const conic_layers_branch *branch, const unsigned char *samples,
                           size_t n, conic_layers_shelf *shelf) {
  conic_context *context = worker->plan.context;
  const unsigned char *bytes;
  conic_layers_entry node;
  conic_layers_describe_branch(&worker->plan, branch, &node);
  node.child = !branch->is_leaf;
  size_t n_bytes = conic_layers_encode(worker->coder, samples, n, node.key, &bytes, shelf->part_bytes);
  node.n_samples = (uint32_t)n;
  node.n_bytes = (uint32_t)n_bytes;
  node.sum = conic_checksum(bytes, n_bytes);
  conic_status status = shelf->n_bytes + n_bytes > SHELF_BYTES ? conic_layers_shelf_flush(shelf) : CONIC_OK;
  node.offset = shelf->n_bytes;
  if (status == CONIC_OK)
    status = conic_memory_reserve(context, &shelf->nodes, shelf->n_nodes, shelf->n_nodes + 1, &shelf->node_room,
                                  sizeof node);
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

/* What the parent has not taken of a child's samples is its cloud; they are among the candidates. */
static conic_status shelve_rest(conic_layers_worker *worker, const conic_layers_branch *child, unsigned char *samples,
                                const uint8_t *is_taken, conic_layers_shelf *shelf) {
  size_t n = 0, stride = child->stride;
  for (size_t i = 0; i < child->n_drawn; i++)
    if (!is_taken[i])
      memmove(samples + n++ * stride, samples + i * stride, stride);
  return shelve(worker, child, samples, n, shelf);
}

/* Drops what no node of so large a place, nor a larger one, looks at any more. */
static void forget(conic_layers_branch *branch, uint64_t n_place) {
  int is_far = conic_layers_is_far_below(n_place, branch->n_place);
  for (int i = 0; i < 2 && branch->children[i]; i++)
    if (is_far) {
      conic_layers_branch_destroy(branch->children[i]);
      branch->children[i] = NULL;
    } else
      forget(branch->children[i], n_place);
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

/* Brings both children's samples into the worker's candidates. */
static conic_status gather_candidates(conic_layers_worker *worker, conic_layers_branch *const children[2]) {
  unsigned char *to = worker->candidates;
  conic_status status = CONIC_OK;
  for (int i = 0; i < 2 && status == CONIC_OK; i++) {
    status = conic_layers_fetch_samples(children[i], to);
    conic_layers_drop_samples(children[i]);
    to += children[i]->n_drawn * children[i]->stride;
  }
  return status;
}

/* Chooses of the candidates and copies what is chosen. */
static conic_status choose_samples(conic_layers_worker *worker, conic_layers_branch *const children[2],
                                   conic_layers_branch **parent) {
  const conic_layers_plan *plan = &worker->plan;
  size_t n = children[0]->n_drawn + children[1]->n_drawn, stride = plan->sample_bytes;
  uint64_t n_place = children[0]->n_place + children[1]->n_place;
  /* What is chosen has to do for a place; of the root's nothing goes to a parent. */
  size_t target = (n_place == plan->n_samples ? 1 : 2) * (size_t)plan->cloud_size;
  double distance = guess_distance((const conic_layers_branch *const *)children, target);
  conic_thinner_load(worker->thinner, &conic_layers_sample_at(worker->candidates, stride, 0)->key, stride, n);
  size_t n_chosen = conic_thinner_choose(worker->thinner, target, target + target / 4, &distance, worker->is_chosen);
  *parent = create_branch(worker, n_chosen);
  if (!*parent)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0, k = 0; i < n; i++)
    if (worker->is_chosen[i])
      memcpy((*parent)->samples + k++ * stride, worker->candidates + i * stride, stride);
  keep_discs(*parent);
  (*parent)->distance = distance;
  (*parent)->first_key = children[0]->first_key;
  (*parent)->last_key = children[1]->last_key;
  (*parent)->n_place = n_place;
  return CONIC_OK;
}

conic_status conic_layers_join(conic_layers_worker *worker, conic_layers_branch *const children[2], int is_alone,
                               conic_layers_shelf *shelf, conic_layers_branch **parent) {
  unsigned char *second = worker->candidates + children[0]->n_drawn * worker->plan.sample_bytes;
  const uint8_t *is_chosen = worker->is_chosen;
  *parent = NULL;
  conic_status status = gather_candidates(worker, children);
  if (status == CONIC_OK)
    status = choose_samples(worker, children, parent);
  if (status != CONIC_OK) {
    conic_layers_branch_destroy(children[0]);
    conic_layers_branch_destroy(children[1]);
    return status;
  }
  (*parent)->children[0] = children[0];
  (*parent)->children[1] = children[1];
  status = conic_layers_bound_node(&worker->plan, worker->thinner, is_alone, *parent);
  if (status == CONIC_OK)
    status = shelve_rest(worker, children[0], worker->candidates, is_chosen, shelf);
  if (status == CONIC_OK)
    status = shelve_rest(worker, children[1], second, is_chosen + children[0]->n_drawn, shelf);
  forget(*parent, (*parent)->n_place);
  if (status == CONIC_OK)
    return CONIC_OK;
  conic_layers_branch_destroy(*parent);
  *parent = NULL;
  return status;
}

conic_status conic_layers_finish_root(conic_layers_worker *worker, const conic_layers_branch *branch,
                                      conic_layers_shelf *shelf) {
  conic_status status = conic_layers_fetch_samples(branch, worker->candidates);
  return status == CONIC_OK ? shelve(worker, branch, worker->candidates, branch->n_drawn, shelf) : status;
}
