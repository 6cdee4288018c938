#include "lod/layers/build/layers_record.h"

#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "lod/layers/build/layers_parcel.h"
#include "lod/layers/build/layers_waiting.h"

/* What a record begins with; then come the nodes, the counts of outlines, the branch and the clouds. */
typedef struct record_head {
  uint64_t n_nodes, n_counts, parcel_bytes, cloud_bytes;
  uint64_t part_bytes[CONIC_LAYERS_MOST_ATTRIBUTES];
} record_head;

/* So many samples have the outline. */
typedef struct outline_count {
  uint64_t outline, n;
} outline_count;

static record_head describe_record(const conic_layers_grown *grown, size_t parcel_bytes) {
  record_head head = {.n_nodes = grown->n_nodes, .parcel_bytes = parcel_bytes};
  memcpy(head.part_bytes, grown->part_bytes, sizeof head.part_bytes);
  for (size_t i = 0; i < CONIC_LAYERS_OUTLINES; i++)
    head.n_counts += grown->outlines[i] > 0;
  for (size_t i = 0; i < grown->n_nodes; i++)
    head.cloud_bytes += grown->nodes[i].n_bytes;
  return head;
}

static size_t record_bytes(const record_head *head) {
  return sizeof *head + (size_t)head->n_nodes * sizeof(conic_layers_entry) +
         (size_t)head->n_counts * sizeof(outline_count) + (size_t)(head->parcel_bytes + head->cloud_bytes);
}

static conic_status fill_branch_record(const conic_layers_grown *grown, const conic_pile *clouds,
                                       const record_head *head, const unsigned char *parcel, unsigned char *at) {
  conic_status status = CONIC_OK;
  uint64_t offset = 0;
  memcpy(at, head, sizeof *head);
  at += sizeof *head;
  for (size_t i = 0; i < grown->n_nodes; i++, at += sizeof *grown->nodes) {
    conic_layers_entry node = grown->nodes[i];
    node.offset = offset;
    offset += node.n_bytes;
    memcpy(at, &node, sizeof node);
  }
  for (size_t i = 0; i < CONIC_LAYERS_OUTLINES; i++)
    if (grown->outlines[i]) {
      const outline_count count = {i, grown->outlines[i]};
      memcpy(at, &count, sizeof count);
      at += sizeof count;
    }
  memcpy(at, parcel, (size_t)head->parcel_bytes);
  at += head->parcel_bytes;
  for (size_t i = 0; i < grown->n_nodes && status == CONIC_OK; i++) {
    status = conic_pile_read(clouds, grown->nodes[i].offset, at, grown->nodes[i].n_bytes);
    at += grown->nodes[i].n_bytes;
  }
  return status;
}

conic_status conic_layers_record_pack(const conic_layers_plan *plan, const conic_layers_grown *grown,
                                      const conic_pile *clouds, unsigned char **bytes, size_t *n_bytes) {
  unsigned char *parcel;
  size_t parcel_bytes;
  *bytes = NULL;
  conic_status status = conic_layers_parcel_pack(grown->branch, &parcel, &parcel_bytes);
  if (status == CONIC_OK) {
    record_head head = describe_record(grown, parcel_bytes);
    *n_bytes = record_bytes(&head);
    *bytes = conic_memory_allocate(plan->context, *n_bytes, 1);
    status = *bytes ? fill_branch_record(grown, clouds, &head, parcel, *bytes) : CONIC_ERROR_MEMORY;
  }
  conic_memory_release(plan->context, parcel);
  return status;
}

/* --- the other way --- */

/* Whether the parts are as long as the record. */
static int is_head_sound(const record_head *head, size_t n_bytes) {
  uint64_t most = n_bytes;
  return head->n_nodes <= most / sizeof(conic_layers_entry) && head->n_counts <= CONIC_LAYERS_OUTLINES &&
         head->parcel_bytes <= most && head->cloud_bytes <= most && record_bytes(head) == n_bytes;
}

/* Whether the nodes are pairs in the order of a shelf, of one tree without its root, and have their clouds in a row. */
static int are_nodes_sound(const record_head *head, const unsigned char *nodes, int is_leaf) {
  uint64_t offset = 0, n_waiting = 0; /* pairs */
  for (uint64_t i = 0; i < head->n_nodes; i++) {
    conic_layers_entry node;
    memcpy(&node, nodes + i * sizeof node, sizeof node);
    if (node.offset != offset || node.child > 1 || node.child > n_waiting)
      return 0;
    offset += node.n_bytes;
    n_waiting -= node.child;
    n_waiting += i % 2;
  }
  return offset == head->cloud_bytes && head->n_nodes % 2 == 0 && n_waiting == (is_leaf ? 0 : 1);
}

static conic_status add_outline_counts(conic_layers_worker *worker, conic_context *context, const record_head *head,
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
    conic_layers_worker_add_outlines(worker, outlines);
  conic_memory_release(context, outlines);
  return status;
}

static conic_status shelve_nodes(conic_layers_shelf *shelf, const record_head *head, const unsigned char *nodes,
                                 const unsigned char *clouds) {
  uint64_t at = 0;
  size_t n = (size_t)head->n_nodes;
  if (n == 0) /* a leaf, whose cloud waits, too */
    return CONIC_OK;
  conic_status status = conic_layers_shelf_flush(shelf);
  if (status == CONIC_OK)
    status = conic_pile_append(shelf->clouds, clouds, (size_t)head->cloud_bytes, &at);
  if (status == CONIC_OK)
    status = conic_memory_reserve(shelf->context, &shelf->nodes, shelf->n_nodes, shelf->n_nodes + n, &shelf->node_room,
                                  sizeof *shelf->nodes);
  if (status != CONIC_OK)
    return status;
  memcpy(shelf->nodes + shelf->n_nodes, nodes, n * sizeof *shelf->nodes);
  for (size_t i = 0; i < n; i++)
    shelf->nodes[shelf->n_nodes + i].offset += at;
  shelf->n_nodes += n;
  shelf->n_put = shelf->n_nodes;
  for (int k = 0; k < CONIC_LAYERS_MOST_ATTRIBUTES; k++)
    shelf->part_bytes[k] += head->part_bytes[k];
  return CONIC_OK;
}

static int is_of_place(const conic_layers_branch *branch, const conic_layers_kept_branch *place) {
  return branch->first_key >= place->key && branch->last_key - place->key < UINT64_C(1) << place->n_bits &&
         branch->n_place == place->n_samples;
}

conic_status conic_layers_record_unpack(conic_layers_worker *worker, const unsigned char *bytes, size_t n_bytes,
                                        const conic_layers_kept_branch *place, conic_layers_shelf *shelf,
                                        conic_layers_branch **branch) {
  record_head head;
  *branch = NULL;
  if (n_bytes < sizeof head)
    return CONIC_ERROR_INPUT;
  memcpy(&head, bytes, sizeof head);
  if (!is_head_sound(&head, n_bytes))
    return CONIC_ERROR_INPUT;
  const unsigned char *nodes = bytes + sizeof head;
  const unsigned char *counts = nodes + head.n_nodes * sizeof(conic_layers_entry);
  const unsigned char *parcel = counts + head.n_counts * sizeof(outline_count);
  conic_status status =
      conic_layers_parcel_unpack(conic_layers_worker_waiting(worker), parcel, (size_t)head.parcel_bytes, branch);
  if (status == CONIC_OK && !(is_of_place(*branch, place) && are_nodes_sound(&head, nodes, (*branch)->is_leaf)))
    status = CONIC_ERROR_INPUT;
  if (status == CONIC_OK)
    status = add_outline_counts(worker, shelf->context, &head, counts);
  if (status == CONIC_OK)
    status = shelve_nodes(shelf, &head, nodes, parcel + head.parcel_bytes);
  if (status == CONIC_OK)
    return CONIC_OK;
  conic_layers_branch_destroy(*branch);
  *branch = NULL;
  return status;
}
