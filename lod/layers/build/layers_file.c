#include "lod/layers/build/layers_file.h"

#include <string.h>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/files/file.h"
#include "core/files/mapping.h"
#include "lod/layers/build/layers_moves.h"
#include "lod/layers/build/layers_order.h"

typedef struct writing {
  conic_context *context;
  const conic_team *team; /* null: one process writes all */
  const conic_layers_forest *forest;
  conic_layers_header *header;
  conic_layers_order order;
  conic_layers_entry *nodes; /* some at a time */
  unsigned char *bytes;      /* of as many entries, or of a cloud */
  uint64_t offset;           /* where the next cloud's bytes will be */
  conic_checksumming sum;
  FILE *stream;
  conic_layers_moving *moving; /* null, too */
} writing;

typedef conic_status take_nodes(writing *w, size_t n);

static conic_status for_nodes(writing *w, take_nodes *take) {
  conic_status status = CONIC_OK;
  w->offset = CONIC_LAYERS_HEADER_BYTES + conic_layers_index_bytes(w->header);
  for (uint64_t first = 0; first < w->order.n && status == CONIC_OK; first += CONIC_LAYERS_SOME_NODES) {
    size_t n;
    status = conic_layers_order_read(&w->order, first, w->nodes, &n);
    if (status == CONIC_OK)
      status = take(w, n);
  }
  return status;
}

/* The entries' bytes as they will be in the file. */
static void make_entries(writing *w, size_t n) {
  for (size_t i = 0; i < n; i++) {
    w->nodes[i].offset = w->offset;
    w->offset += w->nodes[i].n_bytes;
  }
  conic_layers_write_entries(w->nodes, n, w->bytes);
}

static conic_status measure_clouds(writing *w, size_t n) {
  conic_layers_header *header = w->header;
  for (size_t i = 0; i < n; i++) {
    const conic_layers_entry *entry = &w->nodes[i];
    header->n_samples += entry->n_samples;
    header->most_samples = entry->n_samples > header->most_samples ? entry->n_samples : header->most_samples;
    header->most_bytes = entry->n_bytes > header->most_bytes ? entry->n_bytes : header->most_bytes;
  }
  make_entries(w, n);
  conic_checksum_add(&w->sum, w->bytes, n * CONIC_LAYERS_ENTRY_BYTES);
  return CONIC_OK;
}

static void count_attribute(conic_layers_header *header, conic_layers_attribute *attribute, uint64_t n_bytes) {
  attribute->n_bytes = n_bytes;
  if (attribute->kind == CONIC_LAYERS_POSITION)
    header->position_bytes = n_bytes;
  else if (attribute->kind == CONIC_LAYERS_NORMAL || attribute->kind == CONIC_LAYERS_AXES)
    header->normal_bytes = n_bytes;
  else if (attribute->kind == CONIC_LAYERS_COLOR)
    header->color_bytes = n_bytes;
}

/* All that header and index say. */
static conic_status measure_file(writing *w) {
  conic_layers_header *header = w->header;
  header->n_clouds = (uint32_t)w->order.n;
  header->n_levels = w->order.n_levels;
  header->splat_radius = w->forest->outline;
  for (uint32_t i = 0; i < header->schema.n; i++)
    count_attribute(header, &header->schema.list[i], w->forest->part_bytes[i]);
  conic_layers_write_table(header, w->bytes);
  conic_checksum_begin(&w->sum);
  conic_checksum_add(&w->sum, w->bytes, conic_layers_table_bytes(header));
  conic_status status = for_nodes(w, measure_clouds);
  if (status != CONIC_OK)
    return status;
  header->file_bytes = w->offset;
  header->index_sum = conic_checksum_end(&w->sum);
  return status;
}

/* A failed write is seen when the file is committed. */
static conic_status write_entries(writing *w, size_t n) {
  make_entries(w, n);
  fwrite(w->bytes, CONIC_LAYERS_ENTRY_BYTES, n, w->stream);
  return CONIC_OK;
}

static conic_status write_clouds(writing *w, size_t n) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const conic_layers_entry *entry = &w->nodes[i];
    status = conic_pile_read(&w->forest->clouds, entry->offset, w->bytes, entry->n_bytes);
    if (status == CONIC_OK)
      fwrite(w->bytes, 1, entry->n_bytes, w->stream);
    w->offset += entry->n_bytes;
  }
  if (status == CONIC_OK && ferror(w->stream)) /* soon, where the disk is full */
    status = CONIC_ERROR_IO;
  return status == CONIC_OK ? conic_progress(w->context, "write", (double)w->offset / (double)w->header->file_bytes)
                            : status;
}

/* Tells everybody where its clouds go. */
static conic_status move_clouds(writing *w, size_t n) {
  conic_layers_move moves[CONIC_LAYERS_SOME_NODES];
  for (size_t i = 0; i < n; i++) {
    moves[i] = (conic_layers_move){w->nodes[i].offset, w->offset, w->nodes[i].n_bytes};
    w->offset += w->nodes[i].n_bytes;
  }
  conic_status status = conic_progress(w->context, "write", (double)w->offset / (double)w->header->file_bytes);
  return conic_layers_moves_tell(w->moving, status, moves, n);
}

static conic_status write_clouds_together(writing *w) {
  conic_moment start = conic_moment_now();
  conic_status status = fflush(w->stream) == 0 ? for_nodes(w, move_clouds) : CONIC_ERROR_IO;
  status = conic_layers_moves_tell(w->moving, status, NULL, 0);
  conic_team_note(w->team, "write", start, w->header->file_bytes);
  return status;
}

static conic_status write_file(writing *w) {
  unsigned char head[CONIC_LAYERS_HEADER_BYTES];
  conic_layers_write_header(w->header, head);
  conic_layers_write_table(w->header, w->bytes);
  fwrite(head, 1, sizeof head, w->stream);
  fwrite(w->bytes, 1, conic_layers_table_bytes(w->header), w->stream);
  conic_status status = for_nodes(w, write_entries);
  if (w->moving)
    return status == CONIC_OK ? write_clouds_together(w) : status;
  if (status == CONIC_OK)
    status = conic_memory_grow(w->context, &w->bytes, 0, w->header->most_bytes, 1);
  return status == CONIC_OK ? for_nodes(w, write_clouds) : status;
}

static conic_status write_measured(writing *w, const char *path) {
  conic_output *output;
  conic_status status = conic_output_open(w->context, path, &output);
  if (status != CONIC_OK)
    return status;
  w->stream = conic_output_stream(output);
  if (w->moving)
    status = conic_layers_moves_begin(w->moving, conic_output_temporary(output), fileno(w->stream));
  if (status == CONIC_OK)
    status = write_file(w);
  return ferror(w->stream) ? conic_output_commit(output) : conic_output_end(output, status);
}

static conic_status write_all_bytes(conic_context *context, const char *path, const conic_layers_forest *forest,
                                    conic_layers_header *header, conic_layers_moving *moving) {
  conic_moment start = conic_moment_now();
  writing w = {.context = context,
               .team = moving ? moving->team : NULL,
               .forest = forest,
               .header = header,
               .moving = moving,
               .nodes = conic_memory_allocate(context, CONIC_LAYERS_SOME_NODES, sizeof *w.nodes),
               .bytes = conic_memory_allocate(context, CONIC_LAYERS_SOME_NODES, CONIC_LAYERS_ENTRY_BYTES)};
  conic_status status =
      w.nodes && w.bytes ? conic_layers_order_nodes(context, forest->nodes.path, forest, &w.order) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = measure_file(&w);
  conic_team_note(w.team, "order", start, w.order.n);
  if (status == CONIC_OK)
    status = write_measured(&w, path);
  conic_layers_order_end(&w.order);
  conic_memory_release(context, w.nodes);
  conic_memory_release(context, w.bytes);
  return status;
}

conic_status conic_layers_write(conic_context *context, const char *path, const conic_team *team,
                                const conic_layers_forest *forest, conic_layers_header *header) {
  conic_layers_moving moving = {.context = context, .team = team, .path = path, .clouds = &forest->clouds};
  if (!team)
    return write_all_bytes(context, path, forest, header, NULL);
  conic_status status = team->index == 0 ? write_all_bytes(context, path, forest, header, &moving) : CONIC_OK;
  conic_moment start = conic_moment_now();
  status = conic_layers_moves_end(&moving, status);
  if (team->index > 0)
    conic_team_note(team, "write", start, conic_spool_bytes(&forest->nodes));
  return status;
}
