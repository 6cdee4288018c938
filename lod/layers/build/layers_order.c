/* The entries of a grown tree in the order of the file. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "lod/layers/build/layers_grow.h"

/* A node whose children are yet to come. */
typedef struct pending_node {
  uint32_t level, number;
} pending_node;

/* Entries are looked at from the last to the first. Looked at so, behind each pair of siblings comes all that is below
 * the second, then all that is below the first. So the next pair's parent is the last node that still wants children,
 * and each level is passed through from its end. */
typedef struct order_walk {
  conic_layers_order *order;
  const conic_layers_tree *tree;
  uint64_t left; /* nodes not yet read */
  size_t n_read;
  conic_layers_entry *entries; /* CONIC_LAYERS_SOME_ENTRIES */
  size_t n_pending;
  pending_node pending[2 * CONIC_LAYERS_MOST_LEVELS];
  uint64_t ends[CONIC_LAYERS_MOST_LEVELS + 1];    /* of the levels: what is not numbered yet ends here */
  uint64_t claimed[CONIC_LAYERS_MOST_LEVELS + 1]; /* the same, of what is children of those numbered */
  int is_numbering;                               /* or counting the levels' nodes in `ends` */
} order_walk;

static conic_status read_last(order_walk *w, conic_layers_entry **node) {
  conic_status status = CONIC_OK;
  if (w->n_read == 0) {
    w->n_read = w->left < CONIC_LAYERS_SOME_ENTRIES ? (size_t)w->left : CONIC_LAYERS_SOME_ENTRIES;
    w->left -= w->n_read;
    status =
        conic_spool_read(&w->tree->entries, w->left * sizeof *w->entries, w->entries, w->n_read * sizeof *w->entries);
  }
  *node = &w->entries[w->n_read ? --w->n_read : 0];
  return status;
}

/* Gives a node the last place of its level that is free, and its children theirs. */
static conic_status number_node(order_walk *w, conic_layers_entry *node, uint32_t level, uint32_t parent,
                                uint32_t *number) {
  *number = (uint32_t)--w->ends[level];
  node->parent = parent;
  node->level = (uint16_t)level;
  if (node->child)
    node->child = (uint32_t)(w->claimed[level + 1] -= 2);
  return conic_scratch_write(&w->order->file, *number * sizeof *node, node, sizeof *node);
}

static conic_status visit_node(order_walk *w, conic_layers_entry *node, uint32_t level, uint32_t parent,
                               pending_node *found) {
  conic_status status = CONIC_OK;
  *found = (pending_node){.level = level};
  if (w->is_numbering)
    status = number_node(w, node, level, parent, &found->number);
  else
    w->ends[level]++;
  return status;
}

static conic_status visit_pair(order_walk *w) {
  pending_node parent = w->pending[--w->n_pending], found[2];
  int is_inner[2];
  if (parent.level + 1 >= CONIC_LAYERS_MOST_LEVELS)
    return conic_fail(w->tree->entries.context, CONIC_ERROR_INPUT, "%s: more than %d levels", w->order->file.path,
                      CONIC_LAYERS_MOST_LEVELS);
  for (int i = 1; i >= 0; i--) {
    conic_layers_entry *node;
    conic_status status = read_last(w, &node);
    if (status == CONIC_OK) {
      is_inner[i] = node->child != 0;
      status = visit_node(w, node, parent.level + 1, parent.number, &found[i]);
    }
    if (status != CONIC_OK)
      return status;
  }
  for (int i = 0; i < 2; i++)
    if (is_inner[i])
      w->pending[w->n_pending++] = found[i];
  return CONIC_OK;
}

static conic_status walk_all(order_walk *w) {
  conic_layers_entry *root;
  w->left = w->order->n;
  w->n_read = w->n_pending = 0;
  conic_status status = read_last(w, &root);
  if (status != CONIC_OK)
    return status;
  if (root->child)
    w->n_pending = 1;
  status = visit_node(w, root, 0, 0, &w->pending[0]);
  while (status == CONIC_OK && w->n_pending > 0)
    status = visit_pair(w);
  return status;
}

/* Turns how many nodes the levels have into where they end. */
static void lay_out_levels(order_walk *w) {
  uint64_t n = 0;
  for (uint32_t i = 0; i < CONIC_LAYERS_MOST_LEVELS; i++) {
    if (w->ends[i])
      w->order->n_levels = i + 1;
    w->ends[i] = n += w->ends[i];
  }
  memcpy(w->claimed, w->ends, sizeof w->claimed);
}

conic_status conic_layers_order_entries(conic_context *context, const char *path, const conic_layers_tree *tree,
                                        conic_layers_order *order) {
  memset(order, 0, sizeof *order);
  order->n = conic_spool_bytes(&tree->entries) / sizeof(conic_layers_entry);
  if (order->n >= UINT32_MAX)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: not written: more clouds than a file may have", path);
  order_walk *w = conic_memory_allocate_zeroed(context, 1, sizeof *w);
  conic_layers_entry *entries = conic_memory_allocate(context, CONIC_LAYERS_SOME_ENTRIES, sizeof *entries);
  conic_status status = w && entries ? conic_scratch_open(context, path, &order->file) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    w->order = order;
    w->tree = tree;
    w->entries = entries;
    status = walk_all(w);
  }
  if (status == CONIC_OK) {
    lay_out_levels(w);
    w->is_numbering = 1;
    status = walk_all(w);
  }
  conic_memory_release_these(context, entries, w);
  return status;
}

void conic_layers_order_end(conic_layers_order *order) {
  conic_scratch_close(&order->file);
}

conic_status conic_layers_order_read(const conic_layers_order *order, uint64_t first, conic_layers_entry *entries,
                                     size_t *n) {
  *n = order->n - first < CONIC_LAYERS_SOME_ENTRIES ? (size_t)(order->n - first) : CONIC_LAYERS_SOME_ENTRIES;
  return conic_scratch_read(&order->file, first * sizeof *entries, entries, *n * sizeof *entries);
}
