/* COPC (cloud-optimised point clouds): a LAZ 1.4 whose chunks are an octree's nodes, with pages of 32 bytes a node. */

#include "core/base/byte_order.h"
#include "lod/hierarchies/hierarchy.h"

enum {
  LAS_HEADER = 375,
  AT_RECORD = LAS_HEADER + 54, /* what COPC says of itself, behind the header of its record */
  COPC_HEAD = AT_RECORD + 160,
  COPC_NODE = 32,
  AT_COPC_POINTS = 96,
  AT_COPC_FORMAT = 104,
  AT_COPC_POINT_BYTES = 105,
  AT_COPC_SCALE = 131,
  AT_COPC_OFFSET = 155,
  AT_COPC_BOX = 179,
  AT_COPC_COUNT = 247
};

static int is_copc(const char *name, const unsigned char *head, size_t n_head) {
  (void)name;
  return n_head >= LAS_HEADER + 54 && memcmp(head, "LASF", 4) == 0 && memcmp(head + LAS_HEADER + 2, "copc", 5) == 0;
}

static const char *take_copc_head(conic_hierarchy *h, const unsigned char *head) {
  double half = conic_load_double(head + AT_RECORD + 24);
  unsigned format = head[AT_COPC_FORMAT] & 0x3f;
  uint32_t point_bytes = (uint32_t)conic_load_bits(head + AT_COPC_POINT_BYTES, 2);
  if (!conic_point_layout_of_las(format, point_bytes, &h->layout))
    return "its points are of no format that is read";
  for (size_t axis = 0; axis < 3; axis++) {
    h->low[axis] = conic_load_double(head + AT_RECORD + 8 * axis) - half;
    h->edge[axis] = 2.0 * half;
    h->box_high[axis] = conic_load_double(head + AT_COPC_BOX + 16 * axis);
    h->box_low[axis] = conic_load_double(head + AT_COPC_BOX + 16 * axis + 8);
    h->layout.scale[axis] = conic_load_double(head + AT_COPC_SCALE + 8 * axis);
    h->layout.offset[axis] = conic_load_double(head + AT_COPC_OFFSET + 8 * axis);
  }
  h->spacing = conic_load_double(head + AT_RECORD + 32);
  h->n_points = conic_load_bits(head + AT_COPC_COUNT, 8);
  h->has_colors = conic_point_layout_has_colors(&h->layout);
  const conic_hierarchy_node root = {.offset = conic_load_bits(head + AT_RECORD + 40, 8),
                                     .n_bytes = conic_load_bits(head + AT_RECORD + 48, 8),
                                     .is_page = 1};
  return conic_hierarchy_add(h, &root);
}

static conic_status open_copc(conic_hierarchy *h) {
  unsigned char *head, *records = NULL;
  conic_status status = conic_hierarchy_read(h, COPC_HEAD, &head);
  if (status != CONIC_OK)
    return status;
  const char *wrong = take_copc_head(h, head);
  uint64_t points_at = conic_load_bits(head + AT_COPC_POINTS, 4);
  if (!wrong && (points_at < COPC_HEAD || points_at > CONIC_HIERARCHY_PAGE_BYTES))
    wrong = "its points begin where they cannot";
  if (wrong)
    status = conic_hierarchy_wrong(h, wrong);
  if (status == CONIC_OK)
    status = conic_hierarchy_read(h, (size_t)points_at, &records);
  if (status == CONIC_OK)
    status = conic_hierarchy_find_laz(h, records, (size_t)points_at);
  if (status == CONIC_OK)
    status = conic_georeference_of_las(h->context, records, (size_t)points_at, &h->reference);
  conic_memory_release_these(h->context, records, head);
  return status;
}

static void locate_copc(const conic_hierarchy *h, const conic_hierarchy_node *node, conic_range *range) {
  (void)h;
  range->offset = node->offset;
  range->n_bytes = (size_t)node->n_bytes;
}

static const char *take_copc_node(conic_hierarchy *h, const unsigned char *from) {
  uint32_t cell[3], level = (uint32_t)conic_load_bits(from, 4), count = (uint32_t)conic_load_bits(from + 28, 4);
  conic_hierarchy_node node = {.offset = conic_load_bits(from + 16, 8), .n_bytes = conic_load_bits(from + 24, 4)};
  for (size_t axis = 0; axis < 3; axis++)
    cell[axis] = (uint32_t)conic_load_bits(from + 4 + 4 * axis, 4);
  if (!conic_hierarchy_key(level, cell, &node.key))
    return "its page of the hierarchy names what is no node";
  node.level = (uint8_t)level;
  node.is_page = count == UINT32_MAX;
  node.n_points = node.is_page ? 0 : count;
  return conic_hierarchy_add(h, &node);
}

static const char *take_copc_page(conic_hierarchy *h, const conic_hierarchy_node *page, const unsigned char *bytes,
                                  size_t n_bytes) {
  const char *wrong = NULL;
  (void)page;
  if (n_bytes == 0 || n_bytes % COPC_NODE)
    wrong = "its page of the hierarchy is of no whole number of nodes";
  for (size_t i = 0; i < n_bytes / COPC_NODE && !wrong; i++)
    wrong = take_copc_node(h, bytes + i * COPC_NODE);
  return wrong;
}

static const char *decode_copc(const conic_hierarchy *h, const conic_hierarchy_node *node, const unsigned char *bytes,
                               size_t n_bytes, conic_hierarchy_points *points) {
  (void)node;
  return conic_hierarchy_take_chunk(h, bytes, n_bytes, points);
}

const conic_hierarchy_kind conic_hierarchy_kind_copc = {.name = "copc",
                                                        .is_one = is_copc,
                                                        .open = open_copc,
                                                        .locate = locate_copc,
                                                        .take_page = take_copc_page,
                                                        .decode = decode_copc};
