/* .chy files: docs/reference/format-chy.md. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/real.h"
#include "lod/hybrid/hybrid_layout.h"

#define FIELD(member) CONIC_FILE_FIELD(conic_chy_header, member)

static const conic_file_field fields[] = {FIELD(version),  FIELD(flags),       FIELD(n_vertices),   FIELD(n_triangles),
                                          FIELD(n_listed), FIELD(n_surfels),   FIELD(n_levels),     FIELD(n_clusters),
                                          FIELD(n_nodes),  FIELD(n_materials), FIELD(n_texels),     FIELD(origin),
                                          FIELD(low),      FIELD(high),        FIELD(splat_length), FIELD(cutoff),
                                          FIELD(zero),     FIELD(body_sum),    FIELD(n_slots),      FIELD(n_borders)};

static const char *fault_of_header(const void *numbers) {
  const conic_chy_header *h = numbers;
  const uint64_t counts[] = {h->n_vertices, h->n_triangles, h->n_listed,    h->n_surfels, h->n_levels, h->n_clusters,
                             h->n_nodes,    h->n_texels,    h->n_materials, h->n_slots,   h->n_borders};
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    if (counts[i] > UINT32_MAX)
      return "counts that do not go together";
  if (h->flags & ~(uint32_t)CONIC_CHY_ALL_FLAGS || h->zero)
    return "unknown flags";
  if (h->n_clusters < 1 || h->n_clusters + h->n_nodes > UINT32_MAX || h->n_levels < h->n_clusters || h->n_nodes < 1 ||
      h->n_nodes >= 2 * h->n_clusters || ((h->flags & CONIC_CHY_MATERIALS) && h->n_materials < 1) ||
      (h->n_texels && h->n_materials < 1))
    return "counts that do not go together";
  if (!(h->cutoff >= 0.25f && h->cutoff <= 5.0f) || !(h->splat_length >= 0.0 && h->splat_length < 1e30))
    return "a cutoff or length out of range";
  for (int axis = 0; axis < 3; axis++)
    if (!conic_is_finite(h->origin[axis]) || !(h->low[axis] <= h->high[axis]) ||
        !conic_is_finite((double)h->low[axis]) || !conic_is_finite((double)h->high[axis]))
      return "a box that is none";
  return NULL;
}

static const conic_file_kind kind = {{'C', 'O', 'N', 'I', 'C', 'H', 'Y', '\n'},
                                     ".chy",
                                     CONIC_CHY_VERSION,
                                     fields,
                                     sizeof fields / sizeof *fields,
                                     fault_of_header};

static conic_chy_header header_of(const conic_hybrid *hybrid) {
  conic_chy_header h = {.version = CONIC_CHY_VERSION,
                        .n_vertices = hybrid->n_vertices,
                        .n_triangles = hybrid->n_triangles,
                        .n_listed = hybrid->n_listed,
                        .n_surfels = hybrid->n_surfels,
                        .n_levels = hybrid->n_levels,
                        .n_clusters = hybrid->n_clusters,
                        .n_nodes = hybrid->n_nodes,
                        .n_slots = hybrid->n_slots,
                        .n_borders = hybrid->n_borders,
                        .n_materials = hybrid->n_materials,
                        .n_texels = hybrid->n_texels,
                        .splat_length = hybrid->splat_length,
                        .cutoff = hybrid->cutoff};
  h.flags = (hybrid->normal[0] ? CONIC_CHY_NORMALS : 0u) | (hybrid->color[0] ? CONIC_CHY_COLORS : 0u) |
            (hybrid->texture_coordinate[0] ? CONIC_CHY_TEXTURE_COORDINATES : 0u) |
            (hybrid->material ? CONIC_CHY_MATERIALS : 0u);
  memcpy(h.origin, hybrid->origin, sizeof h.origin);
  memcpy(h.low, hybrid->low, sizeof h.low);
  memcpy(h.high, hybrid->high, sizeof h.high);
  return h;
}

uint64_t conic_hybrid_file_bytes(const conic_hybrid *hybrid) {
  conic_chy_header h = header_of(hybrid);
  return conic_chy_lay_out(&h).n_bytes;
}

/* What is in memory is what goes into the file, but for the header. */
conic_status conic_hybrid_write(conic_hybrid *hybrid, const char *path) {
  conic_chy_header h = header_of(hybrid);
  conic_file_layout l = conic_chy_lay_out(&h);
  const void *arrays[CONIC_FILE_MOST_ARRAYS];
  conic_file_list_arrays(&l, hybrid->owned ? hybrid->owned : hybrid->mapping.bytes, arrays);
  h.body_sum = conic_file_sum_arrays(hybrid->context, &l, arrays);
  return conic_file_write_arrays(hybrid->context, path, &kind, &h, &l, arrays);
}

static conic_status read_hybrid_file(conic_hybrid *hybrid, const char *path) {
  conic_chy_header h;
  conic_status status = conic_file_open_kind(hybrid->context, path, &kind, &hybrid->mapping, &h);
  if (status != CONIC_OK)
    return status;
  conic_file_layout l = conic_chy_lay_out(&h);
  status = conic_file_take_arrays(hybrid->context, path, &hybrid->mapping, &l, h.body_sum);
  if (status != CONIC_OK)
    return status;
  conic_chy_attach(&h, hybrid->mapping.bytes, hybrid);
  const char *wrong = conic_hybrid_structure(hybrid);
  if (wrong)
    return conic_fail(hybrid->context, CONIC_ERROR_INPUT, "%s: has %s (at byte %d)", path, wrong,
                      CONIC_FILE_HEADER_BYTES);
  return conic_chy_make_materials(hybrid);
}

conic_status conic_hybrid_read(conic_context *context, const char *path, conic_hybrid **hybrid) {
  conic_hybrid *read = conic_memory_allocate_zeroed(context, 1, sizeof *read);
  *hybrid = NULL;
  if (!read)
    return CONIC_ERROR_MEMORY;
  read->context = context;
  conic_status status = read_hybrid_file(read, path);
  if (status == CONIC_OK)
    *hybrid = read;
  else
    conic_hybrid_destroy(read);
  return status;
}

int conic_hybrid_is_file(const char *path) {
  return conic_file_is_of_kind(&kind, path);
}

void conic_hybrid_mend(unsigned char *bytes, size_t n_bytes) {
  conic_chy_header h;
  conic_file_layout l = {0};
  conic_file_fields_read(fields, kind.n_fields, bytes + sizeof kind.magic, &h);
  if (!fault_of_header(&h))
    l = conic_chy_lay_out(&h);
  int is_whole = l.n_bytes == n_bytes;
  if (is_whole)
    h.body_sum = conic_file_sum_bytes(NULL, &l, bytes);
  conic_file_mend_header(&kind, is_whole ? &h : NULL, bytes);
}
