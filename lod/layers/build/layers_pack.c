/* Nodes and branches as bytes. */

#include "lod/layers/build/layers_node.h"

static size_t padded_facets_bytes(const conic_layers_node *node) {
  return (node->n_drawn * sizeof *node->facets + 7) / 8 * 8;
}

/* A node's bytes: whether it has its two children, the end of the struct as it is, its samples if it has some, its keys
 * and facets, and then its children. Each is a multiple of 8. */
#define KEPT_AT offsetof(conic_layers_node, first_key)
#define HEAD_BYTES (sizeof(uint64_t) + sizeof(conic_layers_node) - KEPT_AT)

/* Nodes lie no deeper below each other than keys have bits, and counts of samples that coincide. */
enum { MOST_DEPTH = 128 };

static size_t own_bytes(const conic_layers_node *node, int has_samples) {
  return HEAD_BYTES + node->n_drawn * ((has_samples ? node->stride : 0) + sizeof *node->keys) +
         padded_facets_bytes(node);
}

static size_t packed_bytes(const conic_layers_node *node, int has_samples) {
  size_t n = own_bytes(node, has_samples);
  for (int i = 0; i < 2; i++)
    n += node->children[i] ? packed_bytes(node->children[i], 0) : 0;
  return n;
}

static conic_status pack_node(const conic_layers_node *node, int has_samples, unsigned char **at) {
  size_t n = node->n_drawn;
  conic_status status = CONIC_OK;
  uint64_t has_children = node->children[0] != NULL;
  memcpy(*at, &has_children, sizeof has_children);
  memcpy(*at + sizeof has_children, (const char *)node + KEPT_AT, HEAD_BYTES - sizeof has_children);
  *at += HEAD_BYTES;
  if (has_samples) {
    status = conic_layers_fetch_samples(node, *at);
    *at += n * node->stride;
  }
  if (status == CONIC_OK)
    status = conic_layers_fetch_keys(node, 0, n, (uint64_t *)(void *)*at);
  *at += n * sizeof *node->keys;
  if (status == CONIC_OK)
    status = conic_layers_fetch_facets(node, 0, n, (conic_layers_facet *)(void *)*at);
  *at += padded_facets_bytes(node);
  for (int i = 0; i < 2 && status == CONIC_OK; i++)
    if (node->children[i])
      status = pack_node(node->children[i], 0, at);
  return status;
}

conic_status conic_layers_node_pack(const conic_layers_node *node, unsigned char **bytes, size_t *n_bytes) {
  *n_bytes = packed_bytes(node, 1);
  *bytes = conic_memory_allocate(node->pool->context, *n_bytes, 1);
  unsigned char *at = *bytes;
  return at ? pack_node(node, 1, &at) : CONIC_ERROR_MEMORY;
}

typedef struct unpacking {
  conic_layers_pool *pool;
  const unsigned char *at, *end;
} unpacking;

static int are_numbers_sound(const conic_layers_node *b) {
  const double *numbers[] = {&b->area,    &b->distance, &b->covering, &b->radius,    &b->past,
                             &b->error,   b->low,       b->low + 1,   b->low + 2,    b->high,
                             b->high + 1, b->high + 2,  b->center,    b->center + 1, b->center + 2,
                             &b->sphere,  b->axis,      b->axis + 1,  b->axis + 2,   &b->cone};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    if (!(fabs(*numbers[i]) < 1e15))
      return 0;
  return 1;
}

static int is_node_sound(const conic_layers_pool *pool, const conic_layers_node *node) {
  return node->n_drawn > 0 && node->n_drawn <= pool->most_drawn && node->n_place >= node->n_drawn &&
         node->first_key <= node->last_key && node->last_key >> pool->key_bits == 0 &&
         (node->is_leaf == 0 || node->is_leaf == 1) && are_numbers_sound(node);
}

static int are_keys_sound(const conic_layers_node *node, int has_samples) {
  uint64_t before = node->first_key;
  for (size_t i = 0; i < node->n_drawn; i++) {
    uint64_t key = node->keys[i];
    if (key < before || key > node->last_key || (has_samples && conic_layers_drawn_at(node, i)->key != key))
      return 0;
    before = key;
  }
  return 1;
}

/* Reads the head, and moves past it. */
static conic_status unpack_head(unpacking *u, int has_samples, uint64_t *has_children, conic_layers_node *made) {
  if ((size_t)(u->end - u->at) < HEAD_BYTES)
    return CONIC_ERROR_INPUT;
  memcpy(has_children, u->at, sizeof *has_children);
  memcpy((char *)made + KEPT_AT, u->at + sizeof *has_children, HEAD_BYTES - sizeof *has_children);
  made->stride = u->pool->sample_bytes;
  made->pool = u->pool;
  if (!is_node_sound(u->pool, made) || (size_t)(u->end - u->at) < own_bytes(made, has_samples)) {
    made->n_drawn = 0;
    return CONIC_ERROR_INPUT;
  }
  u->at += HEAD_BYTES;
  return CONIC_OK;
}

static conic_status unpack_arrays(unpacking *u, int has_samples, conic_layers_node *made) {
  size_t n = made->n_drawn;
  conic_status status = conic_layers_hold(u->pool, made);
  if (status != CONIC_OK)
    return status;
  if (has_samples)
    memcpy(made->samples, u->at, n * made->stride);
  u->at += has_samples ? n * made->stride : 0;
  memcpy(made->keys, u->at, n * sizeof *made->keys);
  u->at += n * sizeof *made->keys;
  memcpy(made->facets, u->at, n * sizeof *made->facets);
  u->at += padded_facets_bytes(made);
  if (!are_keys_sound(made, has_samples))
    return CONIC_ERROR_INPUT;
  if (!has_samples)
    conic_layers_drop_samples(made);
  return CONIC_OK;
}

static conic_status unpack(unpacking *u, int depth, conic_layers_node **node) {
  uint64_t has_children = 0;
  conic_layers_node *made = conic_memory_allocate_zeroed(u->pool->context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->pool = u->pool;
  *node = made;
  conic_status status = unpack_head(u, depth == 0, &has_children, made);
  if (status == CONIC_OK)
    status = unpack_arrays(u, depth == 0, made);
  if (status == CONIC_OK && (depth == MOST_DEPTH || has_children > 1))
    status = CONIC_ERROR_INPUT;
  for (int i = 0; i < 2 && has_children && status == CONIC_OK; i++)
    status = unpack(u, depth + 1, &made->children[i]);
  return status;
}

conic_status conic_layers_node_unpack(conic_layers_pool *pool, const unsigned char *bytes, size_t n_bytes,
                                      conic_layers_node **node) {
  unpacking u = {pool, bytes, bytes + n_bytes};
  *node = NULL;
  conic_status status = unpack(&u, 0, node);
  if (status == CONIC_OK && u.at == u.end)
    return CONIC_OK;
  conic_layers_node_destroy(*node);
  *node = NULL;
  return status == CONIC_OK ? CONIC_ERROR_INPUT : status;
}

/* --- branches --- */

/* A branch's bytes begin with this. Then come the entries, the counts of outlines, the node and the clouds. */
typedef struct branch_head {
  uint64_t n_entries, n_counts, node_bytes, cloud_bytes;
  uint64_t attribute_bytes[CONIC_LAYERS_MOST_ATTRIBUTES];
} branch_head;

/* How many samples have an outline. */
typedef struct outline_count {
  uint64_t outline, n;
} outline_count;

static branch_head describe_branch(const conic_layers_grown *grown, size_t node_bytes) {
  branch_head head = {.n_entries = grown->n_entries, .node_bytes = node_bytes};
  memcpy(head.attribute_bytes, grown->attribute_bytes, sizeof head.attribute_bytes);
  for (size_t i = 0; i < CONIC_LAYERS_OUTLINES; i++)
    head.n_counts += grown->outlines[i] > 0;
  for (size_t i = 0; i < grown->n_entries; i++)
    head.cloud_bytes += conic_layers_bytes_together(&grown->entries[i]);
  return head;
}

static size_t branch_bytes(const branch_head *head) {
  return sizeof *head + (size_t)head->n_entries * sizeof(conic_layers_entry) +
         (size_t)head->n_counts * sizeof(outline_count) + (size_t)(head->node_bytes + head->cloud_bytes);
}

static conic_status fill_branch(const conic_layers_grown *grown, const conic_pile *clouds, const branch_head *head,
                                const unsigned char *packed_node, unsigned char *at) {
  conic_status status = CONIC_OK;
  uint64_t offset = 0;
  memcpy(at, head, sizeof *head);
  at += sizeof *head;
  for (size_t i = 0; i < grown->n_entries; i++, at += sizeof *grown->entries) {
    conic_layers_entry entry = grown->entries[i];
    entry.offset = offset;
    offset += conic_layers_bytes_together(&entry);
    memcpy(at, &entry, sizeof entry);
  }
  for (size_t i = 0; i < CONIC_LAYERS_OUTLINES; i++)
    if (grown->outlines[i]) {
      const outline_count count = {i, grown->outlines[i]};
      memcpy(at, &count, sizeof count);
      at += sizeof count;
    }
  memcpy(at, packed_node, (size_t)head->node_bytes);
  at += head->node_bytes;
  for (size_t i = 0; i < grown->n_entries && status == CONIC_OK; i++) {
    size_t n_bytes = (size_t)conic_layers_bytes_together(&grown->entries[i]);
    status = conic_pile_read(clouds, grown->entries[i].offset, at, n_bytes);
    at += n_bytes;
  }
  return status;
}

conic_status conic_layers_branch_pack(const conic_layers_plan *plan, const conic_layers_grown *grown,
                                      const conic_pile *clouds, unsigned char **bytes, size_t *n_bytes) {
  unsigned char *packed_node;
  size_t node_bytes;
  *bytes = NULL;
  conic_status status = conic_layers_node_pack(grown->node, &packed_node, &node_bytes);
  if (status == CONIC_OK) {
    branch_head head = describe_branch(grown, node_bytes);
    *n_bytes = branch_bytes(&head);
    *bytes = conic_memory_allocate(plan->context, *n_bytes, 1);
    status = *bytes ? fill_branch(grown, clouds, &head, packed_node, *bytes) : CONIC_ERROR_MEMORY;
  }
  conic_memory_release(plan->context, packed_node);
  return status;
}

/* Whether all that the head tells of is together as long as the bytes. */
static int is_head_sound(const branch_head *head, size_t n_bytes) {
  uint64_t most = n_bytes;
  return head->n_entries <= most / sizeof(conic_layers_entry) && head->n_counts <= CONIC_LAYERS_OUTLINES &&
         head->node_bytes <= most && head->cloud_bytes <= most && branch_bytes(head) == n_bytes;
}

/* Whether the entries are pairs in the order of conic_layers_packed, of one tree without its root, with their clouds in
 * a row. */
static int are_entries_sound(const branch_head *head, const unsigned char *entries, int is_leaf) {
  uint64_t offset = 0, n_open = 0; /* pairs */
  for (uint64_t i = 0; i < head->n_entries; i++) {
    conic_layers_entry entry;
    memcpy(&entry, entries + i * sizeof entry, sizeof entry);
    if (entry.offset != offset || entry.child > 1 || entry.child > n_open)
      return 0;
    offset += conic_layers_bytes_together(&entry);
    n_open -= entry.child;
    n_open += i % 2;
  }
  return offset == head->cloud_bytes && head->n_entries % 2 == 0 && n_open == (is_leaf ? 0 : 1);
}

static conic_status add_outline_counts(conic_layers_worker *worker, conic_context *context, const branch_head *head,
                                       const unsigned char *counts) {
  uint64_t *outlines = conic_memory_allocate_zeroed(context, CONIC_LAYERS_OUTLINES, sizeof *outlines);
  conic_status status = outlines ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (uint64_t i = 0; i < head->n_counts && status == CONIC_OK; i++) {
    outline_count count;
    memcpy(&count, counts + i * sizeof count, sizeof count);
    if (count.outline < CONIC_LAYERS_OUTLINES)
      outlines[count.outline] = count.n;
    else
      status = CONIC_ERROR_INPUT;
  }
  if (status == CONIC_OK)
    conic_layers_add_outlines(worker, outlines);
  conic_memory_release(context, outlines);
  return status;
}

static conic_status add_entries(conic_layers_packed *packed, const branch_head *head, const unsigned char *entries,
                                const unsigned char *clouds) {
  uint64_t at = 0;
  size_t n = (size_t)head->n_entries;
  if (n == 0) /* a leaf, whose cloud waits, too */
    return CONIC_OK;
  conic_status status = conic_layers_packed_flush(packed);
  if (status == CONIC_OK)
    status = conic_pile_append(packed->clouds, clouds, (size_t)head->cloud_bytes, &at);
  if (status == CONIC_OK)
    status = conic_memory_reserve(packed->context, &packed->entries, packed->n_entries, packed->n_entries + n,
                                  &packed->entry_room, sizeof *packed->entries);
  if (status != CONIC_OK)
    return status;
  memcpy(packed->entries + packed->n_entries, entries, n * sizeof *packed->entries);
  for (size_t i = 0; i < n; i++)
    packed->entries[packed->n_entries + i].offset += at;
  packed->n_entries += n;
  packed->n_put = packed->n_entries;
  for (int k = 0; k < CONIC_LAYERS_MOST_ATTRIBUTES; k++)
    packed->attribute_bytes[k] += head->attribute_bytes[k];
  return CONIC_OK;
}

static int is_of_place(const conic_layers_node *node, const conic_layers_kept_branch *place) {
  return node->first_key >= place->key && node->last_key - place->key < UINT64_C(1) << place->n_bits &&
         node->n_place == place->n_samples;
}

conic_status conic_layers_branch_unpack(conic_layers_worker *worker, const unsigned char *bytes, size_t n_bytes,
                                        const conic_layers_kept_branch *place, conic_layers_packed *packed,
                                        conic_layers_node **node) {
  branch_head head;
  *node = NULL;
  if (n_bytes < sizeof head)
    return CONIC_ERROR_INPUT;
  memcpy(&head, bytes, sizeof head);
  if (!is_head_sound(&head, n_bytes))
    return CONIC_ERROR_INPUT;
  const unsigned char *entries = bytes + sizeof head;
  const unsigned char *counts = entries + head.n_entries * sizeof(conic_layers_entry);
  const unsigned char *packed_node = counts + head.n_counts * sizeof(outline_count);
  conic_status status = conic_layers_node_unpack(worker->pool, packed_node, (size_t)head.node_bytes, node);
  if (status == CONIC_OK && !(is_of_place(*node, place) && are_entries_sound(&head, entries, (*node)->is_leaf)))
    status = CONIC_ERROR_INPUT;
  if (status == CONIC_OK)
    status = add_outline_counts(worker, packed->context, &head, counts);
  if (status == CONIC_OK)
    status = add_entries(packed, &head, entries, packed_node + head.node_bytes);
  if (status == CONIC_OK)
    return CONIC_OK;
  conic_layers_node_destroy(*node);
  *node = NULL;
  return status;
}
