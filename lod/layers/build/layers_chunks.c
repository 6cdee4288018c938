#include "lod/layers/build/layers_chunks.h"

#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/threads.h"
#include "lod/layers/build/layers_branch.h"

/* Buckets in a row whose samples are one cell's, and what has grown of them. */
typedef struct chunk {
  size_t first, end;
  uint64_t n_samples;
  conic_layers_shelf shelf;
  conic_layers_branch *branch;
  conic_status status;
} chunk;

typedef struct growing {
  const conic_layers_plan *plan;
  const conic_layers_buckets *buckets;
  conic_layers_forest *forest;
  uint64_t most;
  size_t n_chunks, chunk_room;
  chunk *chunks;
  size_t first_chunk; /* of those that grow now */
  int n_workers;
  conic_layers_worker **workers; /* one a thread */
} growing;

void conic_layers_forest_end(conic_layers_forest *forest) {
  if (forest->shelf.context)
    conic_layers_shelf_release(&forest->shelf);
  conic_spool_end(&forest->spool);
}

static conic_status add_chunk(growing *g, size_t first, size_t end, uint64_t n_samples) {
  conic_context *context = g->plan->context;
  if (conic_memory_reserve(context, &g->chunks, g->n_chunks, g->n_chunks + 1, &g->chunk_room, sizeof *g->chunks) !=
      CONIC_OK)
    return CONIC_ERROR_MEMORY;
  g->chunks[g->n_chunks++] = (chunk){.first = first, .end = end, .n_samples = n_samples, .shelf = {.context = context}};
  return CONIC_OK;
}

/* The first of some buckets in a row that is past the middle of the place they share. */
static size_t split_buckets(const conic_layers_bucket *buckets, size_t first, size_t end) {
  uint64_t differing = buckets[first].key ^ buckets[end - 1].key;
  uint64_t bit = UINT64_C(1) << (63 - __builtin_clzll(differing));
  size_t at = first;
  while (!(buckets[at].key & bit))
    at++;
  return at;
}

/* The largest places of the tree that hold no more samples than a chunk may; a leaf is never parted. */
static conic_status part(growing *g, size_t first, size_t end) {
  uint64_t n_samples = 0;
  for (size_t i = first; i < end; i++)
    n_samples += g->buckets->buckets[i].count;
  if (n_samples <= g->most || end - first == 1)
    return add_chunk(g, first, end, n_samples);
  size_t middle = split_buckets(g->buckets->buckets, first, end);
  conic_status status = part(g, first, middle);
  return status == CONIC_OK ? part(g, middle, end) : status;
}

static conic_status grow_chunk(growing *g, chunk *c, conic_layers_worker *worker) {
  conic_context *context = g->plan->context;
  conic_layers_sample *samples = conic_memory_allocate(context, (size_t)c->n_samples, sizeof *samples);
  conic_layers_sample *scratch = conic_memory_allocate(context, (size_t)c->n_samples, sizeof *scratch);
  conic_status status = samples && scratch ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_layers_buckets_load(g->buckets, c->first, c->end, samples, scratch);
  conic_memory_release(context, scratch);
  if (status == CONIC_OK)
    status = conic_layers_grow(worker, samples, (size_t)c->n_samples, &c->shelf, &c->branch);
  conic_memory_release(context, samples);
  return status;
}

static void grow_task(void *data, size_t i_item, int i_thread) {
  growing *g = data;
  chunk *c = &g->chunks[g->first_chunk + i_item];
  c->status = grow_chunk(g, c, g->workers[i_thread]);
}

/* Moves a chunk's nodes behind those that there are, and its bytes to the spool. */
static conic_status collect_chunk(growing *g, chunk *c) {
  conic_layers_shelf *all = &g->forest->shelf;
  uint32_t n_before = (uint32_t)all->n_nodes;
  uint64_t offset = conic_spool_bytes(&g->forest->spool);
  size_t n = all->n_nodes + c->shelf.n_nodes;
  if (conic_memory_reserve(all->context, &all->nodes, all->n_nodes, n, &all->node_room, sizeof *all->nodes) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < c->shelf.n_nodes; i++) {
    conic_layers_node node = c->shelf.nodes[i];
    node.entry.offset += offset;
    for (int k = 0; k < 2; k++)
      node.children[k] += node.children[k] != CONIC_LAYERS_NO_NODE ? n_before : 0;
    all->nodes[all->n_nodes++] = node;
  }
  for (int i = 0; i < CONIC_LAYERS_PARTS; i++)
    all->part_bytes[i] += c->shelf.part_bytes[i];
  conic_status status = conic_spool_append(&g->forest->spool, c->shelf.bytes, c->shelf.n_bytes);
  conic_layers_shelf_release(&c->shelf);
  for (int k = 0; k < 2 && c->branch; k++)
    c->branch->nodes[k] += c->branch->nodes[k] != CONIC_LAYERS_NO_NODE ? n_before : 0;
  return status;
}

/* Some chunks at a time, so that progress is seen and memory does not grow with what waits to be collected. */
static conic_status grow_chunks(growing *g) {
  conic_context *context = g->plan->context;
  uint64_t n_done = 0, n_all = 0;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < g->n_chunks; i++)
    n_all += g->chunks[i].n_samples;
  for (size_t first = 0, n; first < g->n_chunks && status == CONIC_OK; first += n) {
    n = g->n_chunks - first < 4 * (size_t)g->n_workers ? g->n_chunks - first : 4 * (size_t)g->n_workers;
    g->first_chunk = first;
    uint64_t n_now = 0;
    for (size_t i = first; i < first + n; i++)
      n_now += g->chunks[i].n_samples;
    status = conic_parallel_told(context, "build", (double)n_done / (double)n_all,
                                 (double)(n_done + n_now) / (double)n_all, n, grow_task, g);
    n_done += n_now;
    for (size_t i = first; i < first + n && status == CONIC_OK; i++) {
      status = g->chunks[i].status;
      if (status == CONIC_OK)
        status = collect_chunk(g, &g->chunks[i]);
    }
  }
  return status == CONIC_OK ? conic_progress(context, "build", 1.0) : status;
}

/* The first of some chunks in a row that is past the middle of the place they share. */
static size_t split_chunks(const growing *g, size_t first, size_t end) {
  uint64_t differing = g->chunks[first].branch->first_key ^ g->chunks[end - 1].branch->last_key;
  uint64_t bit = UINT64_C(1) << (63 - __builtin_clzll(differing));
  size_t at = first;
  while (!(g->chunks[at].branch->first_key & bit))
    at++;
  return at;
}

static conic_status join_chunks(growing *g, size_t first, size_t end, conic_layers_branch **branch) {
  conic_layers_branch *children[2] = {NULL, NULL};
  *branch = NULL;
  if (end - first == 1) {
    *branch = g->chunks[first].branch;
    g->chunks[first].branch = NULL;
    return CONIC_OK;
  }
  size_t middle = split_chunks(g, first, end);
  conic_status status = join_chunks(g, first, middle, &children[0]);
  if (status == CONIC_OK)
    status = join_chunks(g, middle, end, &children[1]);
  if (status == CONIC_OK)
    return conic_layers_join(g->workers[0], children, &g->forest->shelf, branch);
  conic_layers_branch_destroy(g->plan->context, children[0]);
  conic_layers_branch_destroy(g->plan->context, children[1]);
  return status;
}

/* The nodes above the chunks, and the root's own cloud. */
static conic_status grow_crown(growing *g) {
  conic_layers_shelf *all = &g->forest->shelf;
  conic_layers_branch *root;
  size_t n_before = all->n_nodes;
  uint64_t offset = conic_spool_bytes(&g->forest->spool);
  conic_status status = join_chunks(g, 0, g->n_chunks, &root);
  if (status == CONIC_OK)
    status = conic_layers_finish_root(g->workers[0], root, all);
  conic_layers_branch_destroy(g->plan->context, root);
  if (status != CONIC_OK)
    return status;
  for (size_t i = n_before; i < all->n_nodes; i++)
    all->nodes[i].entry.offset += offset;
  g->forest->root = (uint32_t)all->n_nodes - 1;
  return conic_spool_append(&g->forest->spool, all->bytes, all->n_bytes);
}

static conic_status create_workers(growing *g) {
  conic_context *context = g->plan->context;
  conic_status status = CONIC_OK;
  g->n_workers = conic_context_threads(context);
  g->workers = conic_memory_allocate_zeroed(context, (size_t)g->n_workers, sizeof(void *));
  if (!g->workers)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < g->n_workers && status == CONIC_OK; i++)
    status = conic_layers_worker_create(g->plan, &g->workers[i]);
  return status;
}

static void release_growing(growing *g) {
  conic_context *context = g->plan->context;
  for (size_t i = 0; i < g->n_chunks; i++) {
    conic_layers_shelf_release(&g->chunks[i].shelf);
    conic_layers_branch_destroy(context, g->chunks[i].branch);
  }
  for (int i = 0; i < g->n_workers && g->workers; i++)
    conic_layers_worker_destroy(g->workers[i]);
  conic_memory_release(context, g->workers);
  conic_memory_release(context, g->chunks);
}

conic_status conic_layers_forest_grow(const conic_layers_plan *plan, const conic_layers_buckets *buckets, uint64_t most,
                                      size_t memory_bytes, conic_layers_forest *forest) {
  growing g = {.plan = plan, .buckets = buckets, .forest = forest, .most = most};
  memset(forest, 0, sizeof *forest);
  forest->shelf.context = plan->context;
  conic_spool_begin(plan->context, buckets->spool.path, memory_bytes, &forest->spool);
  conic_status status = create_workers(&g);
  if (status == CONIC_OK)
    status = part(&g, 0, buckets->n);
  if (status == CONIC_OK)
    status = grow_chunks(&g);
  if (status == CONIC_OK)
    status = grow_crown(&g);
  release_growing(&g);
  return status;
}
