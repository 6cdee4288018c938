#include "lod/layers/build/layers_stand_ins.h"

/* Clouds are written so many bytes at a time. */
enum { PACKED_BYTES = 1 << 17 };

/* Two leaves' samples are chosen from at most. */
static size_t most_candidates(const conic_layers_plan *plan) {
  return 2 * conic_layers_most_in_leaf(plan);
}

conic_status conic_layers_worker_create(const conic_layers_plan *plan, conic_layers_pool *pool,
                                        conic_layers_worker **worker) {
  conic_context *context = plan->context;
  size_t n = most_candidates(plan);
  *worker = NULL;
  conic_layers_worker *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->plan = *plan;
  made->pool = pool;
  conic_status status =
      conic_layers_coder_create(context, conic_layers_most_in_leaf(plan), plan->schema, NULL, &made->coder);
  if (status == CONIC_OK)
    status = conic_thinner_create(context, n, &made->thinner);
  if (status == CONIC_OK)
    status = conic_layers_standing_create(plan, &made->standing);
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
  conic_layers_standing_destroy(context, worker->standing);
  conic_memory_release_these(context, worker->candidates, worker->is_chosen, worker->outlines, worker);
}

void conic_layers_add_outlines(conic_layers_worker *worker, const uint64_t *outlines) {
  for (size_t i = 0; i < CONIC_LAYERS_OUTLINES; i++)
    worker->outlines[i] += outlines[i];
}

size_t conic_layers_worker_bytes(const conic_layers_plan *plan) {
  size_t zstd_bytes = 1 << 20,
         cloud_bytes = 2 * (size_t)(plan->schema->n_streams + 8) * conic_layers_most_in_leaf(plan);
  return zstd_bytes + cloud_bytes + CONIC_LAYERS_OUTLINES * sizeof(uint64_t) + PACKED_BYTES +
         conic_thinner_bytes(most_candidates(plan)) + conic_layers_standing_bytes(plan) +
         most_candidates(plan) * plan->sample_bytes;
}

conic_status conic_layers_packed_flush(conic_layers_packed *packed) {
  uint64_t at = 0;
  conic_status status =
      packed->n_bytes ? conic_pile_append(packed->clouds, packed->bytes, packed->n_bytes, &at) : CONIC_OK;
  for (; packed->n_put < packed->n_entries; packed->n_put++)
    packed->entries[packed->n_put].offset += at;
  packed->n_bytes = 0;
  return status;
}

void conic_layers_packed_release(conic_layers_packed *packed) {
  conic_memory_release_these(packed->context, packed->entries, packed->bytes);
  *packed = (conic_layers_packed){.context = packed->context, .clouds = packed->clouds};
}

void conic_layers_node_destroy(conic_layers_node *node) {
  if (!node)
    return;
  for (int i = 0; i < 2; i++)
    conic_layers_node_destroy(node->children[i]);
  conic_layers_drop_samples(node);
  conic_layers_drop_keys(node);
  conic_memory_release(node->pool->context, node);
}

/* A node with room for n samples that are drawn. */
static conic_layers_node *create_node(const conic_layers_worker *worker, size_t n) {
  conic_layers_node *made = conic_memory_allocate_zeroed(worker->plan.context, 1, sizeof *made);
  if (!made)
    return NULL;
  made->n_drawn = n;
  made->stride = worker->plan.sample_bytes;
  if (conic_layers_hold(worker->pool, made) == CONIC_OK)
    return made;
  conic_layers_node_destroy(made);
  return NULL;
}

/* Takes from a node's samples what is kept when they are gone. */
static void keep_discs(conic_layers_node *node) {
  for (size_t i = 0; i < node->n_drawn; i++) {
    const conic_layers_sample *sample = conic_layers_drawn_at(node, i);
    node->keys[i] = sample->key;
    node->facets[i] = (conic_layers_facet){{sample->normal[0], sample->normal[1]}, sample->size};
  }
}

static conic_status grow_leaf(conic_layers_worker *worker, const unsigned char *samples, size_t n,
                              conic_layers_node **node) {
  conic_layers_node *leaf = create_node(worker, n);
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
    *node = leaf;
  else
    conic_layers_node_destroy(leaf);
  return status;
}

static const uint64_t *first_key_in(const unsigned char *samples) {
  return &conic_layers_sample_at(samples, 0, 0)->key;
}

static conic_status grow(conic_layers_worker *worker, unsigned char *samples, size_t n, int is_bare,
                         conic_layers_packed *packed, conic_layers_node **node) {
  conic_layers_node *children[2] = {NULL, NULL};
  conic_status status = CONIC_OK;
  size_t most = conic_layers_most_in_leaf(&worker->plan);
  *node = NULL;
  if (is_bare && n <= CONIC_LAYERS_PATCH_LEAVES * most) {
    status = conic_layers_find_normals(&worker->plan, samples, n);
    is_bare = 0;
  }
  if (status == CONIC_OK && n <= most)
    return grow_leaf(worker, samples, n, node);
  size_t n_first = conic_layers_middle(first_key_in(samples), worker->plan.sample_bytes, 0, n);
  if (status == CONIC_OK)
    status = grow(worker, samples, n_first, is_bare, packed, &children[0]);
  if (status == CONIC_OK)
    status = grow(worker, samples + n_first * worker->plan.sample_bytes, n - n_first, is_bare, packed, &children[1]);
  if (status == CONIC_OK)
    return conic_layers_merge(worker, children, 0, packed, node);
  conic_layers_node_destroy(children[0]);
  return status;
}

conic_status conic_layers_grow(conic_layers_worker *worker, unsigned char *samples, size_t n,
                               conic_layers_packed *packed, conic_layers_node **node) {
  return grow(worker, samples, n, worker->plan.has_bare, packed, node);
}

/* Puts bytes behind those that are to be put away. */
static conic_status append_bytes(const unsigned char *bytes, size_t n_bytes, conic_layers_packed *packed) {
  conic_status status = conic_memory_reserve(packed->context, &packed->bytes, packed->n_bytes,
                                             packed->n_bytes + n_bytes, &packed->byte_room, 1);
  if (status != CONIC_OK)
    return status;
  memcpy(packed->bytes + packed->n_bytes, bytes, n_bytes);
  packed->n_bytes += n_bytes;
  return CONIC_OK;
}

/* Packs samples as the node's cloud, and its stand-ins behind it, and puts its entry on the packed. */
static conic_status pack_cloud(conic_layers_worker *worker, const conic_layers_node *node, int which,
                               const unsigned char *samples, size_t n, conic_layers_packed *packed) {
  const unsigned char *bytes;
  conic_layers_entry entry;
  conic_layers_describe_node(&worker->plan, node, &entry);
  entry.child = !node->is_leaf;
  size_t n_bytes = conic_layers_encode(worker->coder, samples, n, entry.key, &bytes, packed->attribute_bytes);
  entry.n_samples = (uint32_t)n;
  entry.n_bytes = (uint32_t)n_bytes;
  entry.sum = conic_checksum(bytes, n_bytes);
  conic_status status = packed->n_bytes + n_bytes > PACKED_BYTES ? conic_layers_packed_flush(packed) : CONIC_OK;
  entry.offset = packed->n_bytes;
  if (status == CONIC_OK)
    status = append_bytes(bytes, n_bytes, packed);
  if (status == CONIC_OK && node->n_stand_ins > 0) {
    conic_layers_stand_ins_encode(worker->standing, which, node, &entry, &bytes);
    status = append_bytes(bytes, entry.stand_in_bytes, packed);
  }
  return status == CONIC_OK ? conic_memory_append(packed->context, &packed->entries, &packed->n_entries,
                                                  &packed->entry_room, &entry, sizeof entry)
                            : status;
}

/* Packs what the parent has not taken of a child's samples, which are among the candidates, as the child's cloud. */
static conic_status pack_rest(conic_layers_worker *worker, const conic_layers_node *child, int which,
                              unsigned char *samples, const uint8_t *is_taken, conic_layers_packed *packed) {
  size_t n = 0, stride = child->stride;
  for (size_t i = 0; i < child->n_drawn; i++)
    if (!is_taken[i])
      memmove(samples + n++ * stride, samples + i * stride, stride);
  return pack_cloud(worker, child, which, samples, n, packed);
}

/* Drops what no entry of so large a place, nor a larger one, looks at any more. */
static void forget(conic_layers_node *node, uint64_t n_place) {
  int is_far = conic_layers_is_far_below(n_place, node->n_place);
  for (int i = 0; i < 2 && node->children[i]; i++)
    if (is_far) {
      conic_layers_node_destroy(node->children[i]);
      node->children[i] = NULL;
    } else
      forget(node->children[i], n_place);
}

/* Guesses the distance for the thinning, from the area and from how the children's came out. */
static double guess_distance(const conic_layers_node *const children[2], size_t target) {
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
static conic_status gather_candidates(conic_layers_worker *worker, conic_layers_node *const children[2]) {
  unsigned char *to = worker->candidates;
  conic_status status = CONIC_OK;
  for (int i = 0; i < 2 && status == CONIC_OK; i++) {
    status = conic_layers_fetch_samples(children[i], to);
    conic_layers_drop_samples(children[i]);
    to += children[i]->n_drawn * children[i]->stride;
  }
  return status;
}

/* Makes the parent, with the candidates that are chosen for it. */
static conic_status choose_samples(conic_layers_worker *worker, conic_layers_node *const children[2],
                                   conic_layers_node **parent) {
  const conic_layers_plan *plan = &worker->plan;
  size_t n = children[0]->n_drawn + children[1]->n_drawn, stride = plan->sample_bytes;
  uint64_t n_place = children[0]->n_place + children[1]->n_place;
  /* A parent takes about half of them, but the root has none. */
  size_t target = (n_place == plan->n_samples ? 1 : 2) * (size_t)plan->cloud_size;
  double distance = guess_distance((const conic_layers_node *const *)children, target);
  conic_thinner_load(worker->thinner, first_key_in(worker->candidates), stride, n);
  size_t n_chosen = conic_thinner_choose(worker->thinner, target, target + target / 4, &distance, worker->is_chosen);
  *parent = create_node(worker, n_chosen);
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

conic_status conic_layers_merge(conic_layers_worker *worker, conic_layers_node *const children[2], int is_alone,
                                conic_layers_packed *packed, conic_layers_node **parent) {
  unsigned char *second = worker->candidates + children[0]->n_drawn * worker->plan.sample_bytes;
  const uint8_t *is_chosen = worker->is_chosen;
  *parent = NULL;
  conic_status status = gather_candidates(worker, children);
  for (int i = 0; i < 2 && status == CONIC_OK && worker->standing; i++)
    conic_layers_stand_in(worker->standing, &worker->plan, i, i ? second : worker->candidates, children[i]);
  if (status == CONIC_OK)
    status = choose_samples(worker, children, parent);
  if (status != CONIC_OK) {
    conic_layers_node_destroy(children[0]);
    conic_layers_node_destroy(children[1]);
    return status;
  }
  (*parent)->children[0] = children[0];
  (*parent)->children[1] = children[1];
  status = conic_layers_bound_node(&worker->plan, worker->thinner, is_alone, *parent);
  if (status == CONIC_OK)
    status = pack_rest(worker, children[0], 0, worker->candidates, is_chosen, packed);
  if (status == CONIC_OK)
    status = pack_rest(worker, children[1], 1, second, is_chosen + children[0]->n_drawn, packed);
  forget(*parent, (*parent)->n_place);
  if (status == CONIC_OK)
    return CONIC_OK;
  conic_layers_node_destroy(*parent);
  *parent = NULL;
  return status;
}

conic_status conic_layers_finish_root(conic_layers_worker *worker, conic_layers_node *node,
                                      conic_layers_packed *packed) {
  conic_status status = conic_layers_fetch_samples(node, worker->candidates);
  if (status == CONIC_OK && worker->standing)
    conic_layers_stand_in(worker->standing, &worker->plan, 0, worker->candidates, node);
  return status == CONIC_OK ? pack_cloud(worker, node, 0, worker->candidates, node->n_drawn, packed) : status;
}

conic_status conic_layers_pool_begin(const conic_layers_plan *plan, const char *path, size_t memory_bytes,
                                     conic_layers_pool *pool) {
  pool->context = plan->context;
  pool->sample_bytes = plan->sample_bytes;
  pool->most_drawn = conic_layers_most_in_leaf(plan);
  pool->key_bits = 3 * plan->bits;
  atomic_init(&pool->n_held, 0);
  pool->most_held = memory_bytes;
  return conic_pile_begin(plan->context, path, &pool->pile);
}

void conic_layers_pool_end(conic_layers_pool *pool) {
  conic_pile_end(&pool->pile);
}

static size_t samples_bytes(const conic_layers_node *node) {
  return node->n_drawn * node->stride;
}

static size_t keys_bytes(const conic_layers_node *node) {
  return node->n_drawn * sizeof *node->keys;
}

static size_t facets_bytes(const conic_layers_node *node) {
  return node->n_drawn * sizeof *node->facets;
}

conic_status conic_layers_hold(conic_layers_pool *pool, conic_layers_node *node) {
  node->pool = pool;
  node->samples = conic_memory_allocate(pool->context, node->n_drawn, node->stride);
  node->keys = conic_memory_allocate(pool->context, node->n_drawn, sizeof *node->keys);
  node->facets = conic_memory_allocate(pool->context, node->n_drawn, sizeof *node->facets);
  atomic_fetch_add(&pool->n_held, samples_bytes(node) + keys_bytes(node) + facets_bytes(node));
  return node->samples && node->keys && node->facets ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void conic_layers_drop_samples(conic_layers_node *node) {
  if (!node->samples)
    return;
  conic_memory_release(node->pool->context, node->samples);
  node->samples = NULL;
  atomic_fetch_sub(&node->pool->n_held, samples_bytes(node));
}

void conic_layers_drop_keys(conic_layers_node *node) {
  if (node->keys)
    atomic_fetch_sub(&node->pool->n_held, keys_bytes(node) + facets_bytes(node));
  conic_memory_release_these(node->pool->context, node->keys, node->facets);
  node->keys = NULL;
  node->facets = NULL;
}

static int holds_too_much(conic_layers_pool *pool) {
  return atomic_load(&pool->n_held) > pool->most_held;
}

static conic_status put_one_away(conic_layers_node *node) {
  conic_status status = CONIC_OK;
  if (node->samples)
    status = conic_pile_append(&node->pool->pile, node->samples, samples_bytes(node), &node->samples_at);
  if (status == CONIC_OK && node->keys)
    status = conic_pile_append(&node->pool->pile, node->keys, keys_bytes(node), &node->keys_at);
  if (status == CONIC_OK && node->keys)
    status = conic_pile_append(&node->pool->pile, node->facets, facets_bytes(node), &node->facets_at);
  if (status != CONIC_OK)
    return status;
  conic_layers_drop_samples(node);
  conic_layers_drop_keys(node);
  return CONIC_OK;
}

conic_status conic_layers_put_away(conic_layers_node *const *nodes, size_t n) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK && nodes[i] && holds_too_much(nodes[i]->pool); i++) {
    status = put_one_away(nodes[i]);
    if (status == CONIC_OK)
      status = conic_layers_put_away(nodes[i]->children, 2);
  }
  return status;
}

/* Copies bytes of an array of a node: of that in memory, or, where there is none, of that at `at` in the file. */
static conic_status fetch(const conic_layers_node *node, const void *held, uint64_t at, size_t first, size_t n_bytes,
                          void *bytes) {
  if (!held)
    return conic_pile_read(&node->pool->pile, at + first, bytes, n_bytes);
  memcpy(bytes, (const char *)held + first, n_bytes);
  return CONIC_OK;
}

conic_status conic_layers_fetch_samples(const conic_layers_node *node, unsigned char *samples) {
  return fetch(node, node->samples, node->samples_at, 0, samples_bytes(node), samples);
}

conic_status conic_layers_fetch_keys(const conic_layers_node *node, size_t first, size_t n, uint64_t *keys) {
  return fetch(node, node->keys, node->keys_at, first * sizeof *keys, n * sizeof *keys, keys);
}

conic_status conic_layers_fetch_facets(const conic_layers_node *node, size_t first, size_t n,
                                       conic_layers_facet *facets) {
  return fetch(node, node->facets, node->facets_at, first * sizeof *facets, n * sizeof *facets, facets);
}
