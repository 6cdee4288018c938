/* .chy files: docs/reference/format-chy.md. */

#include "core/files/file.h"
#include "lod/hybrid/model/hybrid_chunks.h"
#include "lod/hybrid/model/hybrid_layout.h"
#include "lod/hybrid/model/hybrid_store.h"

#define FIELD(member) CONIC_FILE_FIELD(conic_hybrid, member)

static const conic_file_field fields[] = {
    FIELD(version),    FIELD(flags),   FIELD(n_vertices),   FIELD(n_triangles), FIELD(n_surfels), FIELD(n_levels),
    FIELD(n_clusters), FIELD(n_nodes), FIELD(n_materials),  FIELD(n_texels),    FIELD(n_data),    FIELD(origin),
    FIELD(low),        FIELD(high),    FIELD(splat_length), FIELD(cutoff),      FIELD(zero),      FIELD(body_sum)};

/* Chunks begin at whole units, fewer than 2³². */
static const uint64_t most_data = (uint64_t)UINT32_MAX * CONIC_HYBRID_UNIT;

static const char *fault_of_chy_header(const void *numbers) {
  const conic_hybrid *h = numbers;
  const uint64_t counts[] = {h->n_vertices, h->n_triangles, h->n_surfels, h->n_levels,
                             h->n_clusters, h->n_nodes,     h->n_texels,  h->n_materials};
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    if (counts[i] > UINT32_MAX)
      return "counts that do not go together";
  if (h->flags & ~(uint32_t)CONIC_CHY_ALL_FLAGS || h->zero)
    return "unknown flags";
  if (h->n_clusters < 1 || h->n_clusters + h->n_nodes > UINT32_MAX || h->n_levels + 2 * h->n_clusters > UINT32_MAX ||
      h->n_data > most_data || h->n_levels < h->n_clusters || h->n_nodes < 1 || h->n_nodes >= 2 * h->n_clusters ||
      ((h->flags & CONIC_CHY_MATERIALS) && h->n_materials < 1) || (h->n_texels && h->n_materials < 1))
    return "counts that do not go together";
  if (!(h->cutoff >= 0.25f && h->cutoff <= 5.0f) || !(h->splat_length >= 0.0 && h->splat_length < 1e30))
    return "a cutoff or length out of range";
  for (int axis = 0; axis < 3; axis++)
    if (!conic_is_finite(h->origin[axis]) || !(h->low[axis] <= h->high[axis]) ||
        !conic_is_finite((double)h->low[axis]) || !conic_is_finite((double)h->high[axis]))
      return "a box that is none";
  return NULL;
}

const conic_file_kind conic_chy_kind = {{'C', 'O', 'N', 'I', 'C', 'H', 'Y', '\n'},
                                        ".chy",
                                        CONIC_CHY_VERSION,
                                        fields,
                                        sizeof fields / sizeof *fields,
                                        fault_of_chy_header};

uint64_t conic_hybrid_file_bytes(const conic_hybrid *hybrid) {
  return conic_chy_lay_out(hybrid).n_bytes + hybrid->n_data;
}

/* --- writing --- */

static uint64_t largest_chunk(const conic_hybrid *hybrid) {
  uint64_t most = 0;
  for (uint32_t i = 0; i < conic_hybrid_count_chunks(hybrid); i++) {
    uint64_t n_bytes = conic_hybrid_chunk_place(hybrid, i).n_bytes;
    most = n_bytes > most ? n_bytes : most;
  }
  return most;
}

static conic_status write_chunk(const conic_hybrid *hybrid, uint32_t chunk, unsigned char *bytes, FILE *stream) {
  size_t n_bytes = (size_t)conic_hybrid_chunk_place(hybrid, chunk).n_bytes;
  conic_status status = n_bytes ? conic_hybrid_store_hold(hybrid, &chunk, 1) : CONIC_OK;
  if (status != CONIC_OK || n_bytes == 0)
    return status;
  memcpy(bytes, conic_hybrid_chunk(hybrid, chunk), n_bytes);
  conic_hybrid_store_let_go(hybrid, &chunk, 1);
  conic_hybrid_turn_chunk(hybrid, chunk, bytes);
  conic_hybrid_seal_chunk(bytes, n_bytes);
  fwrite(bytes, 1, n_bytes, stream);
  return ferror(stream) ? CONIC_ERROR_IO : CONIC_OK;
}

/* A failed write is seen when the file is committed. */
static conic_status write_placed(const conic_hybrid *hybrid, conic_hybrid *placed, const uint32_t *order,
                                 unsigned char *bytes, FILE *stream) {
  conic_file_layout l = conic_chy_lay_out(placed);
  const void *arrays[CONIC_FILE_MOST_ARRAYS] = {placed->nodes, placed->clusters, placed->levels, placed->material_list,
                                                placed->texels};
  for (int i = 0; i < l.n; i++)
    arrays[i] = arrays[i] ? arrays[i] : placed->nodes; /* of nothing */
  size_t n = conic_hybrid_count_chunks(hybrid);
  placed->body_sum = conic_file_sum_arrays(hybrid->context, &l, arrays);
  conic_status status = conic_file_put_arrays(hybrid->context, stream, &conic_chy_kind, placed, &l, arrays);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    status = write_chunk(hybrid, order[i], bytes, stream);
    if (status == CONIC_OK && (i % 256 == 0 || i + 1 == n))
      status = conic_progress(hybrid->context, "write", (double)(i + 1) / (double)n);
    if (hybrid->pile && i % 256 == 0)
      conic_hybrid_pile_rest(hybrid->pile);
  }
  return status;
}

/* The chunks may lie anywhere now, and get the places that they have in a file. */
static conic_status write_hybrid(const conic_hybrid *hybrid, const uint32_t *order, unsigned char *bytes,
                                 FILE *stream) {
  conic_context *context = hybrid->context;
  conic_hybrid placed = *hybrid;
  placed.version = CONIC_CHY_VERSION;
  conic_hybrid_level *levels = conic_memory_allocate(context, hybrid->n_levels, sizeof *levels);
  conic_hybrid_cluster *clusters = conic_memory_allocate(context, hybrid->n_clusters, sizeof *clusters);
  conic_status status = levels && clusters ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    memcpy(levels, hybrid->levels, hybrid->n_levels * sizeof *levels);
    memcpy(clusters, hybrid->clusters, hybrid->n_clusters * sizeof *clusters);
    placed.levels = levels;
    placed.clusters = clusters;
    status = conic_hybrid_place_chunks(&placed, levels, clusters);
  }
  if (status == CONIC_OK)
    status = write_placed(hybrid, &placed, order, bytes, stream);
  conic_memory_release_these(context, levels, clusters);
  return status;
}

conic_status conic_hybrid_write(conic_hybrid *hybrid, const char *path) {
  conic_output *output;
  uint32_t *order;
  unsigned char *bytes = conic_memory_allocate(hybrid->context, (size_t)largest_chunk(hybrid), 1);
  conic_status status = conic_hybrid_order_chunks(hybrid, &order);
  if (status == CONIC_OK)
    status = bytes ? conic_output_open(hybrid->context, path, &output) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    FILE *stream = conic_output_stream(output);
    status = write_hybrid(hybrid, order, bytes, stream);
    status = ferror(stream) ? conic_output_commit(output) : conic_output_end(output, status);
  }
  conic_memory_release_these(hybrid->context, order, bytes);
  return status;
}

/* --- reading --- */

conic_status conic_chy_take_index(conic_hybrid *hybrid, const char *path, uint64_t n_bytes, unsigned char *index) {
  conic_file_layout l = conic_chy_lay_out(hybrid);
  conic_mapping arrays = {.bytes = index, .n_bytes = l.n_bytes};
  uint64_t wanted = l.n_bytes + hybrid->n_data;
  if (n_bytes != wanted)
    return conic_fail(hybrid->context, CONIC_ERROR_INPUT,
                      "%s: has %llu bytes where its header tells of %llu (at byte %llu)", path,
                      (unsigned long long)n_bytes, (unsigned long long)wanted,
                      (unsigned long long)(n_bytes < wanted ? n_bytes : wanted));
  conic_status status = conic_file_take_arrays(hybrid->context, path, &arrays, &l, hybrid->body_sum);
  if (status != CONIC_OK)
    return status;
  conic_chy_attach(index, hybrid);
  const char *wrong = conic_hybrid_structure(hybrid);
  if (!wrong) {
    status = conic_hybrid_check_order(hybrid, &wrong);
    if (status != CONIC_OK)
      return status;
  }
  if (wrong)
    return conic_fail(hybrid->context, CONIC_ERROR_INPUT, "%s: has %s (at byte %d)", path, wrong,
                      CONIC_FILE_HEADER_BYTES);
  return conic_chy_make_materials(hybrid);
}

/* Checking all chunks, each thread some; of what is wrong the first is told. */
typedef struct chunk_checks {
  const conic_hybrid *hybrid;
  unsigned char *data;
  int does_clusters; /* once all chunks are known to be sound */
  struct chunk_wrong {
    const char *what;
    size_t task;
  } * wrong; /* a thread */
} chunk_checks;

static void check_chunk_task(void *data, size_t i, int i_thread) {
  chunk_checks *c = data;
  struct chunk_wrong *wrong = &c->wrong[i_thread];
  if (wrong->what && wrong->task < i)
    return;
  const char *found = c->does_clusters
                          ? conic_hybrid_cluster_fault(c->hybrid, (uint32_t)i)
                          : conic_hybrid_take_chunk(c->hybrid, (uint32_t)i,
                                                    c->data + conic_hybrid_chunk_place(c->hybrid, (uint32_t)i).at);
  if (found)
    *wrong = (struct chunk_wrong){found, i};
}

static conic_status run_checks(chunk_checks *c, const char *path, uint64_t data_at) {
  const conic_hybrid *h = c->hybrid;
  struct chunk_wrong first = {NULL, SIZE_MAX};
  conic_parallel_for(h->context, c->does_clusters ? h->n_clusters : conic_hybrid_count_chunks(h), check_chunk_task, c);
  for (int i = 0; i < conic_context_threads(h->context); i++)
    if (c->wrong[i].what && c->wrong[i].task < first.task)
      first = c->wrong[i];
  if (!first.what)
    return CONIC_OK;
  uint32_t chunk = c->does_clusters ? conic_hybrid_frame_chunk(h, (uint32_t)first.task) : (uint32_t)first.task;
  return conic_fail(h->context, CONIC_ERROR_INPUT, "%s: has %s (at byte %llu)", path, first.what,
                    (unsigned long long)(data_at + conic_hybrid_chunk_place(h, chunk).at));
}

/* NOLINTNEXTLINE(readability-non-const-parameter): taking a chunk puts its bytes in order */
static conic_status check_chunks(conic_hybrid *hybrid, const char *path, unsigned char *data, uint64_t data_at) {
  chunk_checks c = {.hybrid = hybrid, .data = data};
  c.wrong =
      conic_memory_allocate_zeroed(hybrid->context, (size_t)conic_context_threads(hybrid->context), sizeof *c.wrong);
  if (!c.wrong)
    return CONIC_ERROR_MEMORY;
  conic_status status = run_checks(&c, path, data_at);
  c.does_clusters = 1;
  if (status == CONIC_OK)
    status = run_checks(&c, path, data_at);
  conic_memory_release(hybrid->context, c.wrong);
  return status;
}

static conic_status read_hybrid_file(conic_hybrid *hybrid, const char *path) {
  conic_mapping *file = &hybrid->mapping;
  conic_status status = conic_file_open_kind(hybrid->context, path, &conic_chy_kind, file, hybrid);
  if (status == CONIC_OK)
    status = conic_chy_take_index(hybrid, path, file->n_bytes, file->bytes);
  if (status != CONIC_OK)
    return status;
  uint64_t data_at = file->n_bytes - hybrid->n_data;
  hybrid->data = file->bytes + data_at;
  return check_chunks(hybrid, path, file->bytes + data_at, data_at);
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
  return conic_file_is_of_kind(&conic_chy_kind, path);
}
