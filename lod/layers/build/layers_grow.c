#include "lod/layers/build/layers_grow.h"

/* A group holds no more samples than this, so that progress is seen, and no more than the fraction of all of them that
 * keeps all threads busy. */
enum { MOST_IN_GROUP = 1 << 19, GROUPS_A_THREAD = 8 };

/* Buckets in a row whose samples are one cell's. Chunks come as numbers do in reverse Polish notation, and merging is
 * the operation. */
typedef struct chunk {
  size_t first, end;
  uint64_t n_samples;
  unsigned n_merges; /* with what comes before in its group, behind it */
} chunk;

/* Chunks in a row that one worker grows and merges to one tree. */
typedef struct chunk_group {
  size_t first, end;
  uint64_t n_samples;
  unsigned n_merges; /* with other groups */
  int ends_part;
  conic_layers_node *node;
  conic_layers_entry *entries;
  size_t n_entries;
  conic_status status;
} chunk_group;

/* Nodes that wait to be merged. */
typedef struct stack {
  conic_layers_node **nodes;
  size_t n, room;
} stack;

/* What one thread at a time works with. */
typedef struct grower {
  conic_layers_worker *worker;
  conic_layers_packed packed;
  unsigned char *samples, *scratch; /* of a chunk */
  stack waiting;
  uint64_t *outlines; /* counted before the group that grows; null: nothing is kept */
  uint64_t attribute_bytes[CONIC_LAYERS_MOST_ATTRIBUTES];
} grower;

typedef struct growing {
  const conic_layers_plan *plan;
  const conic_layers_buckets *buckets;
  const conic_layers_parts *parts;
  const conic_layers_growth *growth;
  conic_layers_tree *tree;
  conic_layers_pool pool;
  uint64_t n_samples; /* in the buckets */
  uint64_t most_in_group;
  size_t n_chunks, chunk_room, n_groups, group_room;
  chunk *chunks;
  chunk_group *groups;
  grower *growers;
  stack merged;
  size_t n_ended;
  uint64_t *part_ends; /* how many entries there are when a part has grown */
  size_t end_group;    /* of those that grow now */
  atomic_size_t next_group;
  atomic_int is_stopped;
  uint64_t n_grown;
} growing;

void conic_layers_tree_end(conic_layers_tree *tree) {
  conic_spool_end(&tree->entries);
  conic_pile_end(&tree->clouds);
}

static uint64_t samples_in_buckets(const growing *g, size_t first, size_t end) {
  uint64_t n_samples = 0;
  for (size_t i = first; i < end; i++)
    n_samples += g->buckets->buckets[i].count;
  return n_samples;
}

/* Whether some buckets in a row are to be split: there are too many samples, or a branch that has grown before. */
static int is_too_much(const growing *g, size_t first, size_t end, uint64_t most) {
  int has_kept = 0;
  for (size_t i = first; i < end && !has_kept; i++)
    has_kept = g->buckets->buckets[i].kept != NULL;
  return end - first > 1 && (has_kept || samples_in_buckets(g, first, end) > most);
}

/* The largest places of the tree that hold no more samples than a chunk may; a leaf is never split. */
static conic_status list_chunks(growing *g, size_t first, size_t end) {
  uint64_t n_samples = samples_in_buckets(g, first, end);
  if (is_too_much(g, first, end, g->growth->most)) {
    size_t middle = conic_layers_middle(g->buckets->buckets, sizeof *g->buckets->buckets, first, end);
    conic_status status = list_chunks(g, first, middle);
    if (status == CONIC_OK)
      status = list_chunks(g, middle, end);
    if (status == CONIC_OK)
      g->chunks[g->n_chunks - 1].n_merges++;
    return status;
  }
  const chunk made = {.first = first, .end = end, .n_samples = n_samples};
  return conic_memory_append(g->plan->context, &g->chunks, &g->n_chunks, &g->chunk_room, &made, sizeof made);
}

static conic_status list_groups(growing *g, size_t first, size_t end) {
  uint64_t n_samples = samples_in_buckets(g, first, end);
  if (is_too_much(g, first, end, g->most_in_group)) {
    size_t middle = conic_layers_middle(g->buckets->buckets, sizeof *g->buckets->buckets, first, end);
    conic_status status = list_groups(g, first, middle);
    if (status == CONIC_OK)
      status = list_groups(g, middle, end);
    if (status == CONIC_OK)
      g->groups[g->n_groups - 1].n_merges++;
    return status;
  }
  chunk_group made = {.first = g->n_chunks, .n_samples = n_samples};
  conic_status status = list_chunks(g, first, end);
  made.end = g->n_chunks;
  return status == CONIC_OK
             ? conic_memory_append(g->plan->context, &g->groups, &g->n_groups, &g->group_room, &made, sizeof made)
             : status;
}

/* Adds a node, which the stack takes over, and then merges the last two as often as it is due. */
static conic_status push_node(growing *g, const grower *with, stack *s, conic_layers_node *node, unsigned n_merges,
                              int is_alone, conic_layers_packed *packed) {
  conic_status status = conic_memory_append(g->plan->context, &s->nodes, &s->n, &s->room, &node, sizeof node);
  if (status != CONIC_OK) {
    conic_layers_node_destroy(node);
    return status;
  }
  status = conic_layers_put_away(s->nodes, s->n);
  for (; n_merges > 0 && status == CONIC_OK; n_merges--) {
    s->n -= 2;
    status = conic_layers_merge(with->worker, &s->nodes[s->n], is_alone, packed, &node);
    if (status != CONIC_OK)
      break;
    s->nodes[s->n++] = node;
    status = conic_layers_put_away(s->nodes, s->n);
  }
  return status;
}

/* Reads a branch that has grown before. */
static conic_status read_kept(growing *g, const conic_layers_kept_branch *kept, grower *h, conic_layers_node **node) {
  unsigned char *bytes;
  size_t n_bytes;
  conic_status status = conic_layers_kept_read(g->growth->kept, kept, &bytes, &n_bytes);
  if (status == CONIC_OK) {
    status = conic_layers_branch_unpack(h->worker, bytes, n_bytes, kept, &h->packed, node);
    if (status == CONIC_ERROR_INPUT)
      conic_fail(g->plan->context, status, "%s: cannot go on: it has another content than it had a while ago",
                 g->growth->kept->folder);
  }
  conic_memory_release(g->plan->context, bytes);
  return status;
}

/* Whether the group has all samples of a place. Where samples coincide, it may have only a half. */
static int is_whole_place(const growing *g, const chunk_group *p) {
  const conic_layers_bucket *buckets = g->buckets->buckets;
  size_t first = g->chunks[p->first].first, end = g->chunks[p->end - 1].end;
  return (first == 0 || buckets[first - 1].key != buckets[first].key) &&
         (end == g->buckets->n || buckets[end - 1].key != buckets[end].key);
}

/* Keeps a group that has grown as a branch. */
static conic_status keep_group(growing *g, const chunk_group *p, grower *h) {
  unsigned n_bits = conic_layers_bits_below(p->node->first_key, p->node->last_key);
  const conic_layers_kept_branch place = {p->node->first_key >> n_bits << n_bits, p->node->n_place, n_bits};
  conic_layers_grown grown = {
      .node = p->node, .entries = p->entries, .n_entries = p->n_entries, .outlines = h->outlines};
  unsigned char *bytes;
  size_t n_bytes;
  for (size_t i = 0; i < CONIC_LAYERS_OUTLINES; i++)
    h->outlines[i] = h->worker->outlines[i] - h->outlines[i];
  for (int k = 0; k < CONIC_LAYERS_MOST_ATTRIBUTES; k++)
    grown.attribute_bytes[k] = h->packed.attribute_bytes[k] - h->attribute_bytes[k];
  conic_status status = conic_layers_branch_pack(g->plan, &grown, &g->tree->clouds, &bytes, &n_bytes);
  if (status == CONIC_OK)
    status = conic_layers_kept_add(g->growth->kept, &place, bytes, n_bytes);
  conic_memory_release(g->plan->context, bytes);
  return status;
}

static conic_status grow_chunk(growing *g, const chunk *c, grower *h) {
  conic_layers_node *node;
  unsigned char *sorted;
  conic_status status;
  const conic_layers_kept_branch *kept = g->buckets->buckets[c->first].kept;
  if (kept)
    status = read_kept(g, kept, h, &node);
  else
    status = conic_layers_buckets_load(g->buckets, c->first, c->end, h->samples, h->scratch, &sorted);
  if (status == CONIC_OK && !kept)
    status = conic_layers_grow(h->worker, sorted, (size_t)c->n_samples, &h->packed, &node);
  return status == CONIC_OK ? push_node(g, h, &h->waiting, node, c->n_merges, 0, &h->packed) : status;
}

static conic_status grow_group(growing *g, chunk_group *p, grower *h) {
  conic_status status = CONIC_OK;
  int is_kept = h->outlines && !g->buckets->buckets[g->chunks[p->first].first].kept && is_whole_place(g, p);
  if (is_kept) {
    memcpy(h->outlines, h->worker->outlines, CONIC_LAYERS_OUTLINES * sizeof *h->outlines);
    memcpy(h->attribute_bytes, h->packed.attribute_bytes, sizeof h->attribute_bytes);
  }
  for (size_t i = p->first; i < p->end && status == CONIC_OK; i++)
    status = grow_chunk(g, &g->chunks[i], h);
  if (status == CONIC_OK)
    status = conic_layers_packed_flush(&h->packed);
  if (status != CONIC_OK)
    return status;
  p->node = h->waiting.nodes[--h->waiting.n];
  p->n_entries = h->packed.n_entries;
  p->entries = conic_memory_allocate(g->plan->context, p->n_entries, sizeof *p->entries);
  if (!p->entries)
    return CONIC_ERROR_MEMORY;
  if (p->n_entries > 0)
    memcpy(p->entries, h->packed.entries, p->n_entries * sizeof *p->entries);
  h->packed.n_entries = h->packed.n_put = 0;
  return is_kept ? keep_group(g, p, h) : CONIC_OK;
}

/* Grows groups one after the other. The calling thread tells of the progress before each of its own. */
static void grow_groups(void *data, size_t i_grower, int i_thread) {
  growing *g = data;
  for (;;) {
    size_t i = atomic_fetch_add(&g->next_group, 1);
    if (i >= g->end_group || atomic_load(&g->is_stopped))
      return;
    chunk_group *p = &g->groups[i];
    p->status = CONIC_OK;
    if (i_thread == 0)
      p->status = conic_progress(g->plan->context, "build", (double)g->n_grown / (double)g->n_samples);
    if (p->status == CONIC_OK)
      p->status = grow_group(g, p, &g->growers[i_grower]);
    if (p->status != CONIC_OK)
      atomic_store(&g->is_stopped, 1);
  }
}

static conic_status put_entries(growing *g, const conic_layers_entry *entries, size_t n) {
  return conic_spool_append(&g->tree->entries, entries, n * sizeof *entries);
}

/* Merges a group that has grown with those before it. */
static conic_status collect_group(growing *g, chunk_group *p) {
  grower *h = &g->growers[0];
  conic_layers_node *node = p->node;
  conic_status status = put_entries(g, p->entries, p->n_entries);
  conic_memory_release(g->plan->context, p->entries);
  p->entries = NULL;
  if (status != CONIC_OK)
    return status;
  p->node = NULL;
  g->n_grown += p->n_samples;
  status = push_node(g, h, &g->merged, node, p->n_merges, 1, &h->packed);
  if (status == CONIC_OK)
    status = conic_layers_packed_flush(&h->packed);
  if (status == CONIC_OK)
    status = put_entries(g, h->packed.entries, h->packed.n_entries);
  h->packed.n_entries = h->packed.n_put = 0;
  if (p->ends_part)
    g->part_ends[g->n_ended++] = conic_spool_bytes(&g->tree->entries) / sizeof *p->entries;
  return status;
}

/* Some groups at a time, so that memory does not grow with what waits to be collected. */
static conic_status grow_all(growing *g) {
  conic_status status = CONIC_OK;
  size_t n_growers = (size_t)g->growth->n_workers, n_now = 4 * n_growers;
  for (size_t first = 0; first < g->n_groups && status == CONIC_OK; first = g->end_group) {
    g->end_group = g->n_groups - first < n_now ? g->n_groups : first + n_now;
    atomic_store(&g->next_group, first);
    conic_parallel_for(g->plan->context, n_growers, grow_groups, g);
    for (size_t i = first; i < g->end_group && atomic_load(&g->is_stopped) && status == CONIC_OK; i++)
      status = g->groups[i].status;
    for (size_t i = first; i < g->end_group && status == CONIC_OK; i++)
      status = collect_group(g, &g->groups[i]);
  }
  return status == CONIC_OK ? conic_progress(g->plan->context, "build", 1.0) : status;
}

/* Adds up what all workers have counted in the first one. */
static void add_up(growing *g) {
  for (int i = 0; i < g->growth->n_workers; i++)
    for (int k = 0; k < CONIC_LAYERS_MOST_ATTRIBUTES; k++)
      g->tree->attribute_bytes[k] += g->growers[i].packed.attribute_bytes[k];
  for (int i = 1; i < g->growth->n_workers; i++)
    conic_layers_add_outlines(g->growers[0].worker, g->growers[i].worker->outlines);
}

/* The lower median of all samples' outlines. */
static double median_outline(const growing *g) {
  const uint64_t *outlines = g->growers[0].worker->outlines;
  uint64_t before = 0;
  uint16_t code = 0;
  for (uint32_t i = 0; i < CONIC_LAYERS_OUTLINES && before <= (g->plan->n_samples - 1) / 2; i++) {
    code = (uint16_t)i;
    before += outlines[i];
  }
  return (double)conic_layers_size_of(code);
}

/* Merges all processes' parts, and then packs the root's own cloud. */
static conic_status finish_tree(growing *g, conic_status status) {
  grower *h = &g->growers[0];
  if (g->parts->team)
    return conic_layers_merge_parts(g->parts, status, h->worker, &h->packed, g->merged.nodes, &g->merged.n,
                                    g->part_ends, g->tree);
  if (status == CONIC_OK)
    status = conic_layers_finish_root(h->worker, g->merged.nodes[0], &h->packed);
  if (status == CONIC_OK)
    status = conic_layers_packed_flush(&h->packed);
  return status == CONIC_OK ? put_entries(g, h->packed.entries, h->packed.n_entries) : status;
}

static conic_status create_growers(growing *g) {
  conic_context *context = g->plan->context;
  conic_status status = CONIC_OK;
  uint64_t most = 0;
  for (size_t i = 0; i < g->n_chunks; i++)
    if (!g->buckets->buckets[g->chunks[i].first].kept)
      most = g->chunks[i].n_samples > most ? g->chunks[i].n_samples : most;
  g->growers = conic_memory_allocate_zeroed(context, (size_t)g->growth->n_workers, sizeof *g->growers);
  if (!g->growers)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < g->growth->n_workers && status == CONIC_OK; i++) {
    grower *h = &g->growers[i];
    h->packed = (conic_layers_packed){.context = context, .clouds = &g->tree->clouds};
    status = conic_layers_worker_create(g->plan, &g->pool, &h->worker);
    h->samples = conic_memory_allocate(context, (size_t)most, g->plan->sample_bytes);
    h->scratch = conic_memory_allocate(context, (size_t)most, g->plan->sample_bytes);
    if (g->growth->kept->key)
      h->outlines = conic_memory_allocate(context, CONIC_LAYERS_OUTLINES, sizeof *h->outlines);
    if (!h->samples || !h->scratch || (g->growth->kept->key && !h->outlines))
      status = CONIC_ERROR_MEMORY;
  }
  return status;
}

static void release_stack(conic_context *context, stack *s) {
  for (size_t i = 0; i < s->n; i++)
    conic_layers_node_destroy(s->nodes[i]);
  conic_memory_release(context, s->nodes);
}

static void release_growing(growing *g) {
  conic_context *context = g->plan->context;
  for (size_t i = 0; i < g->n_groups; i++) {
    conic_layers_node_destroy(g->groups[i].node);
    conic_memory_release(context, g->groups[i].entries);
  }
  for (int i = 0; i < g->growth->n_workers && g->growers; i++) {
    grower *h = &g->growers[i];
    release_stack(context, &h->waiting);
    conic_layers_worker_destroy(h->worker);
    conic_layers_packed_release(&h->packed);
    conic_memory_release_these(context, h->samples, h->scratch, h->outlines);
  }
  release_stack(context, &g->merged);
  conic_memory_release_these(context, g->growers, g->groups, g->chunks, g->part_ends);
  conic_layers_pool_end(&g->pool);
}

/* Lists chunks and groups of all buckets, part by part. */
static conic_status list_all_groups(growing *g) {
  const conic_layers_parts *parts = g->parts;
  const conic_layers_buckets *buckets = g->buckets;
  conic_status status = CONIC_OK;
  g->n_samples = samples_in_buckets(g, 0, buckets->n);
  uint64_t even = g->n_samples / (GROUPS_A_THREAD * (uint64_t)g->growth->n_workers);
  g->most_in_group = even < MOST_IN_GROUP ? even : MOST_IN_GROUP;
  if (g->growth->kept->key || g->most_in_group < g->growth->most)
    g->most_in_group = g->growth->most;
  g->part_ends = conic_memory_allocate(g->plan->context, parts->n_own, sizeof *g->part_ends);
  if (!g->part_ends)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0, first = 0, end = 0; i < parts->n_own && status == CONIC_OK; i++, first = end) {
    while (end < buckets->n && (i + 1 == parts->n_own || buckets->buckets[end].key < parts->own_keys[i + 1]))
      end++;
    status = list_groups(g, first, end);
    if (status == CONIC_OK)
      g->groups[g->n_groups - 1].ends_part = 1;
  }
  return status;
}

conic_status conic_layers_tree_grow(const conic_layers_plan *plan, const conic_layers_buckets *buckets,
                                    const conic_layers_parts *parts, const conic_layers_growth *growth,
                                    conic_layers_tree *tree) {
  growing *g = conic_memory_allocate_zeroed(plan->context, 1, sizeof *g);
  memset(tree, 0, sizeof *tree);
  conic_status status = conic_team_agree(parts->team, g ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status != CONIC_OK) {
    conic_memory_release(plan->context, g);
    return status;
  }
  *g = (growing){.plan = plan, .buckets = buckets, .parts = parts, .growth = growth, .tree = tree};
  conic_spool_begin(plan->context, buckets->spool.path, growth->entry_bytes, &tree->entries);
  status = conic_pile_begin(plan->context, buckets->spool.path, &tree->clouds);
  if (status == CONIC_OK)
    status = conic_layers_pool_begin(plan, buckets->spool.path, growth->pool_bytes, &g->pool);
  if (status == CONIC_OK)
    status = list_all_groups(g);
  if (status == CONIC_OK)
    status = create_growers(g);
  status = conic_team_agree(parts->team, status);
  if (status == CONIC_OK) {
    conic_moment start = conic_moment_now();
    status = grow_all(g);
    start = conic_team_note(parts->team, "grow", start, g->n_samples);
    status = finish_tree(g, status);
    add_up(g);
    if (status == CONIC_OK)
      conic_layers_merge_counts(parts->team, g->growers[0].worker, tree);
    conic_team_note(parts->team, "crown", start, parts->n);
  }
  if (status == CONIC_OK)
    tree->outline = median_outline(g);
  release_growing(g);
  conic_memory_release(plan->context, g);
  return status;
}
