/* From the parts that several processes have grown to one tree. */

#include "lod/layers/build/layers_grow.h"

/* Entries that are sent at a time. */
enum { ENTRIES_A_MESSAGE = 1024 };

/* A node that waits to be merged, and the process that has it. It is null in other processes, and after a failure. */
typedef struct merge_item {
  int owner;
  conic_layers_node *node;
} merge_item;

typedef struct part_merge {
  const conic_layers_parts *parts;
  const conic_team *team;
  conic_layers_worker *worker;
  conic_layers_packed *packed; /* with the entries of the nodes that are packed here */
  size_t n;
  merge_item *stack; /* the same in every process, but for the nodes */
  conic_status status;
} part_merge;

static void fail_merge(part_merge *m, conic_status status) {
  if (m->status == CONIC_OK)
    m->status = status;
}

/* Sends a node, or nothing where there has been a failure, from which the receiver fails too. */
static void send_to_merge(part_merge *m, int to, conic_layers_node *node) {
  unsigned char *bytes = NULL;
  size_t n_bytes = 0;
  if (node)
    fail_merge(m, conic_layers_node_pack(node, &bytes, &n_bytes));
  m->team->send(m->team->data, to, bytes, m->status == CONIC_OK ? n_bytes : 0);
  conic_memory_release(m->parts->context, bytes);
  conic_layers_node_destroy(node);
}

static conic_layers_node *receive_to_merge(part_merge *m, int from) {
  conic_layers_node *node = NULL;
  size_t n_bytes;
  void *bytes = m->team->receive(m->team->data, from, &n_bytes);
  if (n_bytes == 0)
    fail_merge(m, CONIC_ERROR_CANCELLED);
  else
    fail_merge(m, conic_layers_node_unpack(m->worker->pool, bytes, n_bytes, &node));
  m->team->release(m->team->data, bytes);
  return node;
}

static conic_status put_own_away(part_merge *m) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < m->n && status == CONIC_OK; i++)
    if (m->stack[i].node)
      status = conic_layers_put_away(&m->stack[i].node, 1);
  return status;
}

/* Merges the last two, in the process that has the first. */
static void merge_last(part_merge *m) {
  merge_item *first = &m->stack[m->n - 2], *second = &m->stack[m->n - 1];
  int own = m->team->index;
  m->n--;
  if (first->owner != own) {
    if (second->owner == own)
      send_to_merge(m, first->owner, second->node);
    return;
  }
  conic_layers_node *merged = NULL;
  conic_layers_node *children[2] = {first->node,
                                    second->owner == own ? second->node : receive_to_merge(m, second->owner)};
  if (m->status == CONIC_OK)
    fail_merge(m, conic_layers_merge(m->worker, children, 1, m->packed, &merged));
  else
    for (int i = 0; i < 2; i++)
      conic_layers_node_destroy(children[i]);
  first->node = merged;
  if (m->status == CONIC_OK)
    fail_merge(m, put_own_away(m));
}

/* Every process goes through all parts in the same order, and does what concerns it. So none waits in a circle. */
static void merge_all(part_merge *m, conic_layers_node **nodes, size_t *n_own) {
  size_t n_taken = 0;
  for (size_t i = 0; i < m->parts->n; i++) {
    const conic_layers_part *part = &m->parts->list[i];
    int is_own = part->owner == m->team->index && n_taken < *n_own;
    m->stack[m->n++] = (merge_item){part->owner, is_own ? nodes[n_taken++] : NULL};
    for (unsigned k = 0; k < part->n_merges; k++)
      merge_last(m);
  }
  *n_own = 0;
  if (m->stack[0].node && m->status == CONIC_OK)
    fail_merge(m, conic_layers_finish_root(m->worker, m->stack[0].node, m->packed));
  conic_layers_node_destroy(m->stack[0].node);
  if (m->status == CONIC_OK)
    fail_merge(m, conic_layers_packed_flush(m->packed));
}

/* The next of a process's entries: of its parts, or of what it has merged. */
typedef struct entry_run {
  const conic_layers_tree *tree; /* null: those that were packed while merging */
  uint64_t at;
} entry_run;

static conic_status read_some_entries(const part_merge *m, const entry_run *run, conic_layers_entry *nodes, size_t n) {
  if (run->tree)
    return conic_spool_read(&run->tree->entries, run->at * sizeof *nodes, nodes, n * sizeof *nodes);
  memcpy(nodes, m->packed->entries + run->at, n * sizeof *nodes);
  return CONIC_OK;
}

/* Moves some of a process's entries to the first process's list. A failure leaves them as they are, and is told at the
 * end. */
static void pass_entries(part_merge *m, int from, entry_run *run, uint64_t n, conic_layers_entry *some,
                         conic_spool *all) {
  int own = m->team->index;
  for (uint64_t left = n; left > 0 && (own == from || own == 0);) {
    size_t n_now = left < ENTRIES_A_MESSAGE ? (size_t)left : ENTRIES_A_MESSAGE, n_bytes = n_now * sizeof *some;
    if (own == from) {
      fail_merge(m, read_some_entries(m, run, some, n_now));
      run->at += n_now;
      if (from != 0)
        m->team->send(m->team->data, 0, some, n_bytes);
    } else {
      void *received = m->team->receive(m->team->data, from, &n_bytes);
      memcpy(some, received, n_bytes);
      m->team->release(m->team->data, received);
    }
    for (size_t i = 0; i < n_now && own == 0; i++)
      some[i].offset |= (uint64_t)from << CONIC_LAYERS_TEAM_SHIFT;
    if (own == 0)
      fail_merge(m, conic_spool_append(all, some, n_bytes));
    left -= n_now;
  }
}

/* Tells every process how many entries each part has. */
static conic_status tell_part_sizes(const part_merge *m, const uint64_t *part_ends, uint64_t *sizes) {
  const conic_layers_parts *parts = m->parts;
  size_t n = parts->n, n_own = 0;
  uint64_t *all = conic_memory_allocate(parts->context, (size_t)m->team->count * n, sizeof *all);
  conic_status status = conic_team_agree(m->team, all ? CONIC_OK : CONIC_ERROR_MEMORY);
  memset(sizes, 0, n * sizeof *sizes);
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    if (parts->list[i].owner == m->team->index) {
      sizes[i] = part_ends[n_own] - (n_own ? part_ends[n_own - 1] : 0);
      n_own++;
    }
  if (status == CONIC_OK)
    conic_team_collect(m->team, sizes, n * sizeof *sizes, all);
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    sizes[i] = all[(size_t)parts->list[i].owner * n + i];
  conic_memory_release(parts->context, all);
  return status;
}

/* Collects entries in the order of conic_layers_packed: what is below a pair comes before it. */
static void collect_entries(part_merge *m, const uint64_t *part_sizes, const conic_layers_tree *tree,
                            conic_layers_entry *some, conic_spool *all) {
  entry_run own = {tree, 0}, merged = {NULL, 0};
  m->n = 0;
  for (size_t i = 0; i < m->parts->n; i++) {
    const conic_layers_part *part = &m->parts->list[i];
    pass_entries(m, part->owner, &own, part_sizes[i], some, all);
    m->stack[m->n++].owner = part->owner;
    for (unsigned k = 0; k < part->n_merges; k++)
      pass_entries(m, m->stack[--m->n - 1].owner, &merged, 2, some, all);
  }
  pass_entries(m, m->stack[0].owner, &merged, 1, some, all);
}

static conic_status collect_all(part_merge *m, const uint64_t *part_ends, conic_layers_tree *tree) {
  conic_context *context = m->parts->context;
  uint64_t *sizes = conic_memory_allocate(context, m->parts->n, sizeof *sizes);
  conic_layers_entry *some = conic_memory_allocate(context, ENTRIES_A_MESSAGE, sizeof *some);
  conic_spool all;
  conic_spool_begin(context, tree->entries.path, tree->entries.most_held, &all);
  m->status = conic_team_agree(m->team, sizes && some ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (m->status == CONIC_OK)
    m->status = tell_part_sizes(m, part_ends, sizes);
  if (m->status == CONIC_OK) {
    collect_entries(m, sizes, tree, some, &all);
    conic_spool_end(&tree->entries);
    tree->entries = all;
    m->status = conic_team_agree(m->team, m->status);
  }
  conic_memory_release_these(context, sizes, some);
  return m->status;
}

conic_status conic_layers_merge_parts(const conic_layers_parts *parts, conic_status status, conic_layers_worker *worker,
                                      conic_layers_packed *packed, conic_layers_node **nodes, size_t *n,
                                      const uint64_t *part_ends, conic_layers_tree *tree) {
  part_merge m = {.parts = parts, .team = parts->team, .worker = worker, .packed = packed};
  m.stack = conic_memory_allocate_zeroed(parts->context, parts->n + 1, sizeof *m.stack);
  if (!m.stack && status == CONIC_OK)
    status = CONIC_ERROR_MEMORY;
  status = conic_team_agree(m.team, status);
  if (status == CONIC_OK) {
    merge_all(&m, nodes, n);
    status = conic_team_agree(m.team, m.status);
  }
  if (status == CONIC_OK)
    status = collect_all(&m, part_ends, tree);
  conic_memory_release(parts->context, m.stack);
  return status;
}

void conic_layers_merge_counts(const conic_team *team, conic_layers_worker *worker, conic_layers_tree *tree) {
  size_t n_bytes = CONIC_LAYERS_OUTLINES * sizeof(uint64_t), n_received;
  if (team && team->index > 0) {
    team->send(team->data, 0, worker->outlines, n_bytes);
    team->send(team->data, 0, tree->attribute_bytes, sizeof tree->attribute_bytes);
  }
  for (int from = 1; team && team->index == 0 && from < team->count; from++) {
    uint64_t *outlines = team->receive(team->data, from, &n_received);
    conic_layers_add_outlines(worker, outlines);
    team->release(team->data, outlines);
    uint64_t *bytes = team->receive(team->data, from, &n_received);
    for (int k = 0; k < CONIC_LAYERS_MOST_ATTRIBUTES; k++)
      tree->attribute_bytes[k] += bytes[k];
    team->release(team->data, bytes);
  }
}
