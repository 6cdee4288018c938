/* .chy files: docs/reference/format-chy.md. */
#include <stdio.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/real.h"
#include "core/base/threads.h"
#include "core/files/file.h"
#include "core/files/file_header.h"
#include "lod/hybrid/hybrid_layout.h"

#define FIELD(member) CONIC_FILE_FIELD(conic_chy_header, member)

static const conic_file_field fields[] = {FIELD(version),  FIELD(flags),       FIELD(n_vertices),   FIELD(n_triangles),
                                          FIELD(n_listed), FIELD(n_surfels),   FIELD(n_levels),     FIELD(n_clusters),
                                          FIELD(n_nodes),  FIELD(n_materials), FIELD(n_texels),     FIELD(origin),
                                          FIELD(low),      FIELD(high),        FIELD(splat_length), FIELD(cutoff),
                                          FIELD(zero),     FIELD(body_sum),    FIELD(n_slots),      FIELD(n_borders)};

static const conic_file_kind kind = {
    {'C', 'O', 'N', 'I', 'C', 'H', 'Y', '\n'}, ".chy", CONIC_CHY_VERSION, fields, sizeof fields / sizeof *fields};

/* --- sums --- */

typedef struct array_sums {
  const conic_chy_layout *layout;
  const unsigned char *bytes;
  uint64_t sums[CONIC_CHY_N_ARRAYS];
} array_sums;

static void sum_task(void *data, size_t i, int i_thread) {
  array_sums *job = data;
  (void)i_thread;
  job->sums[i] = conic_checksum(job->bytes + job->layout->arrays[i].offset, job->layout->arrays[i].n_bytes);
}

static uint64_t sum_of_sums(const uint64_t sums[CONIC_CHY_N_ARRAYS]) {
  unsigned char bytes[8 * CONIC_CHY_N_ARRAYS];
  for (size_t i = 0; i < CONIC_CHY_N_ARRAYS; i++)
    conic_file_put(bytes + 8 * i, 8, sums[i]);
  return conic_checksum(bytes, sizeof bytes);
}

static uint64_t sum_body(conic_context *context, const conic_chy_layout *l, const unsigned char *bytes) {
  array_sums job = {.layout = l, .bytes = bytes};
  conic_parallel_for(context, CONIC_CHY_N_ARRAYS, sum_task, &job);
  return sum_of_sums(job.sums);
}

/* --- writing --- */

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
  const unsigned char *body = hybrid->owned ? hybrid->owned : hybrid->mapping.bytes;
  unsigned char bytes[CONIC_FILE_HEADER_BYTES];
  conic_chy_header h = header_of(hybrid);
  conic_chy_layout l = conic_chy_lay_out(&h);
  conic_output *output;
  h.body_sum = sum_body(hybrid->context, &l, body);
  conic_file_make_header(&kind, &h, bytes);
  conic_status status = conic_output_open(hybrid->context, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *stream = conic_output_stream(output);
  fwrite(bytes, 1, sizeof bytes, stream); /* a failure is seen when the file is committed */
  for (size_t at = sizeof bytes, n; at < l.n_bytes && status == CONIC_OK; at += n) {
    n = l.n_bytes - at < (size_t)1 << 24 ? l.n_bytes - at : (size_t)1 << 24;
    if (fwrite(body + at, 1, n, stream) != n)
      break;
    status = conic_progress(hybrid->context, "write", (double)(at + n) / (double)l.n_bytes);
  }
  return conic_output_end(output, status);
}

/* --- reading --- */

/* What is wrong with a header whose sum is right, or null. */
static const char *check_header(const conic_chy_header *h) {
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

static conic_status read_hybrid_header(conic_hybrid *hybrid, const char *path, conic_chy_header *h) {
  const conic_mapping *file = &hybrid->mapping;
  conic_status status = conic_file_read_header(hybrid->context, path, &kind, file->bytes, file->n_bytes, h);
  const char *wrong = status == CONIC_OK ? check_header(h) : NULL;
  return wrong ? conic_fail(hybrid->context, CONIC_ERROR_INPUT, "%s: the header has %s (at byte 8)", path, wrong)
               : status;
}

/* The size, the sums, and nothing between the arrays. */
static conic_status check_body(const conic_hybrid *hybrid, const char *path, const conic_chy_header *h) {
  const conic_mapping *file = &hybrid->mapping;
  conic_chy_layout l = conic_chy_lay_out(h);
  if (file->n_bytes != l.n_bytes)
    return conic_fail(hybrid->context, CONIC_ERROR_INPUT,
                      "%s: has %zu bytes where its header tells of %zu (at byte %zu)", path, file->n_bytes, l.n_bytes,
                      file->n_bytes < l.n_bytes ? file->n_bytes : l.n_bytes);
  for (int i = 0; i < CONIC_CHY_N_ARRAYS; i++) {
    size_t next = i + 1 < CONIC_CHY_N_ARRAYS ? l.arrays[i + 1].offset : l.n_bytes;
    for (size_t at = l.arrays[i].offset + l.arrays[i].n_bytes; at < next; at++)
      if (file->bytes[at])
        return conic_fail(hybrid->context, CONIC_ERROR_INPUT, "%s: is damaged (at byte %zu)", path, at);
  }
  if (sum_body(hybrid->context, &l, file->bytes) != h->body_sum)
    return conic_fail(hybrid->context, CONIC_ERROR_INPUT,
                      "%s: is damaged: its sum is not that of its header (at byte %d)", path, CONIC_FILE_HEADER_BYTES);
  return CONIC_OK;
}

static conic_status read_hybrid_file(conic_hybrid *hybrid, const char *path) {
  conic_chy_header h;
  conic_status status = conic_mapping_open(hybrid->context, path, &hybrid->mapping);
  if (status == CONIC_OK)
    status = read_hybrid_header(hybrid, path, &h);
  if (status == CONIC_OK)
    status = check_body(hybrid, path, &h);
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
  conic_file_fields_read(fields, kind.n_fields, bytes + sizeof kind.magic, &h);
  if (!check_header(&h)) {
    conic_chy_layout l = conic_chy_lay_out(&h);
    if (l.n_bytes == n_bytes) {
      uint64_t sums[CONIC_CHY_N_ARRAYS];
      for (int i = 0; i < CONIC_CHY_N_ARRAYS; i++)
        sums[i] = conic_checksum(bytes + l.arrays[i].offset, l.arrays[i].n_bytes);
      h.body_sum = sum_of_sums(sums);
      conic_file_fields_write(fields, kind.n_fields, &h, bytes + sizeof kind.magic);
    }
  }
  conic_file_put(bytes + CONIC_FILE_HEADER_BYTES - 8, 8, conic_checksum(bytes, CONIC_FILE_HEADER_BYTES - 8));
}
