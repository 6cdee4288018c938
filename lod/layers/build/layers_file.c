#include "lod/layers/build/layers_file.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/files/file.h"

/* Where a node goes and where its bytes come from. */
typedef struct plan {
  uint32_t *nodes;   /* of the forest, in the order of the file */
  uint64_t *sources; /* of their bytes, in the spool */
  conic_layers_entry *entries;
} plan;

static void release_plan(conic_context *context, plan *p) {
  conic_memory_release(context, p->nodes);
  conic_memory_release(context, p->sources);
  conic_memory_release(context, p->entries);
}

/* Level by level from the root; within each level the order of the parents is that of the keys, and so theirs. */
static void order_nodes(const conic_layers_forest *forest, plan *p) {
  uint32_t n = 1;
  p->nodes[0] = forest->root;
  for (uint32_t i = 0; i < n; i++) {
    const conic_layers_node *node = &forest->shelf.nodes[p->nodes[i]];
    conic_layers_entry *entry = &p->entries[i];
    uint32_t parent = entry->parent;
    uint16_t level = entry->level;
    *entry = node->entry;
    entry->parent = parent;
    entry->level = level;
    p->sources[i] = entry->offset;
    if (node->children[0] == CONIC_LAYERS_NO_NODE)
      continue;
    entry->child = n;
    for (int k = 0; k < 2; k++, n++) {
      p->nodes[n] = node->children[k];
      p->entries[n].parent = i;
      p->entries[n].level = (uint16_t)(level + 1);
    }
  }
}

typedef struct node_outline {
  float radius;
  uint64_t n_samples;
} node_outline;

static int compare_outlines(const void *a, const void *b) {
  float first = ((const node_outline *)a)->radius, second = ((const node_outline *)b)->radius;
  return (first > second) - (first < second);
}

/* The lower median of all samples' outlines at full resolution, which are their leaves'. */
static conic_status median_outline(conic_context *context, const conic_layers_header *header,
                                   const conic_layers_entry *entries, double *median) {
  uint64_t before = 0;
  size_t n = 0;
  node_outline *outlines = conic_memory_allocate(context, header->n_clouds, sizeof *outlines);
  if (!outlines)
    return CONIC_ERROR_MEMORY;
  for (uint32_t i = 0; i < header->n_clouds; i++)
    if (entries[i].child == 0)
      outlines[n++] = (node_outline){entries[i].radius, entries[i].n_place};
  qsort(outlines, n, sizeof *outlines, compare_outlines);
  for (size_t i = 0; i < n && before <= (header->n_samples - 1) / 2; i++) {
    *median = (double)outlines[i].radius;
    before += outlines[i].n_samples;
  }
  conic_memory_release(context, outlines);
  return CONIC_OK;
}

/* The sizes of all, and where each cloud's bytes will be. */
static void lay_out_file(const conic_layers_forest *forest, const plan *p, conic_layers_header *header) {
  uint64_t offset = CONIC_LAYERS_HEADER_BYTES + conic_layers_index_bytes(header);
  header->n_levels = p->entries[header->n_clouds - 1].level + 1u;
  for (uint32_t i = 0; i < header->n_clouds; i++) {
    conic_layers_entry *entry = &p->entries[i];
    entry->offset = offset;
    offset += entry->n_bytes;
    header->n_samples += entry->n_samples;
    header->most_samples = entry->n_samples > header->most_samples ? entry->n_samples : header->most_samples;
    header->most_bytes = entry->n_bytes > header->most_bytes ? entry->n_bytes : header->most_bytes;
  }
  header->file_bytes = offset;
  header->position_bytes = forest->shelf.part_bytes[CONIC_LAYERS_POSITION];
  header->normal_bytes = forest->shelf.part_bytes[CONIC_LAYERS_NORMAL];
  header->color_bytes = forest->shelf.part_bytes[CONIC_LAYERS_COLOR];
}

/* Header and index. A failed write is seen when the file is committed. */
static conic_status write_head(conic_context *context, conic_layers_header *header, const conic_layers_entry *entries,
                               FILE *stream) {
  unsigned char head[CONIC_LAYERS_HEADER_BYTES];
  size_t n_bytes = (size_t)conic_layers_index_bytes(header);
  unsigned char *index = conic_memory_allocate(context, n_bytes, 1);
  if (!index)
    return CONIC_ERROR_MEMORY;
  conic_layers_write_index(header, entries, index);
  conic_layers_write_header(header, head);
  fwrite(head, 1, sizeof head, stream);
  fwrite(index, 1, n_bytes, stream);
  conic_memory_release(context, index);
  return CONIC_OK;
}

static conic_status write_clouds(conic_context *context, const conic_layers_forest *forest, const plan *p,
                                 const conic_layers_header *header, FILE *stream) {
  conic_status status = CONIC_OK;
  unsigned char *bytes = conic_memory_allocate(context, header->most_bytes, 1);
  if (!bytes)
    return CONIC_ERROR_MEMORY;
  for (uint32_t i = 0; i < header->n_clouds && status == CONIC_OK; i++) {
    size_t n_bytes = p->entries[i].n_bytes;
    status = conic_spool_read(&forest->spool, p->sources[i], bytes, n_bytes);
    if (status == CONIC_OK && fwrite(bytes, 1, n_bytes, stream) != n_bytes)
      break;
    if (status == CONIC_OK && i % 1024 == 0)
      status = conic_progress(context, "write", (double)i / (double)header->n_clouds);
  }
  conic_memory_release(context, bytes);
  return status;
}

static conic_status write_all(conic_context *context, const char *path, const conic_layers_forest *forest,
                              const plan *p, conic_layers_header *header) {
  conic_output *output;
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  status = write_head(context, header, p->entries, conic_output_stream(output));
  if (status == CONIC_OK)
    status = write_clouds(context, forest, p, header, conic_output_stream(output));
  return conic_output_end(output, status);
}

conic_status conic_layers_write(conic_context *context, const char *path, const conic_layers_forest *forest,
                                conic_layers_header *header) {
  size_t n = forest->shelf.n_nodes;
  plan p = {.nodes = conic_memory_allocate(context, n, sizeof *p.nodes),
            .sources = conic_memory_allocate(context, n, sizeof *p.sources),
            .entries = conic_memory_allocate_zeroed(context, n, sizeof *p.entries)};
  conic_status status = p.nodes && p.sources && p.entries ? CONIC_OK : CONIC_ERROR_MEMORY;
  header->n_clouds = (uint32_t)n;
  if (status == CONIC_OK) {
    order_nodes(forest, &p);
    lay_out_file(forest, &p, header);
    status = median_outline(context, header, p.entries, &header->splat_radius);
  }
  if (status == CONIC_OK)
    status = write_all(context, path, forest, &p, header);
  release_plan(context, &p);
  return status;
}
